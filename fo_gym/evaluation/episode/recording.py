"""A recording: what happened in a batch of episodes of one compensator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.evaluation.episode.record import Episode, Motion
from fo_gym.robots import Robot
from fo_gym.tasks.scenario import Scenario
from fo_gym.tasks.task import Task

Array = NDArray[np.float64]


__all__ = ["Motions", "Recording", "References"]


@dataclass(frozen=True)
class Motions:
    """Motors, tools and hands of a batch.

    Attributes:
        theta: (ticks, num_envs, dof), m or rad.
        tool: (ticks, num_envs, 3), m, or None.
        f_hand: (periods, num_envs, 3), N, or None.
        lost: (periods, num_envs), J, or None.
    """

    theta: Array
    tool: Array | None
    f_hand: Array | None = None
    lost: Array | None = None

    def episode(self, i: int) -> Motion:
        """Motors, tool and hand of episode i."""
        rest = (None if each is None else each[:, i] for each in (self.tool, self.f_hand, self.lost))
        return Motion(self.theta[:, i], *rest)


@dataclass(frozen=True)
class References:
    """The two runs that every score of a batch is relative to.

    Attributes:
        ideal: without anything that disturbs the motors.
        none: with all of it, without compensation.
    """

    ideal: Motions
    none: Motions


@dataclass(frozen=True)
class Recording:
    """A batch of episodes of one compensator.

    Joints are told in `Robot.joint_unit`: where some turn and some slide, in rad, and torques in N m, slides by their
    `Robot.levers`.

    Attributes:
        robot, task: what was run.
        dt: time between two ticks [s].
        ticks: arrays (ticks, num_envs, size) by name: theta, theta_dot, q, q_dot, and on a path tool, as they truly
            were; theta_n, theta_n_dot, theta_d, reference as the compensator saw them.
        periods: arrays (periods, num_envs, dof) by name: tau_f_hat, tau_m, tau_f, tau_dist, tau_ext; with a hand f_hand
            (periods, num_envs, 3), lost and damped (periods, num_envs), see Motion and Episode.
        diagnostics: arrays (periods, num_envs, dof) by name, see `Compensator.diagnostics`; empty where there are none.
        scenarios: the drawn episodes.
        stored: energy in the joints when the push of each episode begins, see `stored_energy`, (num_envs,) [J].
        torque_limit: (dof,).
        terminations: "" or why each episode ended early.
        ended: tick at which each episode ended.
        seconds: time that each call of `estimate` took, (periods,) [s].
    """

    robot: Robot
    task: Task
    dt: float
    ticks: Mapping[str, Array]
    periods: Mapping[str, Array]
    diagnostics: Mapping[str, Array]
    scenarios: Sequence[Scenario]
    stored: Array
    torque_limit: Array
    terminations: Sequence[str]
    ended: NDArray[np.int64]
    seconds: Array

    @property
    def motions(self) -> Motions:
        """Motors, tools and hands of all episodes."""
        periods = self.periods
        return Motions(self.ticks["theta"], self.ticks.get("tool"), periods.get("f_hand"), periods.get("lost"))

    def part(self, rows: slice) -> Recording:
        """Some episodes of the batch as a recording of their own; the time per call is their share of it."""
        share = len(self.ended[rows]) / len(self.ended)
        return replace(
            self,
            ticks={name: array[:, rows] for name, array in self.ticks.items()},
            periods={name: array[:, rows] for name, array in self.periods.items()},
            diagnostics={name: array[:, rows] for name, array in self.diagnostics.items()},
            scenarios=self.scenarios[rows],
            stored=self.stored[rows],
            terminations=self.terminations[rows],
            ended=self.ended[rows],
            seconds=self.seconds * share,
        )

    def episode(self, i: int, references: References) -> Episode:
        """The record of episode i, beside its two references."""
        ticks = {name: array[:, i] for name, array in self.ticks.items()}
        periods = {name: array[:, i] for name, array in self.periods.items()}
        return Episode(
            dt=self.dt,
            joint_unit=self.robot.joint_unit,
            motion=self.motions.episode(i),
            ideal=references.ideal.episode(i),
            none=references.none.episode(i),
            theta_dot=ticks["theta_dot"],
            q=ticks["q"],
            q_dot=ticks["q_dot"],
            theta_n=ticks["theta_n"],
            theta_n_dot=ticks["theta_n_dot"],
            theta_d=ticks["theta_d"],
            tool_d=ticks["reference"] if self.task.reference.of_tool else None,
            tau_f_hat=periods["tau_f_hat"],
            tau_f=periods["tau_f"],
            tau_dist=periods["tau_dist"],
            tau_m=periods["tau_m"],
            tau_ext=periods["tau_ext"],
            torque_limit=self.torque_limit,
            step_time=self.task.reference.step_time,
            limit_cycle_window=self.task.limit_cycle_window,
            motion_window=self.task.reference.motion_window,
            push=self.scenarios[i].push,
            stored=float(self.stored[i]),
            termination=self.terminations[i],
            hand=self.scenarios[i].hand,
            damped=periods.get("damped"),
        )
