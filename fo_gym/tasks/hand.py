"""A human hand at the tool: a spring and a damper to a point of its own, which follows a drawn path."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, check_numbers, real_array, shown, whole_number
from fo_gym.robots import Robot
from fo_gym.tasks.hand_fit import fitted_hand
from fo_gym.tasks.square_fit import Direction
from fo_gym.tasks.stroke import stroke_at

Array = NDArray[np.float64]

__all__ = ["Hand"]


@dataclass(frozen=True)
class Hand:
    """A passive hand that grips the tool, guides it to and fro on a straight line, and lets it go at the far end.

    f = s (k (p - x) + d (p' - x')) acts on the tool at x, without a moment; p is the hand's own point. Strokes go from
    where the tool was gripped to `stroke` away, and back: each swells to `speed` in `turn` seconds, keeps it, and dies
    away likewise, so that p is smooth up to acceleration. After the last one p rests.

    The hand is passive: what it gives to the tool is at most what its own point put in. Spring and damper are, as long
    as s stays. It grips (s from 0 to 1 at once) where the tool is, so that its spring starts without energy and without
    force; and while it lets go, s falls smoothly, which only takes energy out of the spring: d/dt (s k e^2 / 2) has the
    term s' k e^2 / 2 <= 0.

    Attributes:
        grip: when it grips [s].
        strokes: how many; an odd number ends away from where it gripped.
        turn: how long a stroke takes to reach its speed [s].
        rest: how long it rests after the last stroke before it lets go [s].
        release: how long it takes to let go [s].
        stroke: length of one [m]; None for one that suits the robot.
        speed: of the middle part of a stroke [m/s]; at most stroke / turn; None likewise.
        stiffness: k [N/m]; None likewise.
        damping: d [N s/m]; None likewise.
        direction: unit vector of the first stroke, in the world; None likewise.
        across: unit vector at a right angle to it; drawn strokes lie between the two. None likewise.
    """

    grip: float = 1.0
    strokes: int = 3
    turn: float = 0.5
    rest: float = 0.5
    release: float = 0.1
    stroke: float | None = None
    speed: float | None = None
    stiffness: float | None = None
    damping: float | None = None
    direction: Direction | None = None
    across: Direction | None = None

    def __post_init__(self) -> None:
        check_numbers(self, grip=NOT_NEGATIVE, turn=POSITIVE, rest=NOT_NEGATIVE, release=POSITIVE)
        whole_number("Hand.strokes", self.strokes, 1)
        bounds = {"stroke": POSITIVE, "speed": POSITIVE, "stiffness": POSITIVE, "damping": NOT_NEGATIVE}
        check_numbers(self, **{name: bound for name, bound in bounds.items() if getattr(self, name) is not None})
        given = [each for each in ("direction", "across") if getattr(self, each) is not None]
        axes = np.array([real_array(f"Hand.{each}", getattr(self, each), (3,)) for each in given]).reshape(-1, 3)
        if not np.allclose(axes @ axes.T, np.eye(len(axes)), rtol=0.0, atol=1e-9):
            told = ", ".join(f"Hand.{each} is {getattr(self, each)}" for each in given)
            raise ValueError(f"{told}; give unit vectors, at a right angle to each other")
        if self.stroke is not None and self.speed is not None and self.speed * self.turn > self.stroke:
            raise ValueError(
                f"Hand.speed is {self.speed:g} m/s; a stroke of {self.stroke:g} m that takes {self.turn:g} s to reach "
                f"it has at most {self.stroke / self.turn:g} m/s"
            )

    def fitted_to(self, robot: Robot) -> Hand:
        """The same with what was left open chosen for a robot. Raises ValueError where there is no room for a hand."""
        if self.is_fitted:
            return self
        chosen = fitted_hand(robot, self.stroke, self.direction, self.across, self.stiffness)
        found = {name: value for name, value in chosen._asdict().items() if getattr(self, name) is None}
        return replace(self, **found)

    @property
    def is_fitted(self) -> bool:
        """Whether nothing is left open."""
        return all(value is not None for value in vars(self).values())

    @property
    def _whole(self) -> Any:
        """This hand, nothing left open. Raises ValueError where something is."""
        if not self.is_fitted:
            left = [name for name, value in vars(self).items() if value is None]
            raise ValueError(f"{shown(self)} has no {', '.join(left)} yet; give them, or use fitted_to(robot)")
        return self

    @property
    def stroke_time(self) -> float:
        """Of one stroke [s]."""
        hand = self._whole
        return float(hand.stroke / hand.speed + hand.turn)

    @property
    def let_go(self) -> float:
        """When it begins to let go [s]."""
        return self.grip + self.strokes * self.stroke_time + self.rest

    @property
    def steady(self) -> list[tuple[float, float]]:
        """(start, end) [s] of the middle part of each stroke, in which its speed is constant."""
        starts = [self.grip + i * self.stroke_time for i in range(self.strokes)]
        return [(start + self.turn, start + self.stroke_time - self.turn) for start in starts]

    def at(self, time: Array) -> tuple[Array, Array]:
        """How far its point is from where it gripped [m], and its speed [m/s], at `time` (n,) [s], (n,) each."""
        hand = self._whole
        since = np.asarray(time, dtype=np.float64) - self.grip
        both = [stroke_at(each, hand.stroke, hand.speed, hand.turn, hand.strokes) for each in since]
        distance, speed = np.array(both).reshape(-1, 2).T
        return distance, speed
