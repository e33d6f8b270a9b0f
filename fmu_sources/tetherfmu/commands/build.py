"""Build FMUs: all or the named ones, for this platform or others, of a system, or the advised one for a scene."""

import argparse
import re
import sys
from contextlib import contextmanager
from dataclasses import replace
from warnings import catch_warnings, simplefilter

from tetherfmu.console.ending import FAILED, command, one_line
from tetherfmu.console.options import Parser, amount, folder, named_value, names, one_of
from tetherfmu.console.progress import now
from tetherfmu.export import archive
from tetherfmu.export.archive import SLAVES
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native import native_fmus as native
from tetherfmu.export.native.host_header import PREFIX
from tetherfmu.files.lean import LISTS, NONE, PRESETS, Lean
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.libraries.examples import example
from tetherfmu.records.materials import MATERIALS, tether_of
from tetherfmu.runtime.kernel_library import PYTHONFMU, this_platform
from tetherfmu.runtime.limits import MAX_WIND_POINTS
from tetherfmu.runtime.naming import meant_or_all, prefixed
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.quantities import Quantity, quantities
from tetherfmu.runtime.variants import class_name, library_of, variant_of
from tetherfmu.wiring.selection import GROUPS
from tetherfmu.wiring.variables import variables

MAX_SHAPE_POINTS = 1001
LISTED = ("TetherDynamic", "TetherDynamicFree")  # by --list without names: a driven and a free kite end
FMI = "version of FMI, 3 with --native only (default: 2)"
SEGMENTS = dict(quantities(Tether))["segments"]
# upper limit: range of the stiffness; lower limit: digits of forces in the evidence set
DIAMETER = Quantity("m", "", 1e-4, 5.0)
OF_THE_ROPE = ("diameter", "density", "axial_stiffness", "axial_damping")


def fmu(text):
    """Type of a name of an FMU, in any spelling."""
    with prefixed("", argparse.ArgumentTypeError):
        return class_name(variant_of(text))


def platforms(text):
    """Type of a list of platforms, separated by commas, or all."""
    names = tuple(TARGETS) if text == "all" else tuple(text.split(","))
    for name in names:
        if name not in TARGETS:
            hint = meant_or_all(name, (*TARGETS, "all"), "choose from {}")
            raise argparse.ArgumentTypeError(f"there is no platform {name!r}{hint}")
    return names


def points(most):
    """Type of a number of points: none, or from 2 to a maximum."""

    def converted(text):
        if not text.isdecimal() or int(text) not in (0, *range(2, most + 1)):
            raise argparse.ArgumentTypeError(f"{text!r} is not possible; it must be 0, or from 2 to {most}")
        return int(text)

    return converted


def c_prefix(text):
    """Type of a prefix of C names."""
    if not re.fullmatch(r"[A-Za-z_]\w*", text, re.ASCII):
        raise argparse.ArgumentTypeError(f"{text!r} cannot begin a name in C; use letters, digits and _")
    return text


def starts_of(diameter, material):
    """Start values of a rope that differ from the default tether, pairs (parameter, value).

    diameter [m], material : None for those of the default tether.
    """
    default = Tether()
    diameter = default.diameter if diameter is None else diameter
    tether = tether_of(material, diameter) if material else default.with_diameter(diameter)
    return tuple((name, getattr(tether, name)) for name in OF_THE_ROPE if getattr(tether, name) != getattr(default, name))


def parse(arguments, prog="tetherfmu build"):
    """Command line options; wrong ones end the program with status 2."""
    parser = Parser(prog=prog)
    option = parser.add_argument
    option("names", nargs="*", type=fmu, metavar="NAME", help=f"FMUs to build, of {', '.join(SLAVES)} (default: all)")
    option("--out", default="dist", type=folder, metavar="DIR", help="folder of the FMUs (default: dist)")
    _add_start_values(parser)
    _add_variables(parser)
    _add_points(option)
    _add_flavours(option)
    options = parser.parse_args(arguments)
    for problem in _problems(options):
        parser.error(problem)
    options.header = options.header_prefix or options.header
    if options.system is None and options.shape_points is None:
        options.shape_points = BuildOptions.shape_points
    return options


def _add_start_values(parser):
    """Declare the start values of the rope."""
    option = parser.add_argument
    about = f"start value of segments (default: {BuildOptions.segments})"
    option("--segments", type=amount(SEGMENTS, whole=True), metavar="N", help=about)
    about = "start value of diameter [m]; scales stiffness and damping with its square (default: 0.004)"
    option("--diameter", type=amount(DIAMETER), metavar="D", help=about)
    about = "start values of density, stiffness and damping of a rope of this material (default: 724 kg/m3 and 49 GPa)"
    parser.add_choice("--material", tuple(MATERIALS), help=about)


def _add_variables(parser):
    """Declare the variables of the FMU, and start values of any of them."""
    option = parser.add_argument
    parser.add_choice("--preset", tuple(PRESETS), help="variables for a kind of scene (default: all variables)")
    for key in LISTS:
        groups = f"groups ({', '.join(GROUPS)})" if key == "inputs" else "groups"
        about = f"{key} of the FMU by names, {groups} or patterns; {NONE} for none (default: all)"
        option(f"--{key}", type=names, metavar="NAME,...", help=about)
    about = "start value of an input or a parameter; may be repeated; constant if the FMU omits the variable; "
    about += "a diameter scales stiffness and damping that are not set"
    option("--list", action="store_true", help="list the variables that the FMUs would have, and build none")
    option("--set", dest="starts", type=named_value, action="append", default=[], metavar="NAME=VALUE", help=about)


def lean_of(wanted):
    """`Lean` of the options. wanted : as `parse` returns it."""
    return Lean(**{key: getattr(wanted, key) for key in LISTS}, starts=tuple(wanted.starts), preset=wanted.preset)


def _add_points(option):
    """Declare the points of the shape and of the wind; option : adds one to the parser."""
    usual = f"(default: {BuildOptions.shape_points}; of a system, one at each node)"
    about = f"points of the output shape, 0 for none {usual}"
    option("--shape-points", type=points(MAX_SHAPE_POINTS), metavar="K", help=about)
    about = "points of the input wind_at, which replaces wind_velocity and the profile; 0 for none (default: 0)"
    option("--wind-points", type=points(MAX_WIND_POINTS), default=BuildOptions.wind_points, metavar="K", help=about)


def _add_flavours(option):
    """Declare the options for hosts and contents of the FMUs; see `_add_points`."""
    here = this_platform()
    about = f"platforms to compile for, of {', '.join(TARGETS)}, or all (default: {here}, this one)"
    option("--platforms", type=platforms, default=here, metavar="P,...", help=about)
    option("--examples", action="store_true", help="also build the FMUs and systems (SSP) of the examples")
    option("--native", action="store_true", help="build FMUs that need no Python in their host")
    option("--fmi", type=lambda text: int(one_of("23")(text)), default=2, metavar="{2,3}", help=FMI)
    about = "with --native: also write a C header for hosts, with value references and the guid or token"
    option("--header", action="store_const", const=PREFIX, help=about)
    about = f"with --header: prefix of its names, for several headers in one C file (default: {PREFIX})"
    option("--header-prefix", type=c_prefix, metavar="TEXT", help=about)
    about = "with --native: add C sources to the FMU, which importers compile for any other processor"
    option("--sources", action="store_true", help=about)
    about = "build one FMU from the system of tethers in this file, with its names of lines and points"
    option("--system", metavar="FILE", help=about)
    option("--scene", metavar="FILE", help="build the FMU recommended for this scene or system, without unused variables")


def _problems(options):
    """Sentences on options that do not go together."""
    own = options.names, options.segments, options.diameter, options.material, options.examples
    if options.scene is not None and any(own):
        yield (
            "--scene chooses the FMU and its start values; it excludes NAME, --segments, --diameter, --material and "
            "--examples"
        )
    if options.system is not None and any((*own, options.scene)):
        yield (
            "the file of --system has the lines and their start values; it excludes NAME, --segments, --diameter, "
            "--material, --examples and --scene"
        )
    if options.material is not None and "diameter" in dict(options.starts):
        yield "--material sets stiffness and damping for --diameter; give the diameter with it, not with --set"
    for name in {"diameter", "segments"} & {each for each, _ in options.starts}:
        if getattr(options, name) is not None:
            yield f"--{name} and --set {name} are both given; give one of them"
    if options.list and (options.scene is not None or options.system is not None):
        yield "--list is for FMUs by NAME; it excludes --scene and --system"
    if options.fmi == 3 and not options.native:
        yield "PythonFMU makes FMUs for FMI 2; --fmi 3 requires --native"
    if options.header and not options.native:
        yield "--header is for hosts in C, which use native FMUs; it requires --native"
    if options.header_prefix and not options.header:
        yield "--header-prefix is for the names of a header; it requires --header"
    if options.sources and not options.native:
        yield "only native FMUs have C sources; --sources requires --native"
    if options.examples and options.native:
        yield "the FMUs of the examples are written in Python; --examples excludes --native"


@contextmanager
def said(name="", about=None):
    """Print doubts on stderr; end the program if the FMU is impossible. name : of the FMU, before each line.

    about : dict (modified) that gets the names of the FMUs by the doubt instead, to `tell` each doubt once.
    """
    with catch_warnings(record=True) as doubts:
        simplefilter("always", UserWarning)
        try:
            yield
        except ValueError as error:
            raise WrongUse(f"{name}: {one_line(error)}" if name else one_line(error)) from None
    found = {} if about is None else about
    for text in dict.fromkeys(str(doubt.message) for doubt in doubts):
        found.setdefault(text, []).append(name)
    if about is None:
        tell(found)


def tell(about):
    """Print doubts to stderr, each with the names of the FMUs that have it; about : as of `said`."""
    for text, fmus in about.items():
        print(f"{', '.join(fmus)}: {text}" if any(fmus) else text, file=sys.stderr)


def build_for_system(wanted, path, starts=()):
    """Build the FMU of a system; WrongUse if its file is unusable.

    wanted : result of `parse`.  path : of the file.  starts : values that --set overrides.
    """
    from tetherfmu.export import system_fmus

    points = {"shape_points": wanted.shape_points, "wind_points": wanted.wind_points}
    lean = lean_of(wanted)
    lean = replace(lean, starts=(*starts, *lean.starts))
    options = BuildOptions(platforms=wanted.platforms, lean=lean, **points)
    with said():
        native = wanted.fmi if wanted.native else None
        made = system_fmus.build(path, wanted.out, options, native, wanted.header, wanted.sources, now)
    show(made, wanted.platforms, wanted.header)
    return 0


def build_for_system_of(wanted, path):
    """Build the FMU of a system with the segments and the tolerance that are advised for its file; returns as the others.

    path : of the file.
    """
    from tetherfmu.study.advice.system_advice import advised, start_values

    flight, advice, text = advised(path)
    print(text)
    if not advice.met:
        return FAILED
    return build_for_system(wanted, path, start_values(flight, advice))


def build_for_scene(wanted):
    """Build the advised FMU for a scene; returns 1 if nothing meets its requirements.

    wanted : result of `parse`, also in `build`.
    """
    from tetherfmu.study.advice.scene_build import advised
    from tetherfmu.study.measuring.system_flights import file_of

    path, is_system = file_of(wanted.scene)
    if is_system:
        return build_for_system_of(wanted, path)
    now(f"flying {wanted.scene} with candidates and a finer model")
    text, met, name, options = advised(wanted.scene, wanted.shape_points, wanted.platforms, lean_of(wanted))
    print(text)
    if not met:
        return FAILED
    with said(name):
        build(wanted, name, options)
    return 0


def show(path, platforms, with_header=None):
    """Print a line on a finished FMU, and one on its header."""
    print(f"{path}  {path.stat().st_size / 1000:.0f} kB  for {', '.join(platforms)}")
    if with_header:
        print(f"{path.with_suffix('.h')}  value references for hosts in C")


def build(wanted, name, options):
    """Build an FMU of the flavour that is wanted, with these `BuildOptions`, and print a line on it."""
    if wanted.native:
        made = native.build(name, wanted.out, options, wanted.fmi, wanted.header, wanted.sources)
    else:
        made = archive.build(name, wanted.out, options)
    show(made, options.platforms, wanted.header)


def list_variables(wanted, lean, segments):
    """Print the variables of the named FMUs, without names those of `LISTED`. wanted : result of `parse`."""
    for name in wanted.names or LISTED:
        with said(name):
            table = variables(SLAVES[name], wanted.shape_points, (("segments", segments),), wanted.wind_points)
            print(f"{name}:", *lean.listed(table), sep="\n")
    return 0


@command
def main(arguments=None, prog="tetherfmu build"):
    """Build the requested FMUs; returns the exit status, 0 only if all were built."""
    wanted = parse(arguments, prog)
    if wanted.system is not None:
        return build_for_system(wanted, wanted.system)
    if wanted.scene is not None:
        return build_for_scene(wanted)
    segments, lean = wanted.segments or BuildOptions.segments, lean_of(wanted)
    lean = replace(lean, starts=(*starts_of(wanted.diameter, wanted.material), *lean.starts))
    if wanted.list:
        return list_variables(wanted, lean, segments)
    chosen, platforms = wanted.names or list(SLAVES), wanted.platforms
    ready.folders([library_of(SLAVES[name]) for name in chosen], platforms)  # all at once is faster
    options = BuildOptions(segments, wanted.shape_points, platforms, lean, wind_points=wanted.wind_points)
    about = {}
    try:
        for name in chosen:
            with said(name, about):
                build(wanted, name, options)
    finally:
        tell(about)
    if wanted.examples:
        fmus = example("shared.example_fmus")
        for name in fmus.SLAVES:
            show(fmus.build(name, wanted.out), PYTHONFMU)
        for path in example("shared.ssp").write_all(wanted.out, BuildOptions(platforms=platforms)):
            print(f"{path}  {path.stat().st_size / 1000:.0f} kB  a system of FMUs")
    return 0
