"""Where a newcomer begins: questions that traces answer, each with its numbers and the place to look at."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pandas as pd

from fo_gym.envs.registry import environment_of
from fo_gym.page.board import key_of

_LINK, _SQUARE = "FJRStiction-v0", "FJRSquare-v0"

__all__ = ["Story", "stories"]


@dataclass(frozen=True)
class Story:
    """A question, its answer, and where to see it.

    Attributes:
        key: names it in addresses.
        question: of a newcomer.
        answer: in plain words, with the numbers of the table.
        ranking: key of the ranking that it is about.
        shown: whose traces answer it.
        span: the seconds to look at.
        more: the page of the documentation that tells more.
    """

    key: str
    question: str
    answer: str
    ranking: str
    shown: tuple[str, ...]
    span: tuple[float, float]
    more: str


class _Table:
    """The table, asked for single numbers."""

    def __init__(self, table: pd.DataFrame) -> None:
        self._rows = table.set_index(["env", "robot", "variant", "compensator"])

    def __call__(self, env: str, variant: str, name: str, column: str) -> float:
        """A number. Raises KeyError where there is no such row, or none of these."""
        value = float(self._rows.at[(env, environment_of(env).robot_name, variant, name), column])  # type: ignore[arg-type]
        if math.isnan(value):
            raise KeyError(column)
        return value


def _why_pid_hunts(number: _Table) -> Story:
    size = 1e3 * number(_LINK, "nominal", "pid-low", "limit_cycle_peak_to_peak_ju")
    period = number(_LINK, "nominal", "pid-low", "limit_cycle_period_s")
    return Story(
        "pid-low",
        "Why does PID-low oscillate?",
        "Its integrator does not stop while the joint sticks. The estimate (dashed) climbs on until it breaks the "
        "joint free; the joint hops past the target, for friction falls as soon as it slides, and sticks on the other "
        f"side. Then all of it begins again the other way round: {size:.2f} mm from peak to peak, every {period:.1f} "
        "s, for ever. It is called hunting, or a limit cycle.",
        key_of(_LINK, environment_of(_LINK).robot_name, "nominal"),
        ("pid-low",),
        (0.0, 20.0),
        "theory/hunting.html#why-the-pid-type-hunts",
    )


def _why_pd_stops_short(number: _Table) -> Story:
    rest = 1e3 * number(_LINK, "nominal", "pd-low", "steady_state_error_ju")
    return Story(
        "pd-low",
        "Why does PD-low stop off the target?",
        f"Without an integrator nothing climbs: the joint comes to rest {rest:.2f} mm off the target, where friction "
        "holds what is left of the control torque, and stays there. It does not hunt. Its error shrinks as gains grow.",
        key_of(_LINK, environment_of(_LINK).robot_name, "nominal"),
        ("pd-low", "pid-low"),
        (0.0, 20.0),
        "theory/hunting.html#why-the-pd-type-stops-short",
    )


def _what_gains_buy(number: _Table) -> Story:
    rest = 1e6 * number(_LINK, "nominal", "pid-high", "steady_state_error_ju")
    low, high = (100.0 * number(_LINK, "hardware", name, "hunting_ratio") for name in ("pid-low", "pid-high"))
    return Story(
        "pid-high",
        "Do higher gains cure it?",
        f"On the ideal joint, yes: with twice the bandwidth the PID-type creeps to within {rest:.1f} um of the target "
        f"and rests. With a real robot's sensors, delays and model errors (variant hardware) it hunts in {high:.0f} % "
        f"of the episodes, PID-low in {low:.0f} %.",
        key_of(_LINK, environment_of(_LINK).robot_name, "hardware"),
        ("pid-low", "pid-high"),
        (0.0, 20.0),
        "hardware.html",
    )


def _what_it_means_for_a_tool(number: _Table) -> Story:
    none, good, ideal = (number(_SQUARE, "nominal", name, "contour_error_mm") for name in ("none", "pid-high", "ideal"))
    return Story(
        "square",
        "What does it mean for a tool?",
        "An arm under soft impedance draws a square of 15 cm. Without friction it would miss the contour by "
        f"{ideal:.1f} mm (RMS); with friction and no compensation by {none:.1f} mm, with PID-high by {good:.1f} mm. "
        "Friction bites hardest at the corners, where joints turn round.",
        key_of(_SQUARE, environment_of(_SQUARE).robot_name, "nominal"),
        ("none", "pid-high"),
        (0.0, 8.0),
        "environments/FJRSquare-v0.html",
    )


_STORIES: Sequence[Callable[[_Table], Story]] = (
    _why_pid_hunts,
    _why_pd_stops_short,
    _what_gains_buy,
    _what_it_means_for_a_tool,
)


def stories(table: pd.DataFrame) -> list[Story]:
    """The stories whose rows the table has.

    Args:
        table: rows as `leaderboard` gives them, read from leaderboard.csv.
    """
    found = []
    for story in _STORIES:
        try:
            found.append(story(_Table(table)))
        except KeyError:
            continue
    return found
