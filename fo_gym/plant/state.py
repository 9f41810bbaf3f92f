"""The full state of a plant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, real_array, shown
from fo_gym.plant.kernel import MOTION

Array = NDArray[np.float64]

__all__ = ["PlantState"]


@dataclass
class PlantState:
    """The full state of a plant, friction's included.

    Attributes:
        q, q_dot: links, (num_envs, dof), m and m/s | rad and rad/s.
        theta, theta_dot: motors, (num_envs, dof), m and m/s | rad and rad/s.
        z: states of friction, (num_envs, dof) where its law has one, else (num_envs, dof, states).
        q_dot_before: link velocities one control period ago, (num_envs, dof), m/s | rad/s.
        time: (num_envs,), s.
    """

    q: Array
    q_dot: Array
    theta: Array
    theta_dot: Array
    z: Array
    q_dot_before: Array
    time: Array

    def check(self, shape: tuple[int, ...], states: tuple[int, ...], control_dt: float) -> None:
        """Whether it is one of a plant.

        Args:
            shape: of the motion, (num_envs, dof).
            states: shape of friction's states.
            control_dt: control period [s].

        Raises:
            ValueError: it is none, and the message names the field.
        """
        for name in (*MOTION, "q_dot_before"):
            real_array(f"PlantState.{name}", getattr(self, name), shape)
        real_array("PlantState.z", self.z, states)
        time = real_array("PlantState.time", self.time, shape[:1], NOT_NEGATIVE)
        if not np.allclose(np.rint(time / control_dt) * control_dt, time, rtol=1e-9, atol=1e-9):
            raise ValueError(
                f"PlantState.time is {shown(time)} s; these are no whole control periods of {control_dt:g} s: "
                "make the plant with the control_dt of the one that gave the state"
            )
