"""Tables of the benchmark as Markdown and CSV."""

import csv
import os
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from tetherfmu.runtime import __version__

PACKAGES = ("numpy", "numba", "scipy", "fmpy", "pythonfmu", "casadi", "moordyn")


class Table(NamedTuple):
    """A titled table; cells are numbers or text."""

    title: str
    text: str
    columns: tuple
    rows: list


def processor():
    """Name of the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


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
    """Text of a cell: two digits of small numbers, three of others."""
    if value is None:
        return "-"
    if isinstance(value, float):
        if value != 0.0 and abs(value) < 0.01:
            return f"{value:.2g}"
        return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
    return str(value)


def markdown(tables, figure):
    """The page; `figure` is the path of the diagram as seen from the page, or None."""
    lines = ["# Benchmarks", "", "Written by `python -m tetherfmu.study.benchmark`; every number is measured.", ""]
    lines += [circumstances(), ""]
    for table in tables:
        lines += [f"## {table.title}", "", table.text, ""]
        lines += ["| " + " | ".join(table.columns) + " |", "|" + "---|" * len(table.columns)]
        lines += ["| " + " | ".join(map(cell, row)) + " |" for row in table.rows]
        lines.append("")
    if figure:
        lines += [f"![Time against error of our tether and of CVODES]({figure})", "", f"Measured: {circumstances()}", ""]
    return "\n".join(lines)


def write(tables, folder, figure):
    """Write benchmarks.md and benchmarks.csv to a folder; returns the page."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    relative = Path(os.path.relpath(figure, folder)).as_posix() if figure else None
    page = markdown(tables, relative)
    (folder / "benchmarks.md").write_text(page, encoding="utf-8")
    with open(folder / "benchmarks.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["circumstances", circumstances()])
        for table in tables:
            writer.writerow(["table", *table.columns])
            writer.writerows([table.title, *row] for row in table.rows)
    return page
