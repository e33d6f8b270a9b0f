"""Dependencies of the outputs at the end of initialization: `dependencies` of FMI's InitialUnknowns.

A dependency is the name of an input or a parameter: of a vector, which stands for its components, or of one component, where
`[*]` is the same component as in the output. `outputs` declares them for the dynamic tether, `variants` declares the
differences of other tethers. A test changes every input and parameter and checks which outputs change.
"""

from .inputs import BY_NAME, DRIVEN_KITE, WITHOUT_EFFECT, components, wind_at_names

POSITIONS = ("kite_position", "ground_position")
# of a winch that starts in balance, its length depends on all that the shape does
WINCH = (
    *("initial_length", "winch_control", "winch_length", "winch_start"),
    *("winch_force", "winch_damping", "winch_friction", "shortest_length", "longest_length", "damping_law"),
)
STRETCH = (*POSITIONS, *WINCH, "axial_stiffness", "diameter", "density", "gravity")
AIR_AT_REST = (
    *("wind_velocity", "diameter", "drag_coefficient", "air_density", "air_density_scale_height"),
    *("wind_profile", "wind_reference_height", "wind_exponent", "surface_roughness"),
)
AIR = ("kite_velocity", "ground_velocity", "end_velocities", *AIR_AT_REST)
GROUND = ("ground_contact", "ground_height", "ground_friction", "ground_sink")
REELING = ("reel_out_speed",)
# rope that the winch pays out slides along the ground
FORM = (*STRETCH, *AIR, *GROUND, *REELING, "segments", "initial_shape", "slack_stiffness_ratio")
WHERE_KITE_RESTS = (
    *(*STRETCH, *AIR_AT_REST, *GROUND, "segments", "slack_stiffness_ratio"),
    *("kite_load", "kite_mass", "kite_start"),  # these of a free kite alone
)
FORCE = (*FORM, "axial_damping", "slack_damping_ratio")


def depends_on(variant, output, element, shape_points, wind_points=0):
    """Names of the inputs and parameters that an element of an output depends on when initialization ends.

    variant : `variants.Variant`.  output : `outputs.Output`.  element : its FMI name, such as "kite_force[2]".
    shape_points : number of points of the output `shape`.  wind_points : of the input `wind_at`.
    """
    *point, component = element.removeprefix(output.name).strip("[]").split(",")
    declared = variant.depends_on.get(element, variant.depends_on.get(output.name, output.depends_on))
    if point:  # of the shape; its ends are the given ends of the tether
        kite = variant.depends_on.get("kite_position", ("kite_position[*]",))
        declared = {shape_points: kite, 1: ("ground_position[*]",)}.get(int(point[0]), declared)
    if variant.kite_is_free and "kite_position" in declared:
        declared = (*declared, *WHERE_KITE_RESTS)
    names = dict.fromkeys(each for name in declared for each in _components(variant, name, component))
    if wind_points and "wind_velocity" in declared:
        blown = {name for vector in WITHOUT_EFFECT for name in _components(variant, vector, component)}
        names = (*(name for name in names if name not in blown), *wind_at_names(wind_points))
    reeling_is_felt = variant.has_nodes or declared == REELING
    unused = {*variant.ignored, *(() if reeling_is_felt else REELING)}
    return tuple(name for name in names if name not in unused)


def _components(variant, name, component):
    """FMI names for the name of a dependency; component : index in the output, for `[*]`."""
    vector = name.partition("[")[0]
    known = BY_NAME.get(vector)
    names = components(name, known.size) if known and name == vector else (name.replace("*", component),)
    is_parameter = variant.kite_is_free and known and known.of == DRIVEN_KITE  # where a free kite starts
    return tuple(f"initial_{each}" for each in names) if is_parameter else names
