"""What a value must be: one check for each kind of value, which names the argument, the value and what is allowed.

Booleans, complex numbers, text, dates and objects are no numbers here, although NumPy makes numbers of some of them. A
check gives the value back as what it is taken for, so that what passed is what is used.
"""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Value = float | Array
"""Of a parameter: one for all joints, or one for each."""

_NOT_REALLY = bool | np.timedelta64
"""Classes that derive from integers, and are none."""

_LONGEST = 160
_SHORT = reprlib.Repr()
_SHORT.maxother = _SHORT.maxstring = _SHORT.maxlong = 90

__all__ = [
    "FINITE",
    "NOT_NEGATIVE",
    "POSITIVE",
    "POSITIVE_OR_INFINITE",
    "Bound",
    "Value",
    "check_numbers",
    "check_ranges",
    "check_values",
    "choice",
    "flag",
    "instance",
    "mapping",
    "number",
    "number_range",
    "only",
    "real",
    "real_array",
    "real_arrays",
    "shown",
    "text",
    "values",
    "whole_array",
    "whole_number",
]


def shown(value: object) -> str:
    """The value on one short line, whatever it is."""
    if isinstance(value, np.generic):
        value = value.item()
    try:
        line = " ".join(_SHORT.repr(value).split())
        return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 3]}..."
    except ValueError:  # Python does not print integers of more than 4300 digits
        return f"a {type(value).__name__} too long to print"


@dataclass(frozen=True)
class Bound:
    """Where numbers may lie.

    Attributes:
        low: the least one.
        excluded: whether `low` itself is too small.
        finite: whether infinity is refused; NaN always is.
    """

    low: float = -math.inf
    excluded: bool = False
    finite: bool = True

    def holds(self, array: Array) -> bool:
        """Whether all values lie there."""
        return array.size == 0 or self.between(float(array.min()), float(array.max()))

    def between(self, least: float, most: float) -> bool:
        """Whether all values from `least` to `most` lie there; never, where one of them is NaN."""
        inside = least > self.low if self.excluded else least >= self.low
        return inside and (not self.finite or -math.inf < least <= most < math.inf)

    def __str__(self) -> str:
        parts = ["finite"] if self.finite else []
        if self.low > -math.inf:
            parts.append(f"{'above' if self.excluded else 'at least'} {self.low:g}")
        return " and ".join(parts)


FINITE = Bound()
POSITIVE = Bound(0.0, excluded=True)
NOT_NEGATIVE = Bound(0.0)
POSITIVE_OR_INFINITE = Bound(0.0, excluded=True, finite=False)


def number(name: str, value: Any, bound: Bound = FINITE, unit: str = "") -> float:
    """One real number.

    Args:
        name: what to call it in errors.
        value: a float or an integer, of Python or NumPy.
        bound: where it may lie.
        unit: for the message, such as "s".

    Raises:
        ValueError: it is no number, or out of bounds.
    """
    if isinstance(value, _NOT_REALLY) or not isinstance(value, int | float | np.integer | np.floating):
        raise ValueError(f"{name} is {shown(value)}; give a number{f' in {unit}' if unit else ''}, {bound}")
    try:
        result = float(value)
    except OverflowError:
        result = math.inf if value > 0 else -math.inf
    if not bound.between(result, result):
        raise ValueError(f"{name} is {shown(value)}{f' {unit}' if unit else ''}; it must be {bound}")
    return result


def whole_number(name: str, value: Any, low: int, high: int | None = None) -> int:
    """An integer, of Python or NumPy, from `low` to `high`. Raises ValueError for anything else, also for 2.0."""
    whole = isinstance(value, int | np.integer) and not isinstance(value, _NOT_REALLY)
    if not whole or value < low or (high is not None and value > high):
        allowed = f"of at least {low}" if high is None else f"from {low} to {high}"
        raise ValueError(f"{name} is {shown(value)}; give a whole number {allowed}")
    return int(value)


def flag(name: str, value: Any) -> bool:
    """True or False. Raises ValueError for what merely counts as one of them."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} is {shown(value)}; give True or False")
    return bool(value)


def text(name: str, value: Any) -> str:
    """A text that is not empty. Raises ValueError for anything else."""
    if not isinstance(value, str) or not value:
        raise ValueError(f"{name} is {shown(value)}; give a text that is not empty")
    return value


def choice(name: str, value: Any, allowed: Iterable[str], *, none: bool = False) -> None:
    """Raise ValueError where the value is none of the allowed texts, naming these; `none` allows None as well."""
    several = [*([None] if none else []), *allowed]
    if not isinstance(value, str | None) or value not in several:
        raise ValueError(f"{name} is {shown(value)}; allowed are {', '.join(map(repr, several))}")


def instance(name: str, value: Any, kind: type, *, none: str | None = None) -> None:
    """Raise ValueError where the value is not of a class; `none` says what None stands for, where it is allowed."""
    if not (isinstance(value, kind) or (value is None and none is not None)):
        besides = "" if none is None else f", or None for {none}"
        raise ValueError(f"{name} is {shown(value)}; give a {kind.__name__}{besides}")


def mapping(name: str, value: Any, keys: Iterable[str]) -> None:
    """Raise ValueError where the value is no mapping with these keys, all of them and no other."""
    wanted = list(keys)
    if not isinstance(value, Mapping) or set(value) != set(wanted):
        raise ValueError(f"{name} is {shown(value)}; give a mapping with {', '.join(wanted) or 'nothing in it'}")


def only(what: str, given: Iterable[Any], allowed: Sequence[str]) -> None:
    """Raise TypeError for a name that is not allowed, naming those that are; `what` is such as "argument"."""
    unknown = [name for name in given if name not in allowed]
    if unknown:
        raise TypeError(f"unexpected {what} {', '.join(map(shown, unknown))}; allowed are {', '.join(allowed)}")


def real(name: str, value: Any) -> Array:
    """The value as an array of float64; a float64 array is not copied.

    Raises:
        ValueError: it holds something else than integers and floats, or masked values, or is no array at all.
    """
    array = value
    if type(value) is not np.ndarray:
        if isinstance(value, np.ma.MaskedArray):
            raise ValueError(f"{name} is {shown(value)}; give an array without a mask, such as .filled(0.0)")
        try:
            array = np.asarray(value)
        except Exception as error:  # ragged lists, and whatever an object's __array__ raises
            raise ValueError(f"{name} is {shown(value)}; give an array of real numbers: {error}") from error
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name} is {shown(value)}, of type {array.dtype}; give real numbers")
    return np.asarray(array, dtype=np.float64)


def real_array(name: str, value: Any, shape: tuple[int, ...], bound: Bound = FINITE) -> Array:
    """A new array of real numbers of one shape. Raises ValueError for anything else."""
    array = np.array(real(name, value))
    if array.shape != shape or not bound.holds(array):
        raise ValueError(f"{name} is {shown(value)}, of shape {array.shape}; give {bound} numbers of shape {shape}")
    return array


def real_arrays(name: str, value: Any, like: Mapping[str, Array]) -> None:
    """Raise ValueError where the value is no mapping of finite arrays with the keys and the shapes of `like`."""
    mapping(name, value, like)
    for key, array in like.items():
        real_array(f"{name}[{key!r}]", value[key], array.shape)


def whole_array(name: str, value: Any, shape: tuple[int, ...], low: int, high: int) -> NDArray[np.int64]:
    """A new array of integers of one shape, from `low` to `high`. Raises ValueError for anything else."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu" or array.shape != shape or not np.all((array >= low) & (array <= high)):
        raise ValueError(f"{name} is {shown(value)}; give whole numbers from {low} to {high}, of shape {shape}")
    return array.astype(np.int64)


def values(name: str, value: Any, bound: Bound = FINITE) -> float | Array:
    """One number for all joints, or a new array with one for each. Raises ValueError for anything else."""
    if type(value) is float and bound.between(value, value):
        return value  # most of them, and quickly
    array = real(name, value)
    if array.ndim > 1 or array.size == 0:
        raise ValueError(f"{name} has shape {array.shape}; give one value for all joints or one for each of them")
    if not bound.holds(array):
        raise ValueError(f"{name} is {shown(value)}; every value must be {bound}")
    return array.copy() if array.ndim else float(array)


def number_range(name: str, value: Any, bound: Bound = FINITE) -> tuple[float, float]:
    """Two numbers (low, high), low <= high. Raises ValueError for anything else."""
    array = real(name, value)
    if array.shape != (2,) or not bound.holds(array) or array[0] > array[1]:
        raise ValueError(f"{name} is {shown(value)}; give two numbers (low, high), low <= high, each {bound}")
    return float(array[0]), float(array[1])


def _settle(owner: Any, check: Any, bounds: dict[str, Bound]) -> None:
    for name, bound in bounds.items():
        object.__setattr__(owner, name, check(f"{type(owner).__name__}.{name}", getattr(owner, name), bound))


def check_numbers(owner: Any, **bounds: Bound) -> None:
    """Check fields of a frozen dataclass that are single numbers, and keep them as floats."""
    _settle(owner, number, bounds)


def check_ranges(owner: Any, **bounds: Bound) -> None:
    """Check fields of a frozen dataclass that are ranges (low, high), and keep them as tuples."""
    _settle(owner, number_range, bounds)


def check_values(owner: Any, **bounds: Bound) -> None:
    """Check fields of a frozen dataclass that have one value for all joints, or one for each; keep copies of them.

    Raises:
        ValueError: a field is no such thing or out of bounds, or two fields are for different numbers of joints.
    """
    _settle(owner, values, bounds)
    sizes = {name: np.size(getattr(owner, name)) for name in bounds}
    several = {name: size for name, size in sizes.items() if size > 1}
    if len(set(several.values())) > 1:
        told = ", ".join(f"{name} has {size} values" for name, size in several.items())
        raise ValueError(f"{type(owner).__name__}: {told}; give one value for all joints or one for each of them")
