"""Findings of a check."""

from typing import NamedTuple

OK, NOTE, PROBLEM = "ok", "note", "PROBLEM"


class Finding(NamedTuple):
    """One finding: its level (`OK`, `NOTE` or `PROBLEM`), its description, and the remedy if there is one."""

    level: str
    text: str
    remedy: str = ""
