"""What each output depends on when initialization ends: the `dependencies` of FMI's InitialUnknowns.

A test sets every input and parameter to another value and looks which outputs change.
"""

from .variants import FREE, library_of


def _vector(name):
    return tuple(f"{name}[{i}]" for i in (1, 2, 3))


_LENGTH = ("initial_length",)
_KITE_MOTION = _vector("kite_position") + _vector("kite_velocity")
_POSITIONS = _KITE_MOTION[:3] + _vector("ground_position")
_STRETCH = (*_POSITIONS, *_LENGTH, "axial_stiffness", "diameter", "density")
_AIR = (
    *(_KITE_MOTION[3:] + _vector("ground_velocity") + _vector("wind_velocity")),
    "end_velocities",
    *("diameter", "drag_coefficient", "air_density", "air_density_scale_height"),
    *("wind_profile", "wind_reference_height", "wind_exponent", "surface_roughness"),
)
_SHAPE = (*_STRETCH, *_AIR, "gravity", "segments", "initial_shape", "slack_stiffness_ratio")
_FORCE = (*_SHAPE, "axial_damping", "slack_damping_ratio", "damping_law", "reel_out_speed")

_EVERY_TETHER = {
    "tether_length": _LENGTH,
    "kite_end_mass": (*_LENGTH, "segments", "diameter", "density"),
    "kite_stiffness": (*_LENGTH, "axial_stiffness"),
    "kite_damping": (*_LENGTH, "axial_damping"),
    "solver_steps": (),
    "solver_rejections": (),
}
_CHAIN = dict.fromkeys(("ground_elevation", "ground_azimuth", "slack_segments", "sag"), _SHAPE)
_LINE = {"kite_damping": (), "slack_segments": (*_POSITIONS, *_LENGTH)}
_PLAN = tuple(name for name in _POSITIONS if not name.endswith("[3]"))
_ACROSS = (*_POSITIONS, *_LENGTH, "axial_stiffness", *_AIR)  # a horizontal force of the straight line knows no weight
_BY_VARIANT = {
    "dynamic": _CHAIN,
    "quasi_steady": {**_CHAIN, "kite_damping": ()},
    "catenary": {**_LINE, "kite_end_mass": ()},
    "straight": {
        **_LINE,
        **{f"{end}_force[{i}]": _ACROSS for end in ("ground", "kite") for i in (1, 2)},
        **dict.fromkeys(("ground_tension", "kite_tension", "max_tension"), (*_STRETCH, "gravity")),
        "ground_elevation": _POSITIONS,
        "ground_azimuth": _PLAN,
        "wave_time": _STRETCH,
        "sag": (),
        "solver_iterations": (),
    },
}


def depends_on(variant, name, shape_points, ignored):
    """Names of the inputs and parameters that an output depends on when initialization ends.

    variant : one of `variants.EVERY_VARIANT`.  name : of the output.  shape_points : number of points of the output `shape`.
    ignored : inputs and parameters without effect.
    """
    library = library_of(variant)
    names = {**_EVERY_TETHER, **_BY_VARIANT[library]}.get(name, (name,) if name in _KITE_MOTION else _FORCE)
    if name.startswith("shape"):
        names = _of_point(library, *name[len("shape[") : -1].split(","), shape_points)
    if variant in FREE:
        names = (f"initial_{each}" if each in _KITE_MOTION else each for each in names)
    unused = {*ignored, *(() if library == "dynamic" else ("reel_out_speed",))}
    return tuple(each for each in dict.fromkeys(names) if each not in unused)


def _of_point(variant, point, axis, shape_points):
    """What a coordinate of a point of the shape depends on: the ends of the tether are given."""
    if int(point) == 1:
        return (f"ground_position[{axis}]",)
    if int(point) == shape_points:
        return (f"kite_position[{axis}]",)
    if variant == "straight":
        return (f"ground_position[{axis}]", f"kite_position[{axis}]")
    return _SHAPE
