"""A tether at the start of a scene."""

from tetherfmu.python import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name, inputs_of
from tetherfmu.runtime.variants import VARIANTS, class_name

MODELS = {variant: getattr(models, class_name(variant)) for variant in VARIANTS}


def tether_at_start(scene, tolerance=0.0, variant="dynamic", first=None, wind=None, **options):
    """A tether of a variant, initialized for a scene; `tolerance` 0 is the solver's default.

    It starts turning with the kite (`initial_shape = quasi_steady`), with a free end at rest.

    first : initial inputs, array (`layout.INPUTS`,); None: those of the start.  wind : at the wind points of a scene
    with them [m/s], array (wind_points, 3).  options : of TetherModel.
    """
    options = {"relative_tolerance": tolerance, "initial_shape": at.QUASI_STEADY} | options
    kind = MODELS[variant]
    if scene.kite_is_free:
        options |= {"initial_shape": at.STATIC_EQUILIBRIUM, "kite_mass": scene.flight.kite_mass}
        kind = models.TetherDynamicFree
    if scene.wind_points:
        options["wind_profile"] = at.UNIFORM  # of the box: its mean wind is in the wind at the points already
    model = kind(scene.tether, scene.environment, ground=scene.ground, wind_points=scene.wind_points, **options)
    first = scene.inputs(scene.every)[0] if first is None else first
    given = by_name(first)
    known = inputs_of(kite_is_free=False)
    values = {each.name: given[each.name] if each.size > 1 else given[each.name].item() for each in known}
    model.initialize(**values, wind_at=wind)
    return model
