"""The hardware around the plants of a batch: what a controller measures, and what joints make of a command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import instance, real_array
from fo_gym.hardware.draw import HardwareDraw
from fo_gym.hardware.effects import Hardware
from fo_gym.hardware.joint import Imperfections
from fo_gym.hardware.sensing import Sensing
from fo_gym.plant import FlexibleJointPlant

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

__all__ = ["HardwareModel", "HardwareState"]


@dataclass(frozen=True)
class HardwareState:
    """What sensors and commands remember.

    Attributes:
        sensing: as `Sensing.get_state` gives it.
        commands: on their way to the motors, (ticks, num_envs, dof).
    """

    sensing: dict[str, Any]
    commands: Array


class HardwareModel:
    """A plant with its hardware's effects; without effects it measures the truth and does as it is told.

    Args:
        plant: the joints.
        effects: the hardware's, or None.
        torque_limit: of the joints, (dof,).
        tachometer: whether the motor's velocity is measured, and not a difference of positions.

    Attributes:
        theta, theta_dot, tau_j: as measured at the last look, (num_envs, dof).
        motor_inertia: B as controller, nominal motor and compensator know it, (num_envs, dof).
    """

    def __init__(
        self, plant: FlexibleJointPlant, effects: Hardware | None, torque_limit: Array, *, tachometer: bool
    ) -> None:
        self.plant = plant
        self.theta, self.theta_dot, self.tau_j = plant.theta, plant.theta_dot, plant.tau_j
        self.motor_inertia = plant.motor_inertia.copy()
        self._sensing: Sensing | None = None
        self._joint: Imperfections | None = None
        if effects is not None:
            effects.check_joints(plant.dof)
            size = plant.num_envs, plant.dof, plant.control_dt
            self._sensing = Sensing(effects.sensors, *size, tachometer=tachometer)
            self._joint = Imperfections(effects, *size, torque_limit)

    def begin(self, ids: Ids, motor_inertia: Array, draws: Sequence[HardwareDraw | None]) -> Array:
        """Start the named environments at rest; returns their true tau_j, (n, dof).

        Args:
            ids: which environments.
            motor_inertia: B as it is believed, (n, dof).
            draws: what was drawn of the effects; None where there are none.
        """
        self.motor_inertia[ids] = motor_inertia
        held = self.plant.tau_j[ids]
        if self._sensing is not None and self._joint is not None:
            drawn = [draw for draw in draws if draw is not None]
            self._sensing.reset(ids, self.plant.theta[ids], held, drawn)
            self._joint.reset(ids, held, drawn)
        self._read()
        return held

    def look(self) -> None:
        """Sample the sensors, once per tick: every look takes new noise."""
        if self._sensing is not None:
            self._sensing.sample(self.plant.theta, self.plant.theta_dot, self.plant.tau_j)
        self._read()

    def _read(self) -> None:
        if self._sensing is None:
            self.theta, self.theta_dot, self.tau_j = self.plant.theta, self.plant.theta_dot, self.plant.tau_j
        else:
            self.theta, self.theta_dot, self.tau_j = self._sensing.theta, self._sensing.theta_dot, self._sensing.tau_j

    def command(self, tau_m: Array) -> Array:
        """The torque that the motors give for this tick's command, (num_envs, dof)."""
        return tau_m if self._joint is None else self._joint.command(tau_m)

    def step(self, tau_m: Array, tau_ext: Array, ticks: NDArray[np.int64]) -> None:
        """Advance one control period under the motors' torque and the push, with what gears and bearings add."""
        plant, joint = self.plant, self._joint
        if joint is not None:
            plant.vary_friction(*joint.friction(ticks, plant.tau_j))
            plant.link_damping[:] = joint.link_damping(plant.q_dot)
            tau_m = tau_m + joint.motor_torque(plant.theta)
        plant.step(tau_m, tau_ext)

    def get_state(self) -> HardwareState | None:
        """A copy of what sensors and commands remember; None where there are no effects."""
        if self._sensing is None or self._joint is None:
            return None
        return HardwareState(self._sensing.get_state(), self._joint.queue.copy())

    def check_state(self, state: HardwareState | None) -> None:
        """Raise ValueError where `state` is none of this hardware, naming the field."""
        if self._sensing is None or self._joint is None:
            if state is not None:
                raise ValueError("SimulationState.hardware is of a robot with hardware effects; this one has none")
            return
        instance("SimulationState.hardware", state, HardwareState)
        assert state is not None
        self._sensing.check_state(state.sensing)
        real_array("HardwareState.commands", state.commands, self._joint.queue.shape)

    def set_state(
        self, state: HardwareState | None, motor_inertia: Array, draws: Sequence[HardwareDraw | None]
    ) -> None:
        """Continue from a copy of `state`, exactly, in the episodes of these draws; see `begin`."""
        self.begin(np.arange(self.plant.num_envs), motor_inertia, draws)
        if state is not None and self._sensing is not None and self._joint is not None:
            self._sensing.set_state(state.sensing)
            self._joint.queue[:] = state.commands
        self._read()
