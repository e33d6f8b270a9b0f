"""A page in space of a replay: the flown path, and the tether along it."""

from types import SimpleNamespace

import numpy as np

from tetherfmu.libraries.examples import example
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.variants import class_name

from .runs import FORCES

FILE = "flight.html"
COUNT = 200  # of the moments that it shows, at most


def drawing():
    """The module that draws pages; ModuleNotFoundError without plotly."""
    return example("shared.flight_page")


def seen(flown):
    """Times [s], shapes [m] and end forces [N] of a `runs.Flown`, where its tether did not refuse."""
    table, known = flown.table, np.isfinite(flown.shapes).all(axis=(1, 2))
    forces = {end: table[[f"{end}[{i}]" for i in (1, 2, 3)]].to_numpy()[known] for end in FORCES}
    return SimpleNamespace(time=table.time.to_numpy()[known], shape=flown.shapes[known], **forces)


def write(made, place, name):
    """Write the page of the finest tether of a `Replay` to a folder; returns its path."""
    variant, flown = made.finest
    ground, path = made.flight.log.map.ground, made.flight.kite(made.flight.times)[0]
    height = ground.ground_height if ground.ground_contact == at.FLAT else None
    title = f"Tether along the flight of {name}"
    drawing().write_page({class_name(variant): seen(flown)}, place / FILE, path, COUNT, title, height)
    return place / FILE
