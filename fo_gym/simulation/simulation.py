"""A batch of episodes: plant, task, nominal motor and observation, without Gymnasium."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.binding import Binds, bound
from fo_gym.checks import instance
from fo_gym.control.nominal_motor import NominalMotor
from fo_gym.hardware import HardwareDraw
from fo_gym.hardware.model import HardwareModel
from fo_gym.parameters import JointInfo
from fo_gym.robots import RobotLike
from fo_gym.robots.poses import joint_range
from fo_gym.simulation.hands import Hands
from fo_gym.simulation.kernels import (
    INSIDE,
    LOST,
    OUTSIDE,
    TAU_EXT,
    TAU_M,
    close,
    settle,
    torques,
)
from fo_gym.simulation.memory import Memory
from fo_gym.simulation.pushes import Pushes
from fo_gym.simulation.settings import Settings
from fo_gym.simulation.state import Origin, SimulationState
from fo_gym.simulation.steps import plant_of
from fo_gym.tasks.control import TaskControl
from fo_gym.tasks.draw import draw_scenario
from fo_gym.tasks.options import Limits, Options
from fo_gym.tasks.scenario import Scenario
from fo_gym.tasks.task import TaskLike

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

_EVERYONE = slice(None)

JOINT_LIMIT = "joint_limit"
NON_FINITE = "non_finite"


__all__ = ["JOINT_LIMIT", "NON_FINITE", "Simulation"]


class Simulation(Binds):
    """`num_envs` episodes of one robot and task, advanced together.

    Args:
        robot: the environment's own.
        task: likewise, or a function that makes one for a robot.
        num_envs: size of the batch.
        settings: how it is run; they are applied to robot and task.
        num_threads: see FlexibleJointPlant.

    Attributes:
        robot, task: what is simulated, settings applied.
        scenarios: the current episode of each environment.
        ticks: control ticks since reset, (num_envs,).
        memory: signals, and what acts.
        hardware_model: the plant with its hardware's effects: what is measured.
        limits: of what the options of a reset may ask for.
        hands: at the tools, or None.
    """

    bindings = ("_torques", "_settles", "_close")

    def __init__(
        self,
        robot: RobotLike | None,
        task: TaskLike | None,
        num_envs: int,
        settings: Settings,
        num_threads: int | None = None,
    ) -> None:
        self.robot, self.task = settings.applied_to(robot, task)
        self.settings = settings
        self.last_tick = settings.ticks(self.task)
        self.dof = self.robot.dof
        self.torque_limit = np.asarray(self.robot.flexible.torque_limit)
        self.plant = plant_of(self.robot, self.task, num_envs, settings, num_threads)
        self.num_envs = num_envs = self.plant.num_envs
        self.control: TaskControl = self.task.reference.control(self.robot, self.plant, self.task.gains)
        scale = self.task.reward_scale
        self._scale = scale if self.task.reference.of_tool else np.full(self.dof, scale)
        self.memory = memory = Memory(num_envs, self.dof, self.control.reference.shape[1], settings.sensors)
        self.nominal_motor = NominalMotor(memory.signals.theta_n, memory.signals.theta_n_dot, settings.control_dt)
        self.hardware_model = HardwareModel(
            self.plant,
            self.robot.hardware,
            self.torque_limit,
            memory.readings,
            tachometer=settings.sensors == "full",
            disturbed=settings.disturbed,
        )
        nominal = draw_scenario(replace(self.robot, hardware=None), self.task, "nominal", np.random.default_rng(0))
        self.scenarios: list[Scenario] = [nominal] * num_envs
        self.ticks = np.zeros(num_envs, dtype=np.int64)
        self._box = joint_range(self.plant.body.model)
        self.limits = Limits(
            self.robot.joints,
            *self._box,
            duration=self.last_tick * settings.control_dt,
            takes_target=nominal.target is not None,
        )
        if settings.variant != "nominal":
            self.limits.check_draws(self.task, self.robot.home)
        self._origin = Origin.of(self.robot, self.task, num_envs, settings)
        self._where = np.full(num_envs, INSIDE)
        self._others = np.zeros(self.plant.threads.count, dtype=np.int64)  # who are not inside, of each thread's share
        self._period = np.zeros(1, dtype=np.int64)  # of a step
        self._compensates = settings.action_mode == "compensation"
        self._pushes = Pushes(num_envs, self.dof)
        self.hands = None if self.task.hand is None else Hands(self.plant, settings.decimation)
        self.bind()

    def bind(self) -> None:
        """Let everybody write into the one memory, and see Binds."""
        memory, signals, hardware = self.memory, self.memory.signals, self.hardware_model
        self.nominal_motor.theta, self.nominal_motor.theta_dot = signals.theta_n, signals.theta_n_dot
        self.control.theta_d, self.control.reference = signals.theta_d, signals.reference
        hardware.readings = memory.readings
        hardware.bind()
        self.control.bind()
        dt, acting, past, pulse = self.settings.control_dt, memory.acting, memory.past, self._pushes
        self.plant.take(acting[TAU_M], acting[TAU_EXT])
        command = signals.tau_c, self.torque_limit, self._compensates
        self._torques = bound(torques, self.ticks, dt, pulse.time, pulse.duration, pulse.torque, *command, acting)
        clock, nominal = (self.ticks, dt, signals.time), (signals.theta_n, signals.theta_n_dot, hardware.motor_inertia)
        acted = acting, (self.plant.tau_f, self.plant.motor_torque), self._period, self.settings.decimation, past
        moved = clock, nominal, signals.tau_c, signals.tau_j, *acted, self.plant.motion, self._box
        self._settles = [
            bound(settle, *moved, (self._where, self._others[k : k + 1]), *share)
            for k, share in enumerate(self.plant.threads.shares)
        ]
        self._close = bound(close, past[TAU_M], signals.tau_m, self.torque_limit, self.ticks, self.last_tick)

    @property
    def available(self) -> frozenset[str]:
        """Names of the signals that the sensors provide."""
        return self.memory.available

    @property
    def joint_info(self) -> JointInfo:
        """What a compensator may know; arrays are (num_envs, dof)."""
        return JointInfo(
            dof=self.dof,
            motor_inertia=self.hardware_model.motor_inertia.copy(),
            stiffness=np.array([scenario.believed.stiffness for scenario in self.scenarios]),
            torque_limit=np.broadcast_to(self.torque_limit, (self.num_envs, self.dof)).copy(),
            control_dt=self.settings.step_dt,
            identified=None if self.robot.identified is None else replace(self.robot.identified),  # a copy
        )

    def reset(self, ids: Ids, generators: Sequence[np.random.Generator], options: Options | None = None) -> None:
        """Start new episodes in the named environments, each drawn from its own generator; `limits` reads options."""
        variant = self.settings.variant
        scenarios = [draw_scenario(self.robot, self.task, variant, generator) for generator in generators]
        if options is not None:
            scenarios = [options.applied_to(scenario) for scenario in scenarios]
        for i, scenario in zip(ids, scenarios, strict=True):
            self._configure(int(i), scenario)
        self.plant.reset(ids, np.array([scenario.q_start for scenario in scenarios]))
        self.control.reset(ids, scenarios)
        self.ticks[ids] = 0
        held = self.hardware_model.begin(ids, *_drawn(scenarios))
        self.nominal_motor.reset(ids, *(reading[ids] for reading in self.memory.readings[:2]))
        self._update_control()
        signals = self.memory.signals
        if self.control.theta_d is not signals.theta_d or self.control.reference is not signals.reference:
            name = type(self.control).__name__
            raise TypeError(f"{name}.follow replaces theta_d or reference; write into the arrays that are there")
        self.memory.begin(ids, held)

    def _configure(self, i: int, scenario: Scenario) -> None:
        self.scenarios[i] = scenario
        self.plant.configure(
            np.array([i]), joints=scenario.joints, friction=scenario.friction, mass_scale=scenario.mass_scale
        )
        self._pushes.set(i, scenario.push)
        if self.hands is not None and scenario.hand is not None:
            self.hands.set(i, scenario.hand)

    def _update_control(self) -> None:
        """The reference and the controller at the current ticks."""
        signals = self.memory.signals
        nominal = self.settings.feedback == "nominal"
        motor = (signals.theta_n, signals.theta_n_dot) if nominal else (signals.theta, signals.theta_dot)
        self.control.follow(self.ticks, *motor, signals.tau_c)

    def step(self, action: Array) -> tuple[Array, NDArray[np.bool_], NDArray[np.bool_], dict[int, str]]:
        """Hold `action` (num_envs, dof) for `decimation` control ticks.

        Returns:
            reward (num_envs,); terminated; truncated; why the terminated ones ended, by environment.
        """
        hardware = self.hardware_model
        reasons: dict[int, str] = {}
        if self.hands is not None:
            self.hands.force[:] = 0.0
        for number in range(self.settings.decimation):
            self._act(action)
            hardware.step()
            self._period[0] = number
            self.plant.threads.run(self._settles)
            if any(self._others.tolist()):
                self._find_ends(reasons)
            hardware.look()
            self._update_control()
        reward, (terminated, truncated) = np.empty(self.num_envs), np.zeros((2, self.num_envs), dtype=bool)
        if reasons:
            terminated[list(reasons)] = True
        self._close(self.control.distance(self.plant, self._scale), terminated, reward, truncated)
        return reward, terminated, truncated, reasons

    def _act(self, action: Array) -> None:
        """The estimate that is compensated, and what motors, pushes and hands apply over the coming control period."""
        self._torques(action)
        if self.hands is not None:
            self.hands.act(self.ticks, self.plant.tau_ext)
        self.hardware_model.command(self.plant.tau_m)

    def _find_ends(self, reasons: dict[int, str]) -> None:
        """Note environments that left the joint range or the finite numbers; put the latter back where they were."""
        for i in np.flatnonzero(self._where == LOST):
            reasons.setdefault(int(i), NON_FINITE)
            self.plant.restore(int(i))
        for i in np.flatnonzero(self._where == OUTSIDE):
            reasons.setdefault(int(i), JOINT_LIMIT)

    def observation(self) -> Array:
        """What the joints measure and compute at the coming tick, (num_envs, memory.size); see Signals."""
        return self.memory.observation()

    def truth(self, rows: int | slice = _EVERYONE) -> dict[str, Array]:
        """Privileged truth for scoring and plotting, a copy: (num_envs, dof) each, or (dof,) of environment `rows`.

        theta, theta_dot, q, q_dot, z at the new tick, and what acted in the past step, see PastStep. Where a friction
        law has not one state a joint, z is (num_envs, dof, states). Where a hand guides the tool, f_hand, (num_envs,
        3), its mean force too.
        """
        truth = self.memory.truth(self.plant.motion, rows)
        if self.hands is not None:
            truth["f_hand"] = self.hands.force[rows].copy()
        return truth

    def get_state(self) -> SimulationState:
        """A copy of everything that the next step depends on, except the random generators."""
        nominal = self.nominal_motor
        return SimulationState(
            self._origin,
            self.plant.get_state(),
            tuple(self.scenarios),
            nominal.theta.copy(),
            nominal.theta_dot.copy(),
            self.ticks.copy(),
            self.memory.past_step(),
            self.hardware_model.get_state(),
            None if self.hands is None else self.hands.get_state(),
        )

    def set_state(self, state: SimulationState) -> None:
        """Continue from a copy of `state`, exactly.

        Raises:
            ValueError: the state is of another environment, or a field of it has another shape or kind of value;
                nothing has changed then.
        """
        instance("state", state, SimulationState)
        state.check(self._origin, self.limits, self.last_tick, hand=self.hands is not None)
        self.plant.check_state(state.plant)
        draws = {f"SimulationState.scenarios[{i}].hardware": each.hardware for i, each in enumerate(state.scenarios)}
        self.hardware_model.check_state(state.hardware, "SimulationState.hardware", draws)
        everyone = np.arange(self.num_envs)
        for i, scenario in enumerate(state.scenarios):
            self._configure(i, scenario)
        self.control.reset(everyone, state.scenarios)
        self.plant.set_state(state.plant)
        self.memory.set_past(state.past)
        self.memory.signals.time[:, 0] = state.ticks * self.settings.control_dt
        self.nominal_motor.reset(everyone, state.theta_n, state.theta_n_dot)
        self.ticks[:] = state.ticks
        self.hardware_model.set_state(state.hardware, *_drawn(state.scenarios))
        if self.hands is not None and state.hands is not None:
            self.hands.set_state(state.hands)
        self._update_control()


def _drawn(scenarios: Sequence[Scenario]) -> tuple[Array, list[HardwareDraw | None]]:
    """What the hardware needs to know of new episodes: B as it is believed, (n, dof), and what was drawn."""
    inertia = np.array([scenario.believed.motor_inertia for scenario in scenarios])
    return inertia, [scenario.hardware for scenario in scenarios]
