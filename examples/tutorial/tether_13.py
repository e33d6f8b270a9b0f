"""What does the log of a real flight say about its tether, and what not?

A pumping cycle of 2019 (Kitepower, CC BY 4.0; `examples/flights`): positions of the kite by GPS, tension and reel-out speed
of the winch, 10 times a second. The winch holds the tension: this gives the length with which the tether pulls as measured.
Beside it stands the length that the winch has paid out; where that began is not known, so it is fitted on the first half.
The rest, a metre or two, is an error of the positions. As a stretch it would be many times the measured tension: positions
do not give the tension of a taut tether. For a log of your own: `tetherfmu replay LOG.csv --as columns.toml`.
"""

from pathlib import Path

from lessons import TALL, Lesson, command_line, panels, timed

from tetherfmu.console.colours import BLACK, COLOUR, GREY

LOG = Path(__file__).resolve().parents[1] / "flights" / "kitepower_20191008_0012.csv"
MAP, TETHER = "kitepower_2019", "quasi_steady"


def prepared():
    """The flight: read, checked, smoothed, and what was done to it."""
    from tetherfmu.study.replay import flight, log  # needs the extra `study`

    return flight.prepare(log.read(LOG, MAP))


def lesson():
    """Tension over time; length of the tether that has it, less the length by the log; what that would be as a stretch."""
    from tetherfmu.study.replay.replay import replay

    flight = prepared()
    made, seconds = timed(replay, flight, "tension", (TETHER,), repeats=1)
    print(f"{flight.log.report}\n{made.fit}\n{made.tested}")
    found, half = made.residuals, made.fit.end
    figure, (above, middle, below) = panels(3, size=TALL, sharex=True)
    above.set(ylabel="tension [kN]", title="Measured: Kitepower, 8 October 2019, cycle 12")
    above.plot(found.time, 1e-3 * found.measured, color=GREY)
    middle.set(ylabel="length [m]", title="Length of a tether with this tension, minus the logged one")
    middle.plot(found.time, found.length, color=COLOUR[TETHER])
    middle.axvspan(0.0, half, color="0.93", zorder=0)
    middle.text(half - 1.0, 0.05, "fitted here", transform=middle.get_xaxis_transform(), ha="right", color="0.4")
    below.set(ylabel="tension [kN]", xlabel="time [s]", title="The same as a stretch; the measured tension in grey")
    below.plot(found.time, 1e-3 * found.stiffness * found.length, color=BLACK)
    below.plot(found.time, 1e-3 * found.measured, color=GREY)
    (row,) = made.errors[made.errors.part == "all"].to_dict("records")
    answer = (
        f"the length is right to {row['length: rms about mean [m]']:.2f} m, "
        f"equivalent to {row['equivalent tension [N]']:.0f} N; "
        f"the measured mean is {row['measured tension [N]']:.0f} N"
    )
    return Lesson(answer, figure, flight.end - flight.start, seconds)


main = command_line(lesson)
