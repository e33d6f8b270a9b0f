"""What does a new user wait for? The first command of the README, from an empty machine; then builds after it.

    python tests/benchmarks/cold_build.py

Clones this checkout (what is committed) into a temporary folder, with empty caches of pip and Zig, and runs there what the
README says: environment, installation, FMUs, circle. Then it builds again, without an edit and after an edit of one variant.
Times are of the clock and of all processors (user + system, child processes included); those of pip are with the download.
"""

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parents[2]
EDITED = "fmu_sources/tetherfmu/kernels/variants/quasi_steady.py"


def first_command():
    """Commands of the README's first block for a shell, one by one."""
    block = (ROOT / "README.md").read_text(encoding="utf-8").partition("```sh\n")[2].partition("```")[0]
    return block.strip().split(" && ")


def measured(command, folder, environment):
    """Times of a command [s], of the clock and of all processors; its output is shown if it fails."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    done = subprocess.run(command, shell=True, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    clock, after = perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{command} failed:\n{done.stdout}{done.stderr}")
    return clock, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def environment_of(folder):
    """Environment with caches of its own in a folder."""
    caches = {
        "PIP_CACHE_DIR": "pip",
        "ZIG_GLOBAL_CACHE_DIR": "zig",
        "MPLCONFIGDIR": "matplotlib",
        "XDG_CACHE_HOME": "others",
    }
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    return {**kept, **{name: str(folder / place) for name, place in caches.items()}, "MPLBACKEND": "Agg"}


def main(folder):
    """Measure in an empty folder and print the table."""
    clone, environment = folder / "clone", environment_of(folder / "caches")
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
    rows = [(command, *measured(command, clone, environment)) for command in first_command()]
    clock, processors = (sum(row[k] for row in rows) for k in (1, 2))
    rows.append(("the first command of the README", clock, processors))
    installing = [row for row in rows[:-1] if "build_fmus" not in row[0] and "fly" not in row[0]]
    rows.append(("... without environment and pip", *(rows[-1][k] - sum(row[k] for row in installing) for k in (1, 2))))
    build = next(row[0] for row in rows if "build_fmus" in row[0])
    rows.append(("build again, nothing edited", *measured(build, clone, environment)))
    with open(clone / EDITED, "a", encoding="utf-8") as file:
        file.write("# edited\n")
    rows.append(("build again, one variant edited", *measured(build, clone, environment)))
    size = sum(path.stat().st_size for path in (clone / ".venv").rglob("*") if path.is_file()) / 1e6
    print(f"{'':72}  {'clock s':>8}  {'processors s':>12}")
    for name, clock, processors in rows:
        print(f"{name:72}  {clock:8.1f}  {processors:12.1f}")
    print(f"environment: {size:.0f} MB")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        main(Path(temporary))
