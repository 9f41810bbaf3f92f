"""What became of a robot's file: what was taken, what was dropped, what was assumed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from fo_gym.text import one_line

Kind = Literal["taken", "dropped", "assumed"]

_LONGEST = 400

__all__ = ["Kind", "Line", "Notes", "Report"]


@dataclass(frozen=True)
class Line:
    """One thing that became of the file.

    Attributes:
        kind: "taken" from the file or the caller, "dropped", or "assumed" because neither says it.
        what: what it is about, such as "tool" or "joint finger".
        text: what became of it.
    """

    kind: Kind
    what: str
    text: str

    def __str__(self) -> str:
        return f"{self.kind:<8} {one_line(self.what, 60):<26} {one_line(self.text, _LONGEST)}"


class Notes(list[Line]):
    """The lines of a report while it is written."""

    def taken(self, what: str, text: str) -> None:
        """The file, or the caller, says it."""
        self._add("taken", what, text)

    def dropped(self, what: str, text: str) -> None:
        """The file has it, the robot does not."""
        self._add("dropped", what, text)

    def assumed(self, what: str, text: str) -> None:
        """Neither file nor caller say it."""
        self._add("assumed", what, text)

    def _add(self, kind: Kind, what: str, text: str) -> None:
        line = Line(kind, what, text)
        if line not in self:
            self.append(line)


@dataclass(frozen=True)
class Report:
    """What was taken, dropped and assumed when a robot was made; `print` shows it as a table.

    Attributes:
        lines: in the order in which things were met.
    """

    lines: tuple[Line, ...] = ()

    @property
    def taken(self) -> tuple[Line, ...]:
        """What the file or the caller said."""
        return self._of("taken")

    @property
    def dropped(self) -> tuple[Line, ...]:
        """What the file has and the robot has not."""
        return self._of("dropped")

    @property
    def assumed(self) -> tuple[Line, ...]:
        """What nobody said."""
        return self._of("assumed")

    def _of(self, kind: Kind) -> tuple[Line, ...]:
        return tuple(line for line in self.lines if line.kind == kind)

    def __str__(self) -> str:
        return "\n".join(str(line) for line in (*self.taken, *self.dropped, *self.assumed))
