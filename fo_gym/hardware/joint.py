"""What imperfect joints do to commands, torques and friction, for a batch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fo_gym.hardware.draw import HardwareDraw
from fo_gym.hardware.effects import Hardware

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

__all__ = ["Imperfections"]


class Imperfections:
    """The effects of a batch of joints beyond their sensors.

    Args:
        hardware: which effects there are.
        num_envs, dof: size of the batch.
        control_dt: control period [s].
        torque_limit: of the joints, (dof,) [N | N m].
    """

    def __init__(self, hardware: Hardware, num_envs: int, dof: int, control_dt: float, torque_limit: Array) -> None:
        self.hardware = hardware
        self._dt = control_dt
        share = np.inf if hardware.saturation is None else hardware.saturation.share
        self._limit = share * torque_limit
        ticks = 0 if hardware.delay is None else hardware.delay.ticks(control_dt)
        shape = (num_envs, dof)
        self.queue = np.zeros((ticks, *shape))
        """Commands on their way to the motors, the next one first, (ticks, num_envs, dof)."""
        self._phase, self._temperature = np.zeros(shape), np.zeros(shape)

    def reset(self, ids: Ids, held: Array, draws: Sequence[HardwareDraw]) -> None:
        """New episodes in the named environments, whose motors have been holding `held` (n, dof)."""
        self.queue[:, ids] = held
        self._phase[ids] = [draw.ripple_phase for draw in draws]
        self._temperature[ids] = [draw.temperature for draw in draws]

    def command(self, tau_m: Array) -> Array:
        """What the motors make of this tick's command, (num_envs, dof): late, and within their limits."""
        if len(self.queue):
            late = self.queue[0].copy()
            self.queue[:-1] = self.queue[1:]
            self.queue[-1] = tau_m
            tau_m = late
        return np.clip(tau_m, -self._limit, self._limit)

    def motor_torque(self, theta: Array) -> Array | float:
        """Disturbance on the motors at theta, (num_envs, dof): the gear's ripple."""
        ripple = self.hardware.ripple
        if ripple is None:
            return 0.0
        return ripple.amplitude * np.sin((2.0 * np.pi / np.asarray(ripple.period)) * theta + self._phase)

    def link_damping(self, q_dot: Array) -> Array | float:
        """Friction of the links' bearings at q_dot over q_dot itself, (num_envs, dof): the damper that it is there.

        A damper, which the plant's step takes implicitly, only takes energy. A torque held for a control period feeds
        a light link instead, whose velocity changes its sign within one.
        """
        friction = self.hardware.link_friction
        if friction is None:
            return 0.0
        speed = q_dot / friction.width
        share = np.divide(np.tanh(speed), speed, out=np.ones_like(speed), where=speed != 0.0)
        return friction.coulomb / friction.width * share + friction.viscous

    def friction(self, ticks: NDArray[np.int64], tau_j: Array) -> tuple[Array | float, Array | float, Array | float]:
        """How load and temperature change the friction at these ticks.

        Returns:
            Factor on f_c and f_s, what is added to both [N | N m], factor on sigma_2; (num_envs, dof) each, or numbers.
        """
        load, warm = self.hardware.load, self.hardware.temperature
        added = 0.0 if load is None else load.gain * np.abs(tau_j)
        if warm is None:
            return 1.0, added, 1.0
        rise = warm.rise * -np.expm1(-(ticks * self._dt) / warm.time)
        temperature = self._temperature + rise[:, None]
        return np.exp(-warm.dry * temperature), added, np.exp(-warm.viscous * temperature)
