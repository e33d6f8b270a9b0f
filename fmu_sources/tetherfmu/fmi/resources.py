"""Resources of an FMU besides this package: compiled kernels and build options."""

import json
from functools import lru_cache
from pathlib import Path

from ..runtime.parameters import Tether

OPTIONS_FILE = "options.json"
KERNELS_FOLDER = "kernels"
# one point of the output `shape` at each node
DEFAULT_OPTIONS = {
    "segments": Tether.segments,
    "shape_points": Tether.segments + 1,
    "wind_points": 0,
    "starts": (),  # pairs (name, start value) where it is not the default
    "left_out": (),  # names of omitted variables
    "step": 0.02,  # of the default experiment [s], as its stop time
    "stop": 10.0,
}


@lru_cache
def options_in(resources):
    """Build options in the resources of an FMU, read once: its folder may vanish while instances live."""
    file = Path(resources or ".") / OPTIONS_FILE
    return DEFAULT_OPTIONS | (json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {})
