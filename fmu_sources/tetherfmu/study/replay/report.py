"""What was done to a log before it was flown, and what in it is doubtful: a line each, and nothing is done in silence."""

from dataclasses import dataclass, field


@dataclass
class Report:
    """Lines on a log, in the order in which things were done."""

    lines: list = field(default_factory=list)  # texts
    doubts: list = field(default_factory=list)  # texts: what may be wrong, and was left as it is

    def say(self, text):
        """Add a line."""
        self.lines.append(text)

    def doubt(self, text):
        """Add what may be wrong."""
        self.doubts.append(text)

    def count(self, done, rows, total, why):
        """Add a line on some of the rows, unless there are none."""
        if rows:
            self.say(f"{done}: {rows} of {total} rows, {why}")

    def __str__(self):
        """All lines, the doubts last."""
        return "\n".join([*self.lines, *(f"doubt: {each}" for each in self.doubts)])
