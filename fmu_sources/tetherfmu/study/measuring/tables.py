"""Tables and pages for people (Markdown), and the circumstances of a measurement."""

import os
import platform
import re
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from tetherfmu.runtime import __version__

from .errors import fine_enough

PACKAGES = ("numpy", "numba", "scipy", "fmpy", "pythonfmu", "casadi", "moordyn")


def processor():
    """Name of the processor."""
    information = Path("/proc/cpuinfo")
    text = information.read_text(encoding="utf-8") if information.exists() else ""
    name = re.search(r"^model name\s*: *(.*\S)", text, re.M)
    return name[1] if name else platform.processor() or platform.machine()


def installed(package):
    """Version of a package, or "not installed"."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def circumstances():
    """Machine, date and versions in one sentence."""
    versions = ", ".join(f"{package} {installed(package)}" for package in PACKAGES)
    return (
        f"{datetime.now(UTC):%Y-%m-%d}, {processor()}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}, "
        f"Python {platform.python_version()}, tetherfmu {__version__}, {versions}."
    )


def cell(value):
    """Text of a cell: two digits of small numbers, three of others, a dash for nothing."""
    if pd.isna(value):
        return "-"
    if not isinstance(value, float):
        return str(value)
    if abs(value) >= 100.0:
        return f"{value:.0f}"
    return f"{value:.2g}" if abs(value) < 0.01 else f"{value:.3g}"


def markdown(table):
    """A DataFrame as a Markdown table, without its index."""
    return table.astype(object).map(cell).to_markdown(index=False, disable_numparse=True)


def percent(value):
    """Text of a share in percent, two digits."""
    return f"{100.0 * value:.2g} %"


def known(error, own):
    """Text of an error, with the error of its reference, unless that is small in comparison."""
    return percent(error) if fine_enough(own, [error]) else f"{100.0 * error:.2g} ± {percent(own)}"


def factor(cost):
    """Text of how many times faster than real time a cost per simulated second is, two digits; a dash if not known."""
    return f"{float(f'{1.0 / cost:.2g}'):.0f}" if cost else "-"


SPACES = {"trim_blocks": True, "lstrip_blocks": True, "keep_trailing_newline": True}
STUDY = Path(__file__).parents[1]


@cache
def templates_of(folder):
    """The Jinja templates in a folder, with those shared by all pages."""
    templates = Environment(loader=FileSystemLoader(folder), undefined=StrictUndefined, **SPACES)
    templates.filters |= {"table": markdown, "percent": percent, "known": known, "factor": factor}
    return templates


def page(template, folder=STUDY, /, **facts):
    """Text of a Jinja template (its path in the folder), filled with facts and the circumstances."""
    return templates_of(folder).get_template(template).render(facts, circumstances=circumstances())
