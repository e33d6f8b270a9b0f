"""Write docs/use/interface.md from the table of FMI variables: `python docs/make/make_interface.py`."""

from itertools import product
from pathlib import Path

from tetherfmu.export.archive import SLAVES
from tetherfmu.export.documents import folded, meaning, start
from tetherfmu.fmi.model_description import number_text
from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.fmi.selection import GROUPS, in_order
from tetherfmu.lean import LISTS, PRESETS, Lean
from tetherfmu.runtime.inputs import WIND_AT
from tetherfmu.runtime.variables import INPUT, LOCAL, OUTPUT, PARAMETER, variables
from tetherfmu.runtime.variants import TABLE, class_name

PAGE = Path(__file__).resolve().parents[1] / "use" / "interface.md"
TEXT = """# Interface

<!-- Written by docs/make/make_interface.py from the sources: edit those, and run it again. -->

Inputs, outputs and parameters of {fmus}.
Names, units, causality and signs are the same in each, so that one replaces another without rewiring; only
`TetherDynamicFree.fmu` differs at [the kite end](#a-free-kite-end).
FMI 2.0 co-simulation, SI units, structured names; what differs in FMI 3.0: [Importing](importing.md).

Frame: right-handed, z up, origin where you want it; gravity acts along -z, heights count from z = 0.

Signs: a force is what the tether exerts on the body that its name says: `kite_force` goes into the equations of motion of
the kite as it is. Tension is positive when the tether pulls. `reel_out_speed` is positive when the tether gets longer.

![Ground end and kite end with frame and signs: the forces point from each end along the tether](../figures/signs.png)

## Exchange

In a communication step from t to t + h:

1. set the inputs with the values at t (an input that is not set keeps its value),
2. do the step,
3. read the outputs: they belong to t + h.

Within the step the tether moves its ends on a smooth curve to the predicted position $p + v h + a h^2/2$, with $a$ from
the last two velocities ([Driven ends](../models/theory.md#driven-ends)). Position and velocity of an end must fit
together; the tether follows the position and relies on the velocity. It gives one warning if they contradict each other, as
when `kite_velocity` is left at 0. The reel-out speed is extrapolated linearly from its last two values within the step
([Inputs within a step](../models/theory.md#inputs-within-a-step)); where it jumps, as the set points of a winch do, set
`input_continuation` to 2 (held). The wind is held. A native FMU takes the derivatives of inputs instead of all these
estimates, if the importer has them ([Derivatives](../reference/derivatives.md)). The outputs at t = 0 are there when the
initialization ends; in initialization mode they are calculated whenever they are read.

A tool that knows positions only sets `end_velocities` to 2 (derived). For smooth motion that costs little (figures of eight
at 40 m/s, 20 ms: force error 0.004 % instead of 0.001 %), with noise more (1 mm: 1.6 % instead of 0.3 %); in the first step
the ends rest.

A step is refused with a message if an input is not finite, the step is not positive, reeling in would
leave segments shorter than 1 cm, a winch without mass would have to push, or the solver fails. The state then does not
change, and the next good step works. A parameter out of range is refused when the initialization ends, with the allowed
range.

One warning each is logged, and the numbers are not changed, when a segment is stretched by more than 5 %, an end is
accelerated beyond 1000 g or moves faster than sound, positions contradict velocities, the winch reels in a slack tether, or
`winch_length` is far too long ([Plausibility](../models/theory.md#plausibility)). Others tell that a step
would have taken [too many internal steps](../models/numerics.md#too-many-internal-steps), that fixed steps
[fall back](../models/numerics.md#three-stages), and that the load on a catenary is not that along its chord.

## The winch

The winch is at the ground end. The parameter `winch_control` says which of three inputs it obeys; the other two are not
read after the start.

| `winch_control` | input | what the winch does |
|---|---|---|
| 1 (speed) | `reel_out_speed` | it pays out at this speed, whatever the tension |
| 2 (force) | `winch_force` | it pulls with this force; the tension decides whether the tether is paid out or reeled in |
| 3 (length) | `winch_length` | it pays out or reels in to this unstretched length, as a driven end moves to its position |

Take the one that you know: the set point of a speed controller, the tension that a winch holds or the torque of its motor
over the radius of the drum, the length in a log. An error of a length matters: one metre too little makes a taut tether of
500 m pull with 1.2 kN more. With a force there is no such effect. `tether_length` and `winch_speed` say what the winch does,
whatever controls it.

With force control the drum turns by its own equation of motion, together with the tether and not one step later:

    winch_mass * acceleration = tension - winch_force - winch_damping * speed - winch_friction * sign(speed)

Speed and acceleration are those at the rope, positive when it pays out; `winch_mass` is the inertia of drum and motor
divided by the square of the radius. The tension is `ground_tension`; without mass, damping and friction it equals
`winch_force` at every instant. Friction holds a drum at rest until the tension differs from `winch_force` by more than
`winch_friction`. At `shortest_length` and `longest_length` the drum stops without bouncing, and leaves the stop when it is
driven back. It starts with `initial_length` and `reel_out_speed`; `winch_force` acts from the first step on and continues
linearly within a step as the reel-out speed does. If you do not know the length, set `winch_start` = 2 (equilibrium): it is
then the one at which the tether pulls with the `winch_force` of the start. Only a drum with mass can push the tether out:
without mass `winch_force` must be at least minus `winch_friction`.

## The ground

By default a tether hangs wherever its weight takes it, also below the station. With `ground_contact` = 2 (flat) it lies
on a plane at `ground_height`, with the friction `ground_friction`; a free kite lands on it with its mass. At rest a tether
sinks `ground_sink` deep, which sets the stiffness of the ground; the catenary has a rigid one, and the straight line
ignores it. `grounded_length` says how much of the tether lies there. The ends are where the inputs say, also below the
ground, and no force of the ground is in their forces: what it carries is missing from them. A tether that hangs below
`ground_height` without ground contact, both ends above it, says so once. Equations: [Ground](../models/theory.md#ground).

## Coupling by force

A kite model that integrates its motion from `kite_force` gets it one step late, which is destabilizing along a taut tether
and limits the communication step. `TetherDynamicFree.fmu`, which integrates the motion of the kite itself, has no such
limit: [Coupling](coupling.md).

## Inputs

{inputs}

`wind_at` is an input of an FMU that is built with `tetherfmu build --wind-points K` (at least 2), and of no other: the
wind at K points at equal unstretched lengths, ground first, linear in between ([Wind at
points](../models/theory.md#wind-at-points)). It is all the wind then: `wind_velocity` and the parameters of the profile
are there and ignored. In an FMU for FMI 3 it is one array of K x 3 numbers. The FMU
[`TurbulentWind`](example_fmus.md#turbulent-wind) gives it, from a box of turbulence; in Python it is the argument
`wind_at` of `initialize`, `step` and `fly` (a row of points for each step) of a tether that is made with `wind_points=K`,
and `FrozenTurbulence` of the [Python API](../reference/api.md#turbulence) reads it from a box.
[Scenes](how_much_tether.md#scene-files) have it from `wind.file`.

## Outputs

{outputs}

End forces contain the weight of the half segment that is lumped at the end, not its inertia ([End
forces](../models/theory.md#end-forces)).

Local variables are read and plotted, not connected: a block for the FMU has no ports for them. FMPy's `simulate_fmu`
records them where its argument `output` names them.

{local}

K is a build option, `--shape-points`, {points} by default; 0 leaves the shape out. In an FMU that is built with
`--wind-points` the shape is an output, because the model of the wind is connected to it.

In some tethers these have another meaning:

{notes}

## A free kite end

In `TetherDynamicFree.fmu` the kite end is a point mass that moves under the force of the tether, its weight and a load. The
importer computes the load from `kite_position` and `kite_velocity`, which are outputs there: those at the end of the step
before. These variables differ; all others are as above and below, and value references are the same in all tethers:

{free}

The load is extrapolated within the step as the reel-out speed is. With `kite_mass` 0 the end has the mass of the half
segment only. The start is the `initial_shape` between the ground end and `initial_kite_position`; the load acts from the
first step on. `end_velocities` concerns the ground end only.

## Parameters

All are fixed: set them before the initialization ends.

{parameters}

"Greater than" excludes the limit itself; FMI can only say min and max, so an importer may let the limit pass, and the FMU
refuses it. More rules: with wind_profile 3 or 4 surface_roughness must be less than wind_reference_height; initial_length
must be at least 0.01 m for each segment; shortest_length must be less than longest_length, unless that is 0, and with force
control initial_length must lie between them.

`segments` starts at the build option `--segments`, {segments} by default.

Parameters that a tether ignores (their range is checked all the same):

{ignored}

## Only what a scene needs

A full FMU has all of this. A lean one has the variables that you name, and no other:

```bash
tetherfmu build TetherDynamic --preset kite
tetherfmu build TetherDynamic --inputs motion,reel_out_speed --outputs forces --parameters none --set wind_velocity=8,0,0
```

`--inputs`, `--outputs` (local variables, too) and `--parameters` take names without the index of an element, groups and
patterns with * and ?; `none` is none, and what is not given has all. In a system a name without its point or line stands
for those of all. What is left out is constant: it keeps its start value, or that of `--set NAME=VALUE`, which takes any
input or parameter, with a unit if you like ("6 mm"). A diameter alone scales stiffness and damping. The builder checks the
start values as the FMU does at its start. Value references and numbers are those of the full FMU. Saved states go from one
to the other where the constants are equal, and are refused where they are not. Files of scenes and systems have the
same keys in a table `[build]` (`inputs`, `outputs`, `parameters`, `preset`, and a table `set`); in Python it is the argument
`lean` of `BuildOptions`. The documentation page in the FMU lists its constants, and
annotations of the model description have them for tools: `tetherfmu fly --fmu` refuses an FMU whose constants are not
those of the scene. With the usual start values an evidence set
goes with it, of the variables that it has; with others where the scene of the set can still be flown.

{presets}

{groups}
"""


def table(head, rows):
    """Markdown table of rows of texts."""
    lines = ["| " + " | ".join(row) + " |" for row in (head, *rows)]
    return "\n".join([lines[0], "|---" * len(head) + "|", *lines[1:]])


def signals(causality):
    """Table of the variables of a causality other than that of parameters."""
    listed = [v for v in variables("dynamic", DEFAULT_OPTIONS["shape_points"]) if v.causality == causality]
    if causality == INPUT:
        listed += [v for v in variables("dynamic", 0, wind_points=2) if v.name.startswith(f"{WIND_AT.name}[")]
    head = ("name", "unit", "start", "meaning") if causality == INPUT else ("name", "unit", "meaning")
    rows = []
    for name, each in folded(listed):
        columns = [f"`{name}`", each[0].quantity.unit or "-", meaning(each)]
        if causality == INPUT:
            columns.insert(2, start(each))
        rows.append(columns)
    return table(head, rows)


def parameters():
    """Table of the parameters, in the order of the model description."""
    rows = [
        (f"`{v.name}`", v.quantity.unit or "-", number_text(v.start), v.quantity.in_words(), v.quantity.meaning)
        for v in in_order(variables("dynamic", 0))
        if v.causality == PARAMETER
    ]
    return table(("name", "unit", "start", "allowed", "meaning"), rows)


def presets():
    """Table of what each preset leaves of the two dynamic tethers, and how many variables FMI 2 counts."""
    rows = []
    for preset, variant in product([None, *PRESETS], ("dynamic", "dynamic_free")):
        full = variables(variant, DEFAULT_OPTIONS["shape_points"])
        missing = Lean(preset=preset).left_out(full)
        kept = [each for each in full if each.name not in missing]
        counts = [
            str(len({each.name.partition("[")[0] for each in kept if each.causality in causalities}))
            for causalities in LISTS.values()
        ]
        rows.append((f"`{preset}`" if preset else "none", class_name(variant), *counts, str(len(kept))))
    return table(("preset", "FMU", "inputs", "outputs and local variables", "parameters", "variables of FMI 2"), rows)


def groups():
    """Table of the groups and their variables."""
    found = {}
    for each in (*variables("dynamic_free", 1), *variables("dynamic", 1, wind_points=2)):
        found.setdefault(each.group, {})[f"`{each.name.partition('[')[0]}`"] = None
    return table(("group", "what", "variables"), [(f"`{key}`", what, ", ".join(found[key])) for key, what in GROUPS.items()])


def free_kite():
    """Table of the variables that only the tether with a free kite end has, or has in another role."""
    driven = {(v.name, v.causality) for v in variables("dynamic", 0)}
    listed = [v for v in variables("dynamic_free", 0) if (v.name, v.causality) not in driven]
    rows = []
    for name, each in folded(listed):
        first = start(each) if each[0].start is not None else ""
        allowed = each[0].quantity.in_words() if each[0].causality == PARAMETER else ""
        rows.append((f"`{name}`", each[0].causality, each[0].quantity.unit, first, allowed, meaning(each)))
    return table(("name", "causality", "unit", "start", "allowed", "meaning"), rows)


def by_tether(field, last_column):
    """Table of what a field of `variants.Variant` says of variables, equal texts in one row."""
    tethers = {}
    for variant in reversed(TABLE):
        for name, text in getattr(variant, field).items():
            tethers.setdefault((name, text), []).append(class_name(variant.name))
    rows = [(f"`{name}`", ", ".join(fmus), text) for (name, text), fmus in tethers.items()]
    return table(("name", "FMU", last_column), rows)


def page():
    """Text of docs/use/interface.md."""
    return TEXT.format(
        fmus=", ".join(f"`{name}.fmu`" for name in SLAVES),
        inputs=signals(INPUT),
        outputs=signals(OUTPUT),
        local=signals(LOCAL),
        free=free_kite(),
        parameters=parameters(),
        notes=by_tether("meanings", "meaning"),
        ignored=by_tether("ignored", "why"),
        presets=presets(),
        groups=groups(),
        points=DEFAULT_OPTIONS["shape_points"],
        segments=DEFAULT_OPTIONS["segments"],
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
