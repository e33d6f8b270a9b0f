"""Run flights with tether FMUs: the circle of `examples/first_flight/circular_flight.py`, a scene, a system, or a log.

The examples are in a checkout, or in a wheel.
"""

from pathlib import Path

from tetherfmu.console.ending import command
from tetherfmu.libraries.examples import example


def is_scene(flight):
    """Whether a text is a scene: a TOML file, or a name, which is no file."""
    path = Path(flight)
    return path.suffix == ".toml" or not (path.suffix or path.exists())


def fly_scene(given, parser):
    """Fly the scene or the system that the options name; other options end the program with status 2."""
    from tetherfmu.study.measuring.system_flights import file_of

    given.log, is_system = file_of(given.log)
    what = "system" if is_system else "scene"
    module = example(f"first_flight.{what}_flight")
    for name, instead in module.IN_PLACE.items():
        if getattr(given, name):
            parser.error(f"--{name} is not for a {what}: {instead}")
    return module.run(given)


@command
def main(arguments=None, prog="tetherfmu fly"):
    """Fly the scene or the log that the command line names, or else the circle; returns the exit status."""
    logged = example("first_flight.logged_flight")
    parser = logged.parser_of(prog, circle=True)
    given = parser.parse_args(arguments)
    if given.list:
        from tetherfmu.files.named import listed

        print(*listed(), sep="\n")
        return 0
    if given.log is None:
        return example("first_flight.circular_flight").main(arguments, prog)
    if is_scene(given.log):
        return fly_scene(given, parser)
    if given.rate is not None:
        parser.error(f"--rate belongs to the circle; it excludes {logged.LOG}")
    return logged.main(arguments, prog)
