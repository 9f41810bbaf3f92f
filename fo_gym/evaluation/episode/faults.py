"""How a competitor in a process of its own fails, and its words as plain text of bounded length."""

from __future__ import annotations

from typing import Any, TypeVar

from fo_gym.text import printable

LONGEST_TEXT = 2000
"""Characters that are kept of what a competitor says."""

ErrorT = TypeVar("ErrorT", bound=BaseException)

__all__ = ["LONGEST_TEXT", "EndedError", "RaisedError", "kind_of", "plain", "trace_of", "with_trace"]


class EndedError(RuntimeError):
    """The competitor's process ended itself or was ended; the message says by which limit."""


class RaisedError(RuntimeError):
    """The competitor raised; the message is its own, and where in its code.

    Attributes:
        kind: name of what it raised.
    """

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def kind_of(error: BaseException) -> str:
    """The name of what a compensator raised, here or in a process of its own."""
    return error.kind if isinstance(error, RaisedError) else type(error).__name__


def with_trace(error: ErrorT, trace: str) -> ErrorT:
    """The error with the lines of the competitor's code that led to it, as a note."""
    if trace:
        error.add_note(trace)
    return error


def trace_of(error: BaseException) -> str:
    """The lines of the competitor's code that led to an error, or to its cause; "" where they are not known."""
    notes = getattr(error, "__notes__", []) or getattr(error.__cause__, "__notes__", [])
    return "\n".join(notes)


def plain(words: Any, longest: int = LONGEST_TEXT) -> str:
    """A stranger's words as `printable` text: the first `longest` characters, and a mark where there were more."""
    text = words if isinstance(words, str) else repr(words)
    return printable(text if len(text) <= longest else f"{text[:longest]} ...")
