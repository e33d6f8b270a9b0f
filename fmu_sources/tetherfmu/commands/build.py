"""Build FMUs: all or the named ones, for this platform or others, or the one that is advised for a scene."""

import argparse
import sys

from tetherfmu.export.archive import SLAVES, build, contents
from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.runtime.layout import MAX_SEGMENTS
from tetherfmu.runtime.variants import class_name, variant_of

MAX_SHAPE_POINTS = 1001


def parse(arguments):
    """Command line options; wrong ones end the program with status 2."""
    parser = argparse.ArgumentParser(prog="tetherfmu build", description="Build tether FMUs.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"FMUs to build: {', '.join(SLAVES)}; none: all")
    parser.add_argument("--out", default="dist", metavar="DIR", help="output folder (default: dist)")
    parser.add_argument("--segments", type=int, default=20, metavar="N", help="start value of segments (default: 20)")
    parser.add_argument(
        "--shape-points", type=int, default=21, metavar="K", help="points of the output shape, 0 for none (default: 21)"
    )
    parser.add_argument(
        "--platforms",
        default=this_platform(),
        metavar="P,...",
        help=f"platforms to compile for, of {', '.join(TARGETS)}, or all (default: this one, {this_platform()})",
    )
    parser.add_argument(
        "--scene", metavar="FILE", help="build the one FMU that is advised for this scene, with no more than it needs"
    )
    options = parser.parse_args(arguments)
    options.platforms = list(TARGETS) if options.platforms == "all" else options.platforms.split(",")
    for platform in options.platforms:
        if platform not in TARGETS:
            parser.error(f"no platform is called {platform}; choose from {', '.join(TARGETS)}")
    try:
        options.names = [class_name(variant_of(name)) for name in options.names]
    except ValueError as error:
        parser.error(str(error))
    if not 1 <= options.segments <= MAX_SEGMENTS:
        parser.error(f"--segments is {options.segments}; it must be from 1 to {MAX_SEGMENTS}")
    if options.shape_points not in (0, *range(2, MAX_SHAPE_POINTS + 1)):
        parser.error(f"--shape-points is {options.shape_points}; it must be 0, or from 2 to {MAX_SHAPE_POINTS}")
    return options


def build_for_scene(options):
    """Build the FMU that is advised for a scene; returns 0, 1 if nothing meets what it asks for, 2 if the file is wrong."""
    from tetherfmu.study.advice.scene_build import SceneError, advised

    try:
        advice = advised(options.scene, options.shape_points)
    except SceneError as error:
        print(error, file=sys.stderr)
        return 2
    print(advice.text)
    if not advice.met:
        return 1
    show(build(advice.fmu, options.out, advice.segments, advice.shape_points, options.platforms, advice.trim))
    return 0


def show(path):
    """Print a line on a finished FMU."""
    print(f"{path}  {path.stat().st_size / 1024:.0f} kB  for {', '.join(contents(path))}")


def main(arguments=None):
    """Build what was asked for; returns the exit status, 0 only if all was built."""
    options = parse(arguments)
    names = options.names or list(SLAVES)
    try:
        if options.scene:
            return build_for_scene(options)
        ready.folders([SLAVES[name][1] for name in names], options.platforms)  # all at once is faster
        for name in names:
            show(build(name, options.out, options.segments, options.shape_points, options.platforms))
    except (OSError, RuntimeError) as error:
        print(f"not built: {error}", file=sys.stderr)
        return 1
    return 0
