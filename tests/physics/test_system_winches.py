"""Winches of the lines of a system: told a speed, a length or a force.

Y with drums:                     m du/dt = T - W - c u, dL/dt = u beside the equations of `networks.py`, by DOP853
"""

import numpy as np
import pytest

from networks import Network
from tetherfmu import Environment, Line, Point, Solver, StepRefused, Tether, TetherSystem, Winch

STEP = 0.02
WIND = (8.0, 1.0, 0.0)
POINTS = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", (60.0, 0.0, 80.0), (1.0, 2.0, 0.0))]
TETHER = Tether(segments=6, initial_length=100.2)


SOFT = {"axial_stiffness": 20000.0, "axial_damping": 40.0}  # so that an explicit method needs few steps
MAIN = Tether(segments=4, initial_length=98.0, **SOFT)
ARM = Tether(segments=3, initial_length=39.0, **SOFT)


def test_drums_at_a_y_move_as_their_equations_say():
    """A drum with mass at the ground, one on the free knot, and one without mass at a kite."""
    points = [
        Point("station", (0.0, 0.0, 0.0)),
        Point("knot", (3.0, 1.0, 100.0), mass=2.0),
        Point("left", (-23.0, 0.0, 131.0), (0.0, 3.0, 1.0)),
        Point("right", (26.0, 0.0, 131.0), (0.0, -4.0, 2.0)),
    ]
    drums = {
        "main": Winch(winch_control="force", winch_mass=8.0, winch_damping=20.0),
        "a": Winch(winch_control="force", winch_mass=5.0),
        "b": Winch(winch_control="force", winch_damping=150.0),
    }
    ends = {"main": ("station", "knot", MAIN), "a": ("knot", "left", ARM), "b": ("right", "knot", ARM)}
    lines = [Line(name, *each, 0.0, drums[name]) for name, each in ends.items()]
    forces = {"main": 600.0, "a": 300.0, "b": 250.0}
    motions = {
        each.name: (lambda time, each=each: (np.add(each.position, time * np.array(each.velocity)), np.array(each.velocity)))
        for each in points
        if each.is_driven
    }
    load = {"knot": np.array((10.0, 20.0, -30.0))}
    constant = {name: (lambda _, force=force: force) for name, force in forces.items()}
    network = Network(points, lines, Environment(), np.array(WIND), motions, load, constant)
    system = TetherSystem(points, lines, solver=Solver(relative_tolerance=1e-8))
    system.initialize(WIND, loads=load)
    times = STEP * np.arange(13)
    solution = network.integrate(network.state(system.positions, system.velocities), times)

    for k, y in enumerate(solution):
        driven = {name: motion(k * STEP) for name, motion in motions.items()}
        outputs = system.step(
            STEP,
            {name: x for name, (x, _) in driven.items()},
            {name: v for name, (_, v) in driven.items()},
            winch_forces=forces,
        )
        x, _ = network.unpacked(times[k + 1], y)
        # 1e-8 of segments of 25 m; a point whose mass grows by the forces of one line only is wrong by 2e-7
        np.testing.assert_allclose(network.gathered(system.positions), x, rtol=0, atol=1e-7)
        found = [outputs.lines[name].tether_length for name in forces]
        np.testing.assert_allclose(found, y[-6:-3], rtol=0, atol=1e-6)
    found = [outputs.lines[name].winch_speed for name in ("main", "a")]
    np.testing.assert_allclose(found, y[-3:-1], rtol=0, atol=1e-5)
    assert np.abs(np.subtract(found, 0.0)).min() > 0.1  # the drums turn


def test_what_a_winch_cannot_do_is_refused_by_its_line():
    system = TetherSystem(POINTS, [Line("line", "ground", "kite", TETHER, 0.0, Winch(winch_control="length"))])
    system.initialize(WIND)
    system.step(STEP, winch_lengths={"line": 100.2})
    before = system.get_state()
    with pytest.raises(StepRefused, match=r"the line line: .*winch_length"):
        system.step(STEP, winch_lengths={"line": -5.0})
    with pytest.raises(StepRefused, match=r"line\.winch_force is nan"):
        system.step(STEP, winch_forces={"line": np.nan})
    with pytest.raises(ValueError, match="no winch_length of a line or a winch with the name 'rope'"):
        system.step(STEP, winch_lengths={"rope": 5.0})
    assert np.array_equal(system.get_state(), before)


@pytest.mark.parametrize(
    ("winch", "force", "words"),
    [
        (Winch(winch_control="force", longest_length=50.0), None, "the line line: .*longest_length"),
        (Winch(winch_control="force"), -100.0, "the line line: .*winch_force"),
    ],
)
def test_what_a_drum_cannot_do_is_refused_by_its_line(winch, force, words):
    system = TetherSystem(POINTS, [Line("line", "ground", "kite", TETHER, 0.0, winch)])
    if force is None:
        with pytest.raises(StepRefused, match=words):
            system.initialize(WIND)
        return
    system.initialize(WIND)
    before = system.get_state()
    with pytest.raises(StepRefused, match=words):
        system.step(STEP, winch_forces={"line": force})
    assert np.array_equal(system.get_state(), before)
    system.step(STEP, winch_forces={"line": 300.0})
