"""The sensors of a batch: sampled once per control tick, and the same at every look."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import real_array, shown
from fo_gym.generators import check_random_states, restored
from fo_gym.hardware.draw import HardwareDraw
from fo_gym.hardware.effects import MotorEncoder, SensorModel, TorqueSensor

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

_ARRAYS = ("theta", "theta_dot", "tau_j", "_filtered", "_offset")

__all__ = ["Sensing"]


def _weight(cutoff: Any, dt: float) -> Array:
    """Share of the new value that a first-order low-pass takes over per control period."""
    return np.asarray(-np.expm1(-np.asarray(cutoff, dtype=np.float64) * dt))


class Sensing:
    """Motor encoders and torque sensors of `num_envs` robots.

    Args:
        model: what the sensors make of the truth.
        num_envs, dof: size of the batch.
        dt: control period [s].
        tachometer: whether the velocity has a sensor of its own, and is exact.

    Attributes:
        theta, theta_dot, tau_j: as measured at the last sample, (num_envs, dof).
    """

    def __init__(self, model: SensorModel, num_envs: int, dof: int, dt: float, *, tachometer: bool) -> None:
        self.encoder = model.encoder or MotorEncoder(resolution=0.0)
        self.torque = model.torque or TorqueSensor(noise=0.0, offset=0.0)
        self._exact_velocity = tachometer or model.encoder is None
        self._dt = dt
        self._noisy = bool(np.any(np.asarray(self.torque.noise) > 0))
        self._velocity_weight, self._torque_weight = _weight(self.encoder.cutoff, dt), _weight(self.torque.cutoff, dt)
        shape = (num_envs, dof)
        self.theta, self.theta_dot, self.tau_j = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        self._filtered, self._offset = np.zeros(shape), np.zeros(shape)
        self._generators = [np.random.default_rng(0)] * num_envs

    def reset(self, ids: Ids, theta: Array, tau_j: Array, draws: Sequence[HardwareDraw]) -> None:
        """Begin at rest in the named environments, (n, dof) each."""
        for i, draw in zip(ids, draws, strict=True):
            self._generators[i] = np.random.default_rng(draw.noise_seed)
        self._offset[ids] = [draw.torque_offset for draw in draws]
        self.theta[ids] = self._steps(theta)
        self.theta_dot[ids] = 0.0
        self._filtered[ids] = tau_j
        self.tau_j[ids] = tau_j + self._offset[ids] + self._noise(ids)

    def sample(self, theta: Array, theta_dot: Array, tau_j: Array) -> None:
        """Measure at the coming tick, (num_envs, dof) each."""
        before, self.theta = self.theta, self._steps(theta)
        if self._exact_velocity:
            self.theta_dot = theta_dot.copy()
        else:
            difference = (self.theta - before) / self._dt
            self.theta_dot = self.theta_dot + self._velocity_weight * (difference - self.theta_dot)
        self._filtered = self._filtered + self._torque_weight * (tau_j - self._filtered)
        self.tau_j = self._filtered + self._offset + self._noise(range(len(theta)))

    def _steps(self, theta: Array) -> Array:
        step = np.broadcast_to(np.asarray(self.encoder.resolution, dtype=np.float64), theta.shape)
        return np.where(step > 0, np.rint(theta / np.where(step > 0, step, 1.0)) * step, theta)

    def _noise(self, ids: Any) -> Array | float:
        if not self._noisy:
            return 0.0
        dof = self.theta.shape[1]
        return self.torque.noise * np.array([self._generators[i].standard_normal(dof) for i in ids])

    def get_state(self) -> dict[str, Any]:
        """A copy of everything that the next sample depends on."""
        state: dict[str, Any] = {name: getattr(self, name).copy() for name in _ARRAYS}
        state["generators"] = [dict(generator.bit_generator.state) for generator in self._generators]
        return state

    def check_state(self, state: Mapping[str, Any]) -> None:
        """Raise ValueError where `state` is none of these sensors, naming the field."""
        names = {*_ARRAYS, "generators"}
        if not isinstance(state, Mapping) or set(state) != names:
            raise ValueError(f"state of the sensors is {shown(state)}; give a mapping with {', '.join(sorted(names))}")
        for name in _ARRAYS:
            real_array(f"state of the sensors, {name}", state[name], self.theta.shape)
        check_random_states("state of the sensors, generators", state["generators"], len(self._generators))

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Continue from a copy of `state`, exactly."""
        for name in _ARRAYS:
            setattr(self, name, np.array(state[name], dtype=np.float64))
        self._generators = restored(state["generators"])
