"""What `reset(options=...)` may ask for: another target, another push."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import instance, real_array, shown
from fo_gym.tasks.scenario import Push, Scenario
from fo_gym.tasks.task import Task

Array = NDArray[np.float64]

_PUSH = ("time", "duration", "torque")

__all__ = ["Limits", "Options"]


@dataclass(frozen=True, eq=False)
class Options:
    """What replaces the drawn parts of an episode; None leaves them as they are.

    Attributes:
        target: desired links after the step, (dof,), m or rad.
        push: external push.
    """

    target: Array | None = None
    push: Push | None = None

    def applied_to(self, scenario: Scenario) -> Scenario:
        """The scenario with these parts replaced."""
        parts = {name: part for name, part in vars(self).items() if part is not None}
        return replace(scenario, **parts) if parts else scenario


@dataclass(frozen=True, eq=False)
class Limits:
    """What options can be met at all.

    Attributes:
        joints: names of the joints.
        low, high: their ranges, (dof,), m or rad; infinite where there is none.
        duration: length of an episode [s].
        takes_target: whether the task steps to a target, instead of following a path.
    """

    joints: tuple[str, ...]
    low: Array
    high: Array
    duration: float
    takes_target: bool

    def read(self, options: Mapping[str, Any] | None) -> Options:
        """Check options, all of them before anything is done.

        Args:
            options: {"target": (dof,), "push": {"time": s, "duration": s, "torque": (dof,)}}, each key optional.

        Raises:
            ValueError: an unknown key, a wrong shape, a target outside the joints' range or for a task that follows a
                path, or a push that does not end before the episode does.
        """
        instance("options", options, Mapping, none="no changes")
        options = options or {}
        unknown = [key for key in options if key not in ("target", "push")]
        if unknown:
            raise ValueError(f"unknown reset options {shown(unknown)}; allowed are 'target' and 'push'")
        return Options(
            target=self._target(options["target"]) if "target" in options else None,
            push=self._push(options["push"]) if "push" in options else None,
        )

    def check_draws(self, task: Task, home: Array) -> None:
        """Raise ValueError where an episode that is drawn could start or aim outside a joint's range."""
        spread = task.randomization
        farthest = task.reference.target(home, spread.step[1])
        drawn = {"start": spread.start} | ({} if farthest is None else {"step": np.abs(farthest - home)})
        for name, reach in drawn.items():
            for j in np.flatnonzero((home - reach < self.low) | (home + reach > self.high)):
                raise ValueError(
                    f"Randomization.{name} is {getattr(spread, name)}: it takes joint {self.joints[j]!r} from "
                    f"{home[j]:g} out of its range, {self.low[j]:g} to {self.high[j]:g}; give a smaller one"
                )

    def _target(self, value: Any) -> Array:
        if not self.takes_target:
            raise ValueError("this task follows a path: it takes no 'target' in the reset options")
        target = real_array("reset option 'target'", value, self.low.shape)
        for j in np.flatnonzero((target < self.low) | (target > self.high)):
            raise ValueError(
                f"reset option 'target' is {target[j]:g} at joint {self.joints[j]!r}, outside its range: give a value "
                f"from {self.low[j]:g} to {self.high[j]:g}"
            )
        return target

    def _push(self, value: Any) -> Push:
        if not isinstance(value, Mapping) or set(value) != set(_PUSH):
            raise ValueError(
                f"reset option 'push' is {shown(value)}; give a mapping with 'time', 'duration' and 'torque'"
            )
        push = Push(value["time"], value["duration"], real_array("push torque", value["torque"], self.low.shape))
        if push.time + push.duration > self.duration * (1.0 + 1e-9):
            raise ValueError(
                f"push time is {push.time:g} s and its duration {push.duration:g} s, but the episode ends after "
                f"{self.duration:g} s; push earlier, or make the environment with a longer duration"
            )
        return push
