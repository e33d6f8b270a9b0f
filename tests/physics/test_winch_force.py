"""A winch that is told a force: formulas of drum, rope and load, and an independent solution (`tests/networks.py`)."""

import numpy as np
import pytest
from scipy.optimize import brentq

from mechanics import pluck
from networks import Network
from solvers import MODELS
from tetherfmu import (
    EnergyAudit,
    Environment,
    Line,
    Point,
    StepRefused,
    Tether,
    TetherDynamic,
    TetherDynamicFree,
    TetherQuasiSteady,
    TetherStraight,
    Winch,
)

IN_EQUILIBRIUM = MODELS[1:]
FIXED = {"fixed_step": 0.01}
AND_FIXED = [*((model, {}) for model in MODELS), (TetherDynamic, FIXED)]
NOTHING = {"gravity": 0.0, "air_density": 0.0}  # acts on the tether
G = 9.81  # [m/s2]


def on_drum(model, distance=100.0, **options):
    """A tether on its drum along x, between two ends that stay."""
    tether = model(winch_control="force", **options)
    tether.initialize(kite_position=(distance, 0.0, 0.0))
    return tether


def spring(**options):
    """A spring between a drum and an end that stays: one segment without mass between its nodes, without damper and load."""
    chosen = {
        "initial_length": 100.0,
        "axial_stiffness": 1e5,
        "axial_damping": 0.0,
        "relative_tolerance": 1e-8,
        "density": 1e-3,
    }
    return on_drum(TetherDynamic, segments=1, **NOTHING, **(chosen | options))


# --- formulas


@pytest.mark.parametrize(("stiffness", "solver"), [(1e9, {"relative_tolerance": 1e-8}), (1e7, {"fixed_step": 0.02})])
def test_atwood(stiffness, solver):
    """A load and a drum on a light rope of the strain s = M a/EA: M a = m (g - (1 + s) a); order 2 knows constant ones."""
    load, drum, length = 20.0, 30.0, 10.0
    rope = {"initial_length": length, "axial_stiffness": stiffness, "density": 1e-3, "air_density": 0.0, "segments": 1}
    tether = TetherDynamicFree(kite_mass=load, winch_control="force", winch_mass=drum, **solver, **rope)
    strain = load * drum * G / (load + drum) / stiffness  # but for its own square
    acceleration = load * G / (load * (1.0 + strain) + drum)
    stretched = length * (1.0 + drum * acceleration / stiffness)
    tether.initialize(positions=((0.0, 0.0, 0.0), (0.0, 0.0, -stretched)))
    for k in range(1, 51):
        outputs = tether.step(0.02, winch_force=0.0)
        assert outputs.winch_speed == pytest.approx(acceleration * 0.02 * k, rel=1e-6)
    assert outputs.tether_length - length == pytest.approx(0.5 * acceleration, rel=1e-6)
    assert outputs.kite_position[2] == pytest.approx(-stretched - 0.5 * (1.0 + strain) * acceleration, rel=1e-6)


def elastic_work(length, distance, stiffness):
    """Integral of the tension EA (distance/L - 1) over the length [J]."""
    return stiffness * (distance * np.log(length) - length)


def travelled(lengths, speeds, accelerations):
    """Way [m] of a drum between communication points, there and back where it turns round in between: v^2/(2 |a|).

    That is right to 1e-3 within 2 ms, of 1e-5 m.
    """
    turns = speeds[1:] * speeds[:-1] < 0.0
    there_and_back = 0.5 * speeds**2 / np.abs(accelerations)
    return np.where(turns, there_and_back[1:] + there_and_back[:-1], np.abs(np.diff(lengths))).sum()


@pytest.mark.parametrize(("solver", "close", "of_heat"), [({}, 1e-7, 1e-6), ({"fixed_step": 0.002}, 1e-4, 1e-3)])
def test_dry_friction_stops_a_drum_on_a_spring(solver, close, of_heat):
    """Each half swing ends where the work of the tension is that against motor and friction; the last one is held.

    The swings are of 5 to 800 mm. With fixed steps each ends in a step of order 1, within the way of that step.
    """
    friction, mass, force, distance, stiffness = 40.0, 25.0, 500.0, 100.0, 1e5
    tether = spring(initial_length=99.2, winch_mass=mass, winch_friction=friction, axial_stiffness=stiffness, **solver)

    def gained(length, start, way):
        """Kinetic energy [J] of the drum that swings outwards (way = 1) or inwards from rest at a length."""
        work = elastic_work(length, distance, stiffness) - elastic_work(start, distance, stiffness)
        return work - (force + way * friction) * (length - start)

    length, path, turns = 99.2, 0.0, 0
    while abs(excess := stiffness * (distance / length - 1.0) - force) > friction:
        way = np.sign(excess)
        far = length + way * 1e-6
        while gained(far, length, way) > 0.0:
            far += way * 1e-3
        turned = brentq(gained, far - way * 1e-3, far, args=(length, way), xtol=1e-15)
        path, length, turns = path + abs(turned - length), turned, turns + 1
    assert turns > 3
    audit = EnergyAudit(tether)
    flown = [(99.2, 0.0, stiffness * (distance / 99.2 - 1.0))]  # length, speed, tension
    for _ in range(2500):
        outputs = audit.step(0.002, winch_force=force)
        flown.append((outputs.tether_length, outputs.winch_speed, outputs.ground_tension))
    assert outputs.winch_speed == 0.0
    assert outputs.tether_length == pytest.approx(length, abs=close)
    assert outputs.tether_length == tether.step(0.001).tether_length  # it does not creep
    heat = friction * path
    lost = elastic_work(length, distance, stiffness) - elastic_work(99.2, distance, stiffness) - force * (length - 99.2)
    assert heat == pytest.approx(lost, rel=1e-9)  # of the formula
    lengths, speeds, tensions = np.transpose(flown)
    accelerations = (tensions - force - friction * np.sign(speeds)) / mass
    loss = elastic_work(lengths[-1], distance, stiffness) - elastic_work(lengths[0], distance, stiffness)
    loss -= force * (lengths[-1] - lengths[0])
    given = friction * travelled(lengths, speeds, accelerations)
    assert given == pytest.approx(loss, rel=of_heat)  # observed: 6e-10, with fixed steps 2e-4
    assert audit.work["friction_loss"] == pytest.approx(heat, rel=1e-3)  # trapezoidal rule over kinks
    assert abs(audit.drum_residual) < 1e-3 * heat


@pytest.mark.parametrize(("model", "solver"), AND_FIXED)
def test_friction_holds_until_it_is_overcome(model, solver):
    options = solver | {"winch_mass": 10.0, "winch_friction": 50.0, "initial_length": 99.9, "axial_stiffness": 1e5}
    tether = on_drum(model, segments=3, input_continuation="held", **options)
    first = tether.outputs().ground_tension
    for force in (first - 49.0, first, first + 49.0):
        for _ in range(3):
            outputs = tether.step(0.01, winch_force=force)
        assert outputs.tether_length == 99.9
        assert outputs.winch_speed == 0.0
    for _ in range(3):
        outputs = tether.step(0.01, winch_force=first + 60.0)
    assert outputs.winch_speed < 0.0


@pytest.mark.parametrize(("model", "solver"), AND_FIXED)
@pytest.mark.parametrize("mass", [0.0, 20.0])
def test_stops_are_inelastic(model, solver, mass):
    options = solver | {"initial_length": 99.95, "shortest_length": 99.9, "longest_length": 100.5, "segments": 3}
    tether = on_drum(model, winch_mass=mass, winch_damping=5.0, axial_stiffness=1e5, **options)
    for _ in range(100):
        outputs = tether.step(0.02, winch_force=500.0)
    assert (outputs.tether_length, outputs.winch_speed) == (99.9, 0.0)
    for _ in range(300):
        outputs = tether.step(0.02, winch_force=0.0 if mass == 0.0 else -20.0)
    if mass or model is not TetherStraight:  # which pulls no more once it is slack
        assert (outputs.tether_length, outputs.winch_speed) == (100.5, 0.0)


# --- without mass


@pytest.mark.parametrize("options", [{}, {"axial_damping": 0.0}, {"damping_law": "stretch_rate"}])
@pytest.mark.parametrize("solver", [{}, FIXED, FIXED | {"fixed_step_method": "backward_euler"}])
def test_tension_is_the_force_of_a_winch_without_mass(options, solver):
    """Taut, let go, without any force, jerked: T = W at every communication point, from the end of the first step on."""
    tether = TetherDynamic(segments=5, winch_control="force", **options, **solver)
    tether.initialize(wind_velocity=(8.0, 0.0, 0.0))
    for force in (300.0, 300.0, 5.0, 5.0, 5.0, 0.0, 0.0, 0.0, 0.0, 2000.0, 2000.0, 2000.0):
        for k in range(8):
            outputs = tether.step(0.02, winch_force=force)
            if k > 0:  # over the first one the jump is extrapolated
                rounding = 1e-15 * 614600.0
                assert outputs.ground_tension == pytest.approx(force, rel=1e-9, abs=rounding)


@pytest.mark.parametrize("model", IN_EQUILIBRIUM)
def test_tension_is_the_force_in_equilibrium(model):
    tether = model(segments=5, winch_control="force", input_continuation="held")
    tether.initialize(wind_velocity=(8.0, 0.0, 0.0))
    for force in (300.0, 140.0, 2000.0, 150.0):
        outputs = tether.step(0.02, winch_force=force)
        assert outputs.ground_tension == pytest.approx(force, rel=1e-9)


# --- independent solutions


def scene(seed):
    """`Network` of a random tether on its drum, its state, mean force of its winch [N] and rate of that [rad/s]."""
    random = np.random.default_rng(seed)
    n, length = int(random.integers(1, 5)), random.uniform(50.0, 500.0)
    direction = random.normal(size=3)
    direction[2] = 1.0 + abs(direction[2])
    kite = direction / np.linalg.norm(direction) * length * random.uniform(0.99, 1.001)
    mass = 0.0 if seed % 2 else 10.0 ** random.uniform(0.0, 4.0)
    winch = Winch(winch_control="force", winch_mass=mass, winch_damping=float(random.choice((0.0, 50.0))))
    wind, velocity = random.uniform(-10.0, 10.0, 3), random.uniform(-3.0, 3.0, 3)
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", kite, velocity)]
    line = Line("line", "ground", "kite", Tether(segments=n, initial_length=length), winch=winch)
    motions = {"ground": lambda _: np.zeros((2, 3)), "kite": lambda time: (kite + time * velocity, velocity)}
    network = Network(points, [line], Environment(), wind, motions, winch_forces={"line": None})
    part = np.linspace(0.0, 1.0, n + 1)[:, None]
    y = network.state({"line": part * kite}, {"line": part * velocity})
    return network, y, random.uniform(20.0, 500.0), random.uniform(0.5, 3.0)


def started(network, y, **options):
    """The same as a tether."""
    (line,), (x, v) = network.lines, network.unpacked(0.0, y)
    nodes = network.nodes_of["line"]
    tether = TetherDynamic(line.tether, winch=line.winch, **options)
    tether.initialize(positions=x[nodes], velocities=v[nodes], wind_velocity=network.wind)
    return tether


def compared(seed, duration, step=0.02, **options):
    """Largest difference of the length, relative, and of a position at the end [m], of a `scene`."""
    network, y, mean, rate = scene(seed)
    tether, worst, before = started(network, y, **options), 0.0, None
    for now in step * np.arange(round(duration / step)):
        force = mean * (1.0 + 0.5 * np.sin(rate * now))
        slope = 0.0 if before is None else (force - before) / step
        network.winch_forces["line"] = lambda t, force=force, slope=slope, now=now: force + slope * (t - now)
        (y,) = network.integrate(y, (now, now + step), 1e-9, "LSODA")
        kite, velocity = network.motions["kite"](now)
        outputs = tether.step(step, kite_position=kite, kite_velocity=velocity, winch_force=force)
        worst, before = max(worst, abs(outputs.tether_length / y[-2] - 1.0)), force
    return worst, np.abs(tether.positions - network.unpacked(now + step, y)[0][network.nodes_of["line"]]).max()


@pytest.mark.parametrize("seed", range(1, 11))
def test_against_an_independent_solver(seed):
    length, position = compared(seed, 0.24, relative_tolerance=1e-8)
    assert length < 1e-6
    assert position < 1e-5


@pytest.mark.parametrize(("method", "order"), [("backward_euler", 1), ("second_order", 2)])
def test_order_of_fixed_steps(method, order):
    coarse, _ = compared(4, 0.4, fixed_step=0.01, fixed_step_method=method)
    fine, _ = compared(4, 0.4, fixed_step=0.005, fixed_step_method=method)
    assert coarse / fine == pytest.approx(2.0**order, rel=0.1)


# --- stability


def energies_with_motor(fixed_step, length):
    """Kinetic energy of a pluck [J]; energies [J] of tether, drum and motor, W L, after it and after each step of 4 s."""
    tether = {"segments": 8, "initial_length": length, "axial_damping": 0.0, "drag_coefficient": 0.0}
    model, kite = TetherDynamic(**tether, winch_control="force", winch_mass=5.0, fixed_step=fixed_step), (40.0, 0.0, 10.0)
    force = max(model.initialize(kite_position=kite).ground_tension, 0.0)
    pluck(model, winch_force=force)
    plucked, found = model.energy().kinetic, []
    for _ in range(round(4.0 / fixed_step) + 1):
        energy = model.energy()
        found.append(energy.total + energy.drum + force * model.outputs().tether_length)
        model.step(fixed_step, kite_position=kite, winch_force=force)
    return plucked, np.array(found)


@pytest.mark.parametrize("length", [40.0, 42.0, 50.0])
@pytest.mark.parametrize("fixed_step", [0.002, 0.02, 0.2])
def test_no_energy_from_nowhere_with_fixed_steps(fixed_step, length):
    """A pluck between held ends, taut and slack: what the winch does is in W L.

    The tether lengthens as a whole: what is paid out begins with the speed of its node, 1 % of the mass. The adaptive solver
    at 1e-6 gains up to 2 % of the pluck here.
    """
    pluck, found = energies_with_motor(fixed_step, length)
    assert found.max() < found[0] + 0.02 * pluck
    assert found[-1] < found[0]


@pytest.mark.parametrize("length", [10.0, 100.0, 1000.0])
def test_steps_of_20_ms_are_stable(length):
    """Drums of 1 to 10 000 kg: a step of the force makes at most the tension of an undamped one, and some waves."""
    for mass in (1.0, 100.0, 1e4):
        tether = TetherDynamic(segments=10, initial_length=length, winch_control="force", winch_mass=mass)
        kite = np.array((0.6, 0.0, 0.8)) * length
        tether.initialize(kite_position=kite)
        start = tether.outputs().ground_tension
        largest = max(tether.step(0.02, winch_force=start + 100.0).ground_tension for _ in range(250))
        assert largest < 2.5 * (start + 200.0)


# --- refusals


def test_refused_step_leaves_everything():
    tether = TetherDynamic(segments=4, winch_control="force")
    tether.initialize()
    tether.step(0.02, winch_force=200.0)
    before = tether.get_state()
    with pytest.raises(StepRefused, match=r"winch_force is -1\.0 N; .*give a winch_mass"):
        tether.step(0.02, winch_force=-1.0)
    assert np.array_equal(tether.get_state(), before)


def test_no_length_is_refused():
    """A hanging tether pulls with at least its weight below the winch; where it hangs from the winch it never pulls less."""
    tether = TetherQuasiSteady(segments=4, winch_control="force", initial_length=100.0)
    tether.initialize(kite_position=(10.0, 0.0, -90.0))
    with pytest.raises(StepRefused, match="no unstretched length was found"):
        tether.step(0.02, winch_force=0.0)
