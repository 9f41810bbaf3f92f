"""What the tests of hostile input share: values that are nothing, and the list of those that were not refused well."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from datetime import date
from typing import Any

import numpy as np

from fo_gym.checks import shown

Attack = tuple[str, Any, Callable[[Any], object]]
"""Name of an argument as the message must give it, a value for it, and a call with this value."""

NO_NUMBERS = (
    True,
    np.True_,
    "1.5",
    b"1",
    1j,
    np.complex128(1.0),
    np.datetime64("2020-01-01"),
    np.timedelta64(1, "s"),
    date(2020, 1, 1),
    {"value": 1.0},
    {1.0},
    len,
    object(),
)
"""What is no real number, although NumPy takes some of it for one."""

NO_ARRAYS = (
    *NO_NUMBERS,
    None,
    [1.0, [2.0]],
    ["a"],
    [None],
    np.array([1j]),
    np.array([True]),
    np.array(["1"]),
    np.array([1.0], dtype=object),
    np.array(["2020-01-01"], dtype="datetime64[D]"),
    np.array([(1.0, 2)], dtype=[("a", float), ("b", int)]),
    np.ma.masked_array([1.0], mask=[True]),
)
"""What is no array of real numbers."""

_REMEDY = re.compile(
    r"\b(give|must|allowed|takes?|needs?|make|name|use|keep|raise|leave|choose|install|names?|installed|known are)\b"
)


def check_refused(attacks: Iterable[Attack]) -> None:
    """Fail, naming them all, where attacks are accepted, end in another error, or lack name, value or remedy."""
    found = offenders(attacks)
    assert not found, "\n".join(found)


def offenders(attacks: Iterable[Attack]) -> list[str]:
    """A line for each attack that is not refused as it should be; a value counts as told where its shape is."""
    found = []
    for name, value, call in attacks:
        case = f"{name} = {shown(value)}"
        try:
            call(value)
        except (ValueError, TypeError) as error:
            told = str(error)
            texts = (shown(value), "shape", *([value] if isinstance(value, str) else []))
            texts += ("is missing",) if value is None else ()
            lacks = [
                what
                for what, there in (
                    ("the name", name in told),
                    ("the value", any(text in told for text in texts)),
                    ("a remedy", _REMEDY.search(told) is not None),
                    ("one line", "\n" not in told),
                )
                if not there
            ]
            found += [f"{case}: the message lacks {', '.join(lacks)}: {told}"] if lacks else []
        except Exception as error:
            found.append(f"{case}: {type(error).__name__}: {error}")
        else:
            found.append(f"{case}: accepted")
    return found
