"""Findings of a check."""

from typing import NamedTuple

OK, NOTE, PROBLEM = "ok", "note", "PROBLEM"


class Finding(NamedTuple):
    """One thing found: its level (`OK`, `NOTE` or `PROBLEM`), what it is, and the remedy if there is one."""

    level: str
    text: str
    remedy: str = ""
