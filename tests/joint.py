"""One flexible joint on the kernel alone, for the tests of the kernel."""

from __future__ import annotations

import numpy as np

from fo_gym.plant.kernel import PARAMETERS, STATE, advance

PAPER = {"sigma_0": 1e5, "sigma_1": 1e5**0.5, "sigma_2": 0.4, "f_c": 1.0, "f_s": 1.5, "v_s": 1e-3}
NO_FRICTION = {"sigma_0": 0.0, "sigma_1": 0.0, "sigma_2": 0.0, "f_c": 0.0, "f_s": 0.0, "v_s": 1.0}
H = 2e-4
"""The plant's default micro-step, s."""


def full_triangle(dof: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Layout of a lower triangle without structural zeros, row by row."""
    count = np.arange(1, dof + 1, dtype=np.int32)
    columns = np.concatenate([np.arange(n, dtype=np.int32) for n in count])
    return count, np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int32), columns


class Joint:
    """One motor on the kernel, with a link of `mass` behind a spring (by default there is no spring)."""

    def __init__(self, mass: float = 1.0, **parameters: float) -> None:
        values = {"stiffness": 0.0, "damping": 0.0, "motor_inertia": 1.0, **PAPER, **parameters}
        self.parameters = np.array([[[values[name] for name in PARAMETERS]]])
        self.inertia = np.array([[mass]])
        self.state = np.zeros((len(STATE), 1, 1))
        self._layout, self._tau_f = full_triangle(1), np.zeros((1, 1))

    def __getattr__(self, name: str) -> float:
        return self.state[STATE.index(name)].item()

    def put(self, **values: float) -> Joint:
        for name, value in values.items():
            self.state[STATE.index(name)] = value
        return self

    def advance(self, tau_m: float = 0.0, steps: int = 1, h: float = H, tau_ext: float = 0.0) -> float:
        """Mean friction torque over the steps."""
        drive, load = np.array([[tau_m]]), np.array([[tau_ext]])
        advance(self.state, drive, load, self.inertia, *self._layout, self.parameters, h, steps, self._tau_f)
        return self._tau_f.item()
