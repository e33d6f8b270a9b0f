"""Replay of a measured flight with tethers: comparison with the log, and reliability of both."""

from argparse import ArgumentTypeError
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from tetherfmu.console.options import folder
from tetherfmu.console.progress import now
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.study.measuring.tables import markdown

from . import comparison, driven_tethers, figures, fitting, log, scene
from .columns import KITEPOWER
from .flight import MEASURED, Flight, prepare

NOTHING = "nothing"  # of --fit
LONGEST_FIT = 0.5  # of the flight, from its start: default part of the fit without earlier rows
SHORTEST_FLIGHT = 30.0  # s, for a fit on the first half
SHORTEST_BEFORE = 20.0  # s before the flight, minimum to use them for the fit


@dataclass(frozen=True)
class Replay:
    """A measured flight with the results of the tethers: `flown`, dict from the name of a tether to `runs.Flown`.

    `not_flown` : sentences on tethers without results.
    `fit` : `fitting.Fit` or None.  `tested` : a sentence on its quality on another part.  `residuals`, `errors` : tables of
    `comparison`.
    """

    flight: Flight
    lead: str
    flown: dict
    fit: fitting.Fit | None
    tested: str
    residuals: pd.DataFrame
    errors: pd.DataFrame
    not_flown: tuple = ()

    @property
    def finest(self):
        """The name of the finest tether, and its `runs.Flown`."""
        name = driven_tethers.finest(self.flown)
        return name, self.flown[name]

    @property
    def is_slack(self):
        """Where the finest tether is slack, or lies on the ground, array (times,) of bool."""
        table = self.finest[1].table
        return ~self.flight.is_taut(table.tether_length.to_numpy()) | (table.grounded_length.to_numpy() > 0.0)

    @property
    def doubts(self):
        """Sentences on unreliable results."""
        taut, share = comparison.untrustworthy(self.residuals)
        if self.lead != "tension" and share > 0.0:
            noise = self.flight.log.map.smoothing.position_noise
            yield (
                f"the tether is taut for {100.0 * taut:.0f} % of the time; for {100.0 * share:.0f} % of that the noise of a "
                f"position ({noise:g} m), as a stretch, is more than the measured tension: taut forces from positions are "
                "not reliable; use --lead tension"
            )
        for name, each in self.flown.items():
            if each.refusals:
                yield refused(name, each)
            if each.break_time >= 0.0:
                yield f"{name} broke after {each.break_time:.3g} s; its later results are those of a broken tether"
        yield from self.not_flown


def refused(name, flown):
    """A sentence on the steps that a tether refused."""
    end = "" if flown.stopped is None else f" and was stopped at {flown.stopped:.1f} s"
    return f"{name} refused {len(flown.refusals)} communication steps{end}; the first: {flown.refusals[0].reason}"


def default_lead(read):
    """Signal that drives the winch: the tension if the log has it, else the length, else the speed; LogError without any."""
    for lead, column in MEASURED.items():
        if column in read.table:
            return lead
    raise read.wrong(f"has none of {', '.join(MEASURED.values())}: nothing can drive the winch")


def part_of_fit(flight, start=None, end=None):
    """The part of the log for the fit: start to end [s], or the rows before the flight, or its first half."""
    first, last = flight.log.time[0], flight.end
    if start is None and end is None:
        before = flight.start - first
        half = flight.start + LONGEST_FIT * (last - flight.start)
        return flight.part(first, flight.start) if before >= SHORTEST_BEFORE else flight.part(flight.start, half)
    return flight.part(first if start is None else start, last if end is None else end)


def replay(
    flight, lead, tethers=tuple(driven_tethers.TETHERS), wanted=("offset",), fit_part=None, segments=driven_tethers.SEGMENTS
):
    """`Replay` of a `Flight` driven by "tension", "length" or "speed".

    tethers : names of `runs.TETHERS`.  wanted : fitted numbers, see `fitting.fit`; () for none.  fit_part : the `Flight`
    for the fit; None: `part_of_fit`.  LogError if the log lacks data for it, a tether cannot start, or all fail.
    """
    found, tested = None, ""
    if wanted:
        now("fitting")
        found = fitting.fit(fit_part or part_of_fit(flight), wanted)
        tested = fitting.test(found, flight)
        flight = flight.corrected(found.correction)
    flown, not_flown = {}, []
    for name in tethers:
        now(f"flying {name}")
        each = driven_tethers.fly(flight, name, lead, segments)
        if each.table.tether_length[flight.times >= flight.start + comparison.SETTLED].notna().any():
            flown[name] = each
        else:
            not_flown.append(f"without results: {refused(name, each)}")
    if not flown:
        raise flight.log.cannot_fly(f"no tether can fly this: {not_flown[0]}")
    table = comparison.residuals(flight, flown)
    errors = comparison.errors(table, flight.start, lead)
    if not flight.has_whole_length:
        errors = errors.drop(columns="length: mean [m]", errors="ignore")
    return Replay(flight, lead, flown, found, tested, table, errors, tuple(not_flown))


def series(made):
    """All numbers of a `Replay` in a DataFrame: the log, then the outputs of each tether after its name."""
    flight = made.flight
    table = flight.signals().assign(measured_tension=flight.measured("ground_tension", flight.times))
    if flight.has_length:
        table["measured_length"] = flight.length(flight.times)
    tables = [each.table.drop(columns="time").add_prefix(f"{name}.") for name, each in made.flown.items()]
    return pd.concat([table, *tables], axis=1)


def text(made, table):
    """Report of a replay: changes to the log, fit, table of errors, doubts."""
    flight = made.flight
    lines = [str(flight.log.report), ""]
    if made.fit:
        lines += [str(made.fit), made.tested]
    driven = f"driven by the {made.lead} from {flight.start:.1f} to {flight.end:.1f} s:"
    lines += [driven, "", markdown(comparison.rounded(table)), ""]
    return "\n".join([*lines, *(f"doubt: {each}" for each in made.doubts)])


def wanted_fits(flight, named):
    """Fitted corrections, a tuple: those in a list, or the offset if the log permits it; otherwise its report says so.

    WrongUse if `NOTHING` is combined with another one.
    """
    if named:
        if NOTHING in named and len(named) > 1:
            raise WrongUse(f"--fit {' '.join(named)} is not possible; {NOTHING} cannot be combined")
        return tuple(dict.fromkeys(each for each in named if each != NOTHING))
    known, table = flight.log.map.station.length_offset, flight.log.table
    if known or not flight.has_length or "ground_tension" not in table:
        return ()
    before, long = flight.start - flight.log.time[0], flight.end - flight.start
    if before < SHORTEST_BEFORE and long < SHORTEST_FLIGHT:
        flight.log.report.say(
            f"nothing is fitted: {SHORTEST_BEFORE:g} s before the flight, or a flight of {SHORTEST_FLIGHT:g} s are needed"
        )
        return ()
    return ("offset",)


def own_folder(name):
    """Default folder of the results of a log; WrongUse if it cannot be one."""
    try:
        return folder(str(Path("flights") / Path(name).stem))
    except ArgumentTypeError as error:
        raise WrongUse(str(error)) from None


def run(options):
    """The command `replay`; returns 1 if no FMU meets the requirements of its scene."""
    if options.html:
        figures.drawing()  # before the flight, which would be in vain without plotly
    read = log.read(options.log, options.map or KITEPOWER, options.settings or ())
    flight = prepare(read, options.start, options.end)
    lead = options.lead or default_lead(read)
    wanted = wanted_fits(flight, options.fit)
    place = options.out or own_folder(options.log)
    fit_part = part_of_fit(flight, options.fit_from, options.fit_to) if wanted else None
    made = replay(flight, lead, options.tether or tuple(driven_tethers.TETHERS), wanted, fit_part, options.segments)
    print(text(made, made.errors[made.errors.part == comparison.ALL].drop(columns="part")))  # of the whole flight
    now("drawing")
    for path in write(made, place, Path(options.log).stem, options.html):
        print(path)
    return scene.build(place) if options.fmu else 0


def write(made, place, name, html=False):
    """Write all results to a folder; returns their paths.

    name : of the log.  html : whether also the page in space, which needs plotly.
    """
    place.mkdir(parents=True, exist_ok=True)
    (place / "report.md").write_text(text(made, made.errors) + "\n", encoding="utf-8")
    series(made).to_csv(place / "series.csv", index=False, float_format="%.6g")
    made.errors.to_csv(place / "errors.csv", index=False, float_format="%.6g")
    written = [place / each for each in ("report.md", "series.csv", "errors.csv")]
    written += [*figures.write(made, place, name), *scene.write(made, place, name)]
    return [*written, figures.write_page(made, place, name)] if html else written
