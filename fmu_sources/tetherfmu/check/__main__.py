"""Check FMUs on this machine: `python -m tetherfmu.check FILE.fmu [FILE.fmu ...]`; needs FMPy.

It validates the archive and the model description, looks for known problems and names the remedy, and runs the evidence
sets in a separate process, for `apart.LONGEST` seconds at most. Exit status: 0 no problem, 1 a problem was found, 2 wrong
use.
"""

import importlib.util
import sys
import tempfile
import zipfile

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, file
from tetherfmu.console.progress import now

from . import inspection
from .apart import LONGEST, apart, flown
from .evidence_runs import evidence_of
from .soundness import NOTE, OK, PROBLEM, Finding, archive

VERSIONS = ("1", "2", "3")  # of FMI; FMUs of the first are validated only


def findings(path):
    """All findings on an FMU that exists: list of `Finding`."""
    found = archive(path)
    if any(each.level == PROBLEM for each in found):
        return found
    with zipfile.ZipFile(path) as opened:
        names = opened.namelist()
    version = inspection.fmi_version(path)
    if version not in VERSIONS:
        return [*found, Finding(PROBLEM, f"the fmiVersion is {version or 'missing'}; it must be {', '.join(VERSIONS)}")]
    valid, problem = apart(inspection.description, path, "FMPy's validation")
    found += [problem] if problem else [Finding(*each) for each in valid]
    found += inspection.layout(names, version)
    run = inspection.platforms(names, version)
    if inspection.MADE_BY_PYTHONFMU in names:
        run += inspection.paths(path, tempfile.gettempdir())
    ready = version != "1" and not any(each.level == PROBLEM for each in run)
    found += run + evidence(path, ready)
    if inspection.MADE_BY_PYTHONFMU in names:
        found += inspection.hosts_that_are_not_python()
    return found


def evidence(path, ready):
    """Findings on the evidence sets of an FMU; they are run if the FMU is `ready` for that."""
    try:
        wanted = evidence_of(path)
    except (KeyError, ValueError) as error:
        return [Finding(PROBLEM, f"the evidence set cannot be read: {error}", "build the FMU again")]
    if not wanted:
        return [Finding(NOTE, "there is no evidence set in this FMU: it was validated, not run")]
    if not ready:
        return [Finding(NOTE, "the evidence set was not run, because of the problem above")]
    result, problem = apart(flown, path, "the run of the evidence set")
    if problem:
        return [problem]
    try:
        found, units = result
        return [comparison(kind, found[kind], each, units) for kind, each in wanted.items()]
    except (AttributeError, KeyError, IndexError, TypeError, ValueError):
        return [Finding(PROBLEM, "the result of the evidence run cannot be read: the FMU has changed it")]


def comparison(kind, result, wanted, units):
    """`Finding` on a run against the reference: whether it reached the end, and the deviation of each output.

    kind : of the set, see `replay.evidence_of`.
    result : dict of name to list of numbers.  wanted : `replay.Evidence`.  units : dict of name to unit.
    """
    times, name_of_set = wanted.reference["time"], f"evidence set{', winch by ' if kind else ''}{kind}"
    if len(result["time"]) != len(times):
        end = result["time"][-1]
        text = f"{name_of_set}: the run ended at {end:g} s instead of {times[-1]:g} s: a step was refused"
        return Finding(PROBLEM, text, "the FMU says why on stderr: run it with debug_logging=True in FMPy")
    share = wanted.options["AllowedDeviation"]
    largest = largest_values(wanted.reference)
    lines, level = [], OK
    for name, values in wanted.reference.items():
        deviations = [abs(here - there) for here, there in zip(result[name], values, strict=True)]
        allowed = share * largest[name.partition("[")[0]]
        exceeded = not all(deviation <= allowed for deviation in deviations)  # true for NaN
        level = PROBLEM if exceeded else level
        if name != "time":
            verdict, unit = "  TOO MUCH" if exceeded else "", units.get(name) or units.get(name.partition("[")[0])
            lines.append(f"{name:<18} {max(deviations):9.2e} of {allowed:9.2e} {unit or ''}{verdict}")
    head = f"{name_of_set}: {len(times) - 1} steps; largest deviation of each output from the reference, of that allowed:"
    remedy = "build the FMU again; if that does not help, report it with this text" if level == PROBLEM else ""
    return Finding(level, "\n".join([head, *lines]), remedy)


def largest_values(reference):
    """Largest size of a number or of a component of a vector in the reference: dict of name without index to number."""
    largest = {}
    for name, values in reference.items():
        vector = name.partition("[")[0]
        largest[vector] = max(largest.get(vector, 0.0), *map(abs, values))
    return largest


def show(found):
    """Print findings."""
    for level, text, remedy in found:
        print(f"  {level:<8}" + "\n            ".join(text.splitlines()))
        if remedy:
            print(f"          remedy: {remedy}")


@command
def main(arguments=None, prog="python -m tetherfmu.check"):
    """Check the FMUs that are named; returns the exit status."""
    parser = Parser(prog=prog, description=f"check FMUs on this machine, each for at most {LONGEST} s")
    parser.add_argument("files", nargs="+", metavar="FILE.fmu", type=file, help="FMUs to check")
    files = parser.parse_args(arguments).files
    if importlib.util.find_spec("fmpy") is None:
        raise ModuleNotFoundError(name="fmpy")
    sys.stdout.reconfigure(errors="backslashreplace")  # paths may have letters that the terminal does not know
    show(inspection.machine())
    problems = 0
    for path in files:
        now(f"checking {path}")
        print(path)
        found = findings(path)
        show(found)
        problems += sum(each.level == PROBLEM for each in found)
    print(f"{problems} problem{'s' if problems != 1 else ''} found")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
