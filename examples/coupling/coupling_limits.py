"""How long may a communication step be that couples a kite of finite mass with its tether, and how wrong is it then?

    python examples/coupling/coupling_limits.py

The tether takes motion and gives a force, the kite takes a force and gives motion, and in a communication step one of them
has to go first, or both have to guess. Seven ways of exchange (`ways_of_coupling.py`) are compared with the exact motion of
kite and tether together (`monolithic.py`), over the communication step; so are tethers that meet in a knot. The growth of a
small deviation along a taut tether is compared with theory (`axial_chain.py`), which then says up to which step each way is
stable, for light and heavy kites on short and long tethers. docs/use/coupling.md explains what comes out.
"""

import sys
from pathlib import Path

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms


def write(tables, folder):
    """Write tables as CSV files, data/coupling_NAME.csv, and their figures, figures/coupling_NAME.png."""
    from coupling.coupling_figures import DRAWN

    for name in ("data", "figures"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for name, table in tables.items():
        table.to_csv(folder / "data" / f"coupling_{name}.csv", index=False, float_format="%.6g")
        if name in DRAWN:
            DRAWN[name](table).savefig(folder / "figures" / f"coupling_{name}.png", dpi=150, metadata={"Software": None})


@command
def main(arguments=None):
    """Print the tables, write them and the figures."""
    parser = Parser(description="measure errors and limits of coupling a kite with its tether")
    parser.add_out("all files")
    parser.add_argument("--quick", action="store_true", help="a few points only, to see that it runs")
    given = parser.parse_args(arguments)
    from coupling import coupling_study as study  # here, so that a package that it needs is named in one line

    quick = given.quick
    tables = {
        "errors": study.errors((0.02,), 0.2) if quick else study.errors(),
        "growth": study.growths((0.01,), 1.0) if quick else study.growths(),
        "knots": study.knots((study.OF_KNOTS,), 0.04) if quick else study.knots(),
        "limits": study.limits((100.0,), (10.0,)) if quick else study.limits(),
    }
    printed = {
        f"Error of the tether force in steps of {1e3 * study.PRINTED:g} ms [%]": study.percent_table(tables["errors"]),
        f"Error of the forces on a knot in steps of {1e3 * study.OF_KNOTS:g} ms [%]": study.knot_table(tables["knots"]),
        "Largest stable communication step [ms]": study.limit_table(tables["limits"]),
        "Rules": study.rule_table(tables["limits"]),
    }
    print("\n\n".join(f"{title}\n\n{table}" for title, table in printed.items()))
    write(tables, given.out)
    print(f"\nTables and figures are in {given.out}")


if __name__ == "__main__":
    sys.exit(main())
