"""The training environment: every joint of a batch is an agent, and all agents share one policy."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from baselines.rl.course import course_of
from baselines.rl.design import Design
from baselines.rl.loop import FEATURES, PolicyLoop
from fo_gym import JointInfo, Signals

Array = NDArray[np.float64]

ROUGHNESS_WEIGHT = 0.05
ENDING_COST = 20.0
VELOCITY_TIME = 0.1
_FOREVER = 1e5

__all__ = ["REWARD", "TrainingEnv"]

REWARD = (
    "-(log(1 + d/r) + log(1 + |e|/r)) / 2, mean over the action's control ticks, - 0.05 |change of action|, - 20 where "
    "a joint left its range; d^2 = (theta - theta_ideal)^2 + (0.1 s (theta' - theta_ideal'))^2, theta_ideal the same "
    "episode without friction, e = theta_n - theta, r the course's resolution"
)
"""The reward, in words. The logarithm asks for precision at every scale, the velocity in d for passivity."""


class TrainingEnv(VectorEnv[Any, Any, Any]):
    """`num_envs` robots with their friction-free twins; agents are (robot, joint), robot by robot.

    Observation: the inputs of `PolicyLoop`, float32. Action: that of `PolicyLoop`, one number in [-1, 1]. One step is
    one action of the policy. The autoreset mode is DISABLED. Episodes are the course's; the first of each robot after
    `reset` is cut at a random length, so that later ones do not run in step. They are terminated where a joint leaves
    its range, which costs, or one of the twin does, which does not.

    Args:
        env_id: an environment with a course.
        num_envs: robots.
        design: of the policy.

    Attributes:
        seconds: time spent in `step` and `reset` so far [s].
        rewards: mean reward of every step so far.
    """

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.DISABLED}  # noqa: RUF012

    def __init__(self, env_id: str, num_envs: int, design: Design) -> None:
        self.course = course_of(env_id)
        # The episodes end here, at a step of the policy, not in the environments.
        arguments: dict[str, Any] = {
            "num_envs": num_envs,
            "variant": "randomized",
            "duration": _FOREVER,
            "autoreset_mode": AutoresetMode.DISABLED,
            "randomization": self.course.randomization,
            "physics_dt": "auto",  # the course has faster joints than the default step follows
        }
        self._robots = gym.make_vec(env_id, feedback="nominal", **arguments)
        self._twins = gym.make_vec(env_id, disturbed=False, **arguments)
        assert self._robots.single_action_space.shape is not None
        (self._dof,) = self._robots.single_action_space.shape
        self._loop = PolicyLoop(design)
        self._length = round(self.course.duration / design.period)
        self._nothing = np.zeros((num_envs, self._dof))
        self._generator: np.random.Generator | None = None
        self.num_envs = num_envs * self._dof
        self.single_observation_space = Box(-np.inf, np.inf, (len(FEATURES),), np.float32)
        self.single_action_space = Box(-1.0, 1.0, (1,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.seconds = 0.0
        self.rewards: list[float] = []

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start episodes: everywhere, or for the agents of options["reset_mask"].

        Robot i gets the seed `seed` + i; of a sequence the first counts, since joints of one robot share theirs. None
        continues the generators; the first time it seeds them at random.

        Raises:
            ValueError: the mask tells joints of one robot apart.
        """
        start = time.perf_counter()
        if options is None:
            first = seed[0] if isinstance(seed, Sequence) else seed
            self._reset_all(first)
        else:
            joints: NDArray[np.bool_] = np.asarray(options["reset_mask"]).reshape(-1, self._dof)
            robots = np.logical_and.reduce(joints, axis=1)
            if (joints != robots[:, None]).any():
                raise ValueError("reset_mask tells joints of one robot apart; they are reset together")
            self._reset_some(robots)
        self.seconds += time.perf_counter() - start
        return self._observation(), {}

    def _reset_all(self, seed: int | None) -> None:
        if seed is None and self._generator is None:
            seed = int(np.random.default_rng().integers(2**63))  # robots and twins must draw alike
        obs, _ = self._robots.reset(seed=seed)
        self._twins.reset(seed=seed)
        self._see(obs)
        robots = self._nothing.shape[0]
        self._loop.reset(self._joints, robots)
        if self._generator is None or seed is not None:
            self._generator = np.random.default_rng(seed)
        self._left = self._generator.integers(1, self._length + 1, robots)
        self._broken, self._unmatched = np.zeros((2, robots), dtype=bool)

    def _reset_some(self, mask: NDArray[np.bool_]) -> None:
        obs, _ = self._robots.reset(options={"reset_mask": mask.copy()})
        self._twins.reset(options={"reset_mask": mask.copy()})
        self._see(obs)
        self._loop.restart(np.flatnonzero(mask), self._joints)
        self._left[mask] = self._length
        self._broken[mask] = self._unmatched[mask] = False

    @property
    def _joints(self) -> JointInfo:
        robots: Any = self._robots.unwrapped
        return robots.joint_info

    def _see(self, obs: Array) -> None:
        self._signals = Signals.from_observation(obs, self._dof)

    def _observation(self) -> NDArray[np.float32]:
        return self._loop.features(self._signals).reshape(self.num_envs, -1).astype(np.float32)

    def step(self, actions: NDArray[Any]) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """Hold the agents' actions, (num_envs, 1), for one period of the policy."""
        start = time.perf_counter()
        before = self._loop.action
        self._loop.act(np.asarray(actions, dtype=np.float64).reshape(self._nothing.shape), self._signals)
        cost = ROUGHNESS_WEIGHT * np.abs(self._loop.action - before)
        for _ in range(self._loop.hold):
            cost += self._tick() / self._loop.hold
        cost[self._broken] += ENDING_COST
        self.rewards.append(-float(cost.mean()))
        self._left -= 1
        # Where the twin left its range, too: the observation is the next episode's already, from which nobody may
        # bootstrap as from that of a cut. It costs nothing, since no action brings it about.
        terminated = self._broken | self._unmatched
        truncated = (self._left <= 0) & ~terminated
        self.seconds += time.perf_counter() - start
        ends = np.repeat(terminated, self._dof), np.repeat(truncated, self._dof)
        return self._observation(), -cost.reshape(-1), *ends, {}

    def _tick(self) -> Array:
        """One control tick; the cost of it, (robots, dof)."""
        obs, _, ended, _, truth = self._robots.step(self._loop.estimate(self._signals))
        _, _, twin_ended, _, ideal = self._twins.step(self._nothing)
        # Who leaves the range begins again at once, since an ended environment cannot be stepped; the end is reported
        # when the policy's period is over.
        lost = ended | twin_ended
        if lost.any():
            self._broken |= ended
            self._unmatched |= twin_ended
            obs, _ = self._robots.reset(options={"reset_mask": lost.copy()})
            self._twins.reset(options={"reset_mask": lost.copy()})
        self._see(obs)
        e = self._signals.theta_n - self._signals.theta
        distance = np.hypot(truth["theta"] - ideal["theta"], VELOCITY_TIME * (truth["theta_dot"] - ideal["theta_dot"]))
        r = self.course.resolution
        return 0.5 * (np.log1p(distance / r) + np.log1p(np.abs(e) / r))
