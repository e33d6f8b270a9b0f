"""How far from theory are the extreme scenarios? Prints docs/data/extremes.csv.

    python tests/benchmarks/extremes.py [--long]

Each line is computed by the functions of the test of that name in tests/physics/extremes. --long adds an hour of noise,
hours without damping and 1e7 communication steps (some minutes).
"""

import sys
from time import perf_counter

import numpy as np
from as_script import TESTS, options, print_csv

sys.path[:0] = [str(TESTS / "physics"), str(TESTS / "physics" / "extremes")]


def snap():
    from test_snap_load import peaks, with_damping

    for n in (20, 50, 100):
        (kite, _), residual = peaks(n, 10)
        yield f"snap load, n = {n}, speed reached in 10 l0/c", "EA v/c", f"{100 * (kite - 1):.2f} %", residual
    (_, ground), residual = peaks(100, 40)
    yield "snap load at the held end, n = 100, 40 l0/c", "2 EA v/c", f"{100 * (ground / 2 - 1):.2f} %", residual
    chain, rod = with_damping(100, 1e-3)
    yield "snap load with damping, n = 100, 1 ms", "Kelvin-Voigt rod", f"{100 * (chain.max() / rod.max() - 1):.2f} %", None


def stop():
    from test_mass_on_a_stop import peak_at_the_stop

    for mass in (100.0, 500.0):
        peak, _, residual = peak_at_the_stop(mass, 473.0)
        scenario, oracle = f"{mass:.0f} kg fall 5 m into a tether of 50 m", "M g + sqrt((M g)^2 + 2 M g h k)"
        yield scenario, oracle, f"{100 * (peak - 1):.1f} %", residual


def released():
    from test_folded_chain import let_go
    from test_snap_load import recoil

    _, _, kinetic, residual = recoil(100, 0.0)
    yield "released end, n = 100: energy at L/c", "all kinetic", f"{100 * (kinetic - 1):.2f} %", np.abs(residual).max()
    found, way, _, residual = recoil(100, 473.0)
    deviation = f"{100 * (found / way - 1):.4f} %"
    yield "released end with damping: way at L/c", "Kelvin-Voigt rod", deviation, np.abs(residual).max()
    fall, part, _, residual = let_go(100, 5.0)
    worst = np.abs(part[(fall > 0.3) & (fall < 0.85)] - 1.0).max()
    yield "whip of a folded chain, n = 100: speed of its tip", "Calkin and March 1989", f"{100 * worst:.1f} %", residual


def resonance():
    from test_resonance import EA, LENGTH, MU, chain_response, first_axial, measured_response, rod_response

    found, residual = measured_response(10, first_axial(10))
    error = abs(found / chain_response(10, first_axial(10)) - 1.0)
    yield "driven axial resonance, n = 10: complex amplitude", "linear chain", f"{100 * error:.2f} %", residual
    omega = np.pi / LENGTH * np.sqrt(EA / MU)
    for n in (20, 40):
        found, residual = measured_response(n, omega)
        error = abs(found / rod_response(omega) - 1.0)
        yield f"the same, n = {n}", "continuum", f"{100 * error:.2f} %", residual


def spinning():
    from test_spinning import turned

    for n in (10, 100):
        tension, rod, _, residual = turned(n)
        error = np.abs(tension - rod).max() / rod[0]
        yield f"spinning, n = {n}: tension after a turn", "1/2 mu omega^2 (L^2 - r^2), elastic", f"{error:.1e}", residual


def sessions():
    from test_hurricane import KITE, hit, tether
    from test_kite_anywhere import PATHS, WIND, dynamic_flight
    from test_reel_to_minimum import in_and_out

    from tetherfmu.python.models import TetherDynamic

    model, result = hit(1.4, (0.0, 80.0, 0.0))
    equilibrium = TetherDynamic(tether(1.4)).initialize(KITE, wind_velocity=(0.0, 80.0, 0.0))
    away = np.abs(model.positions - equilibrium.shape).max()
    residual = np.abs(result.residual).max() / result.turnover
    yield "hurricane of 80 m/s on a slack line, after 8 s", "equilibrium", f"{1000 * away:.0f} mm of 119 m", residual
    for name, (start, velocity) in PATHS.items():
        start, velocity = np.array(start), np.array(velocity)

        def path(time, start=start, velocity=velocity):
            return {"kite_position": start + velocity * time, "kite_velocity": velocity, "wind_velocity": WIND}

        yield f"kite flies {name}, audited every 0.25 ms", "energy", "-", dynamic_flight(path, 80)[1]
    model, start, result = in_and_out(5, 5.0, 1.0, 0.0005)
    away = np.abs(model.outputs().shape[:, 2] - start.shape[:, 2]).max()
    left = abs(result.residual[-1]) / result.turnover
    yield "5 m reeled in to 5 cm and out again: heights", "as at the start", f"{1000 * away:.1f} mm", left


def noise():
    from test_noise import force_noise, linear_noise

    found, _ = force_noise(3000)
    expected = linear_noise(3000)
    for name, one, other in zip(("kite", "ground"), found.std(axis=0), expected.std(axis=0), strict=True):
        yield f"noise of the inputs: {name} force, {one:.2f} N", "linear theory", f"{100 * (one / other - 1):.1f} %", None


def undamped():
    from test_energy import FALLS, fall

    for name in FALLS:
        total, kinetic = fall(name, 3600.0)
        gained = (total.max() - total[0]) / kinetic.max()
        yield f"an hour without damping, {name}: energy gained", "none", f"{100 * gained:.3f} % of the kinetic", None


def long_runs():
    from test_many_steps import STEPS_PER_REVOLUTION, drift
    from test_noise import force_noise

    found, _ = force_noise(180_000)
    parts = found.reshape(6, -1, 2)
    spread = parts.std(axis=1).max(axis=0) / parts.std(axis=1).min(axis=0) - 1.0
    sizes = f"{found.std(axis=0)[0]:.2f} N, at most {np.abs(found).max():.0f} N"
    yield f"an hour of noise: {sizes}; six parts of 10 min", "the same size", f"{100 * spread.max():.1f} %", None
    mean = np.abs(parts.mean(axis=1)).max()
    yield "an hour of noise: mean of the force in each part", "0", f"{1000 * mean:.0f} mN", None
    start = perf_counter()
    difference, model = drift(10_000)
    length = abs(model.outputs().tether_length - 525.0)
    minutes = (perf_counter() - start) / 60.0
    steps = f"{10_000 * STEPS_PER_REVOLUTION:.0e} steps ({minutes:.1f} min)"
    yield f"{steps}: last revolution", "third", f"{difference:.1e}", None
    yield "the same: unstretched length after reeling to and fro", "525 m", f"{length:.0e} m", None


def main():
    """Print the table."""
    groups = [snap, stop, released, resonance, spinning, sessions, noise]
    if options(__doc__, long=False).long:
        groups += [undamped, long_runs]
    print_csv("scenario", "oracle", "error", "energy residual")
    for group in groups:
        for scenario, oracle, error, residual in group():
            print_csv(scenario, oracle, error, "-" if residual is None else f"{abs(residual):.0e}")


if __name__ == "__main__":
    main()
