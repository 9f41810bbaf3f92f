"""Options NAME=VALUE, or NAME=VALUES for sweeps and maps."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from fo_gym.checks import shown
from fo_gym.console import Stop

_RANGE = re.compile(r"(?P<low>[^:,]+):(?P<high>[^:,]+):(?P<count>\d{1,9})(?P<linear>:linear)?")
_RANGE_FORM = "LOW:HIGH:COUNT, LOW:HIGH:COUNT:linear, or values with commas between"
_DIGITS = 6

_GAINS = "--gains"

__all__ = ["axis_of", "gain_sets", "gains_of"]


def gains_of(options: Iterable[str]) -> dict[str, Any]:
    """Gains by name of options NAME=VALUE; values are read as TOML. Stops at what is none."""
    return {name: _value(_GAINS, name, text) for name, text in _split(options, "VALUE, such as L=70").items()}


def gain_sets(options: Iterable[str]) -> Mapping[str, list[float]]:
    """The values of each gain of a sweep, from options NAME=VALUES.

    LOW:HIGH:COUNT is geometric where both ends are above 0, else linear; values are rounded to six digits, so that
    tables show what was run.
    """
    found = _split(options, f"VALUES, that is {_RANGE_FORM}")
    return {name: _values(_GAINS, name, text) for name, text in found.items()}


def axis_of(option: str, text: str) -> tuple[str, list[float]]:
    """Name and values of a parameter that is mapped, from NAME=VALUES; `option` is what it was given by."""
    name, equals, values = text.partition("=")
    if not (equals and name):
        raise Stop(f"{option} is {text!r}; give NAME=VALUES, that is {_RANGE_FORM}")
    return name, _values(option, name, values)


def _split(options: Iterable[str], form: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for option in options:
        name, equals, text = option.partition("=")
        if not (equals and name.isidentifier()):
            raise Stop(f"--gains is {option!r}; give NAME={form}")
        if name in found:
            raise Stop(f"--gains names {name!r} twice; give it once")
        found[name] = text
    return found


def _value(option: str, name: str, text: str) -> Any:
    try:
        content = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):  # also a number that is too long
        content = {}
    if set(content) != {"value"}:
        raise Stop(
            f"{option}: {name} is {shown(text)}; give a value as TOML has it: a number, true, false, or a quoted text"
        )
    return content["value"]


def _number(option: str, name: str, text: str) -> float:
    value = _value(option, name, text.strip())
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Stop(f"{option}: {name} is {text!r}; it is over numbers: {_RANGE_FORM}")
    return value


def _values(option: str, name: str, text: str) -> list[float]:
    from numpy import geomspace, linspace

    from fo_gym.evaluation.competitors.competitor import MAX_SETS

    found = _RANGE.fullmatch(text)
    if found is None:
        values = [_number(option, name, part) for part in text.split(",")]
    else:
        low, high, count = (_number(option, name, found[part]) for part in ("low", "high", "count"))
        if not (-float("inf") < low < high < float("inf") and 2 <= count <= MAX_SETS):
            raise Stop(
                f"{option}: {name} is {shown(text)}; give LOW below HIGH, both finite, and a COUNT from 2 to {MAX_SETS}"
            )
        spaced = linspace if found["linear"] or low <= 0 else geomspace
        values = [float(f"{value:.{_DIGITS}g}") for value in spaced(low, high, int(count))]
    if len(set(values)) < len(values):
        raise Stop(f"{option}: {name} is {text!r}; it names a value twice")
    return values
