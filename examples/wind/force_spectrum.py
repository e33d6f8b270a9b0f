"""Which part of turbulence reaches the ground? Spectrum of the force there against quasi-steady linear theory.

    python examples/wind/force_spectrum.py

A taut tether of 300 m is held at both ends in a box of turbulence (`box_of_turbulence.py`) that a uniform wind U carries
past it. Turned about its upper end, the tether in equilibrium pulls at the ground, across its chord e, with

    F(t) = L int_0^1 (1 - s) q(s, t) ds,   q = rho c d |W|W/2,   W = (I - e e^T)(U + u)

s part of the way from the ground, L length, d diameter, c drag coefficient, u the turbulence. Linear in u, with
W0 = (I - e e^T) U:

    q' = rho c d (|W0| w + W0 (W0 . w)/|W0|)/2,   w = (I - e e^T) u

That is what `linear_force` computes, from the box alone. The dynamic tether follows it at frequencies far below that of
its first wave, f1 = 1/(2 wave_time), and resonates there. What is left at low frequency is the sag, which turns the tether
out of its chord and vanishes the tauter it is, and the square of the turbulence in the drag. The box is periodic and the
flight takes one of its periods, after some seconds that do not count: the spectra are squares at the multiples of 1/period,
without a window or a mean of several.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tetherfmu import TetherDynamic
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.records.paths import inputs_along
from tetherfmu.runtime.parameters import Environment, Tether
from tetherfmu.wind.frozen_turbulence import FrozenTurbulence, MeanWind
from tetherfmu.wind.wind_boxes import of_space

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from wind.box_of_turbulence import velocity

SPEED, DEVIATION = 10.0, 0.4  # U, and that of the turbulence [m/s], which is small: drag is quadratic
DISTANCE, ELEVATION = 300.0, np.radians(60.0)
TAUT = Tether(initial_length=0.997 * DISTANCE, segments=20)
POINTS, STEP = 21, 0.02  # wind points; communication step [s]
SETTLING = 20.0  # [s]
LENGTH = 1280.0  # of the box [m]
BAND = 0.02, 0.1  # frequencies that are compared, far below the first wave [Hz]


class Spectra(NamedTuple):
    """Of the force on the ground across the chord, sum of both components."""

    frequency: np.ndarray  # [Hz]
    tether: np.ndarray  # [N2/Hz]
    linear: np.ndarray  # [N2/Hz]
    first_wave: float  # f1 [Hz]


def turbulence(spacing):
    """`FrozenTurbulence` of a box of `LENGTH` x 160 m x 320 m with a spacing [m]."""
    points = tuple(2 * round(0.5 * size / spacing) for size in (LENGTH, 160.0, 320.0))
    numbers = velocity(DEVIATION, points=points, spacing=(spacing,) * 3)
    strides = [each // numbers.itemsize for each in numbers.strides]
    flat = numbers.ravel(order="K")
    components = [flat[k * strides[3] :] for k in range(3)]
    return FrozenTurbulence(MeanWind(SPEED), of_space("box", components, strides[:3], points, (spacing,) * 3))


def linear_force(wind, chord):
    """Force across the chord on the ground [N], array (times, 3), without the constant one; wind [m/s] (times, K, 3)."""
    length, environment = np.linalg.norm(chord), Environment()
    along = chord / length
    across = np.eye(3) - np.outer(along, along)
    steady = across @ (SPEED, 0.0, 0.0)
    size = np.linalg.norm(steady)
    w = (wind - (SPEED, 0.0, 0.0)) @ across
    drag = 0.5 * environment.air_density * TAUT.drag_coefficient * TAUT.diameter
    load = drag * (size * w + np.multiply.outer(w @ steady, steady) / size)
    share = 1.0 - np.linspace(0.0, 1.0, wind.shape[1])
    return length * np.trapezoid(share[:, None] * load, dx=1.0 / (wind.shape[1] - 1), axis=1)


def spectrum(force):
    """One-sided power spectral density [N2/Hz] of a force [N] (times, 3), all components, at multiples of 1/duration."""
    amplitudes = np.fft.rfft(force - force.mean(axis=0), axis=0)
    return 2.0 * STEP / len(force) * np.sum(np.abs(amplitudes) ** 2, axis=1)


def spectra(spacing=5.0, tether=TAUT):
    """`Spectra` of a `Tether` in a box with this spacing [m]."""
    kite = DISTANCE * np.array((np.cos(ELEVATION), 0.0, np.sin(ELEVATION)))
    period, settling = LENGTH / SPEED, round(SETTLING / STEP)
    count = settling + round(period / STEP)
    time, points = STEP * np.arange(count), np.linspace((0.0, 0.0, 0.0), kite, POINTS)
    field = turbulence(spacing)
    wind = np.array([field.at(each, points) for each in time])
    model = TetherDynamic(tether, wind_points=POINTS)
    start = model.initialize(kite, wind_at=wind[0])
    flown = model.fly(inputs_along(count, STEP, kite=kite), STEP, wind_at=wind)
    along = kite / DISTANCE
    across = np.eye(3) - np.outer(along, along)
    found = [spectrum(each[settling:]) for each in (flown.ground_force @ across, linear_force(wind, kite))]
    frequency = np.arange(len(found[0])) / period
    return Spectra(frequency, *found, 0.5 / start.wave_time)


def ratio_in_band(found):
    """Power of the tether over that of the linear theory at the frequencies of `BAND` [-]."""
    low, high = BAND
    inside = (found.frequency >= low) & (found.frequency <= high)
    return float(found.tether[inside].sum() / found.linear[inside].sum())


def draw(found, target):
    """Draw both spectra."""
    from shared.flight_figures import plt
    from tetherfmu.console.colours import BLUE, GREY, VERMILLION

    figure, axis = plt.subplots(figsize=(7.0, 4.2), layout="constrained")
    shown = (found.frequency > 0.0) & (found.frequency < 0.95)
    f = found.frequency[shown]
    axis.axvspan(*BAND, color="0.92", linewidth=0.0, label=f"compared: ratio {ratio_in_band(found):.3f}")
    axis.loglog(f, found.linear[shown], color=VERMILLION, linewidth=2.5, alpha=0.6, label="quasi-steady linear theory")
    axis.loglog(f, found.tether[shown], color=BLUE, linewidth=1.0, label="TetherDynamic, 20 segments")
    axis.axvline(found.first_wave, color=GREY, linestyle="--", linewidth=1.0, label="first wave of the tether")
    axis.set(xlabel="frequency [Hz]", ylabel="force on the ground across the chord [N²/Hz]")
    axis.grid(alpha=0.4)
    axis.legend(fontsize=8, loc="lower left")
    figure.savefig(target, dpi=150)


@command
def main(arguments=None):
    """Print the ratio of both powers at low frequency, and draw the spectra."""
    parser = Parser(description="compare the spectrum of the force on the ground with quasi-steady linear theory")
    parser.add_out()
    given = parser.parse_args(arguments)
    given.out.mkdir(parents=True, exist_ok=True)
    found = spectra()
    print(
        f"from {BAND[0]:g} to {BAND[1]:g} Hz the tether has {ratio_in_band(found):.3f} times the power of the linear theory"
    )
    print(f"its first wave has {found.first_wave:.2f} Hz")
    target = given.out / "force_spectrum.png"
    draw(found, target)
    print(target)


if __name__ == "__main__":
    sys.exit(main())
