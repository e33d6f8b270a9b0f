"""Fly a kite with tether FMUs: on the circle of `examples/first_flight/circular_flight.py`, in a scene, or along a log.

The examples are those of a checkout, or those that a wheel carries.
"""

from pathlib import Path

from tetherfmu.console.ending import command
from tetherfmu.libraries.examples import example


def is_scene(flight):
    """Whether a text is a scene: a TOML file, or a name, which is no file."""
    path = Path(flight)
    return path.suffix == ".toml" or not (path.suffix or path.exists())


@command
def main(arguments=None, prog="tetherfmu fly"):
    """Fly the scene or the log that the command line names, or else the circle; returns the exit status."""
    logged = example("first_flight.logged_flight")
    parser = logged.parser_of(prog, circle=True)
    given = parser.parse_args(arguments)
    if given.list:
        from tetherfmu.study.scenes.named import listed

        print(*listed(), sep="\n")
        return 0
    if given.log is None:
        return example("first_flight.circular_flight").main(arguments, prog)
    if is_scene(given.log):
        scene = example("first_flight.scene_flight")
        for name, instead in scene.IN_PLACE.items():
            if getattr(given, name):
                parser.error(f"--{name} is not for a scene: {instead}")
        return scene.run(given)
    if given.rate is not None:
        parser.error(f"--rate is of the circle; it goes without {logged.LOG}")
    return logged.main(arguments, prog)
