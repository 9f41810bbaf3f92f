"""A single link whose motor rubs by any friction law, by the law's own equations, solved by SciPy.

Where a law switches between equations, the solver stops at the very moment (`FrictionLaw.events`) and goes on with the
states as they are from then on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from fo_gym.certificate.oracle import Control
from fo_gym.friction import FrictionLaw
from fo_gym.parameters import FlexibleJoint

Array = NDArray[np.float64]

RTOL, ATOL = 1e-10, 1e-13

_ASIDE = 1e-15
"""Velocity with which a motor that comes to rest goes on to the other side [m/s]: the sign is what matters."""

_MOST_EVENTS = 1000

__all__ = ["LawLink", "law_motion"]


@dataclass(frozen=True)
class LawLink:
    """A link of inertia `mass` without gravity behind one flexible joint, numbers for arrays.

    The state is one vector: q, q', theta, theta' and the law's states.
    """

    joint: FlexibleJoint
    law: FrictionLaw
    mass: float = 1.0

    def rates(self, _: float, x: Array, tau_m: float, tau_ext: float) -> Array:
        """Rates of the state under held torques."""
        joint: Any = self.joint
        q, w, theta, v = x[:4]
        z_rate, tau_f = self.law.equations(float(v), x[4:])
        tau_j = joint.stiffness * (theta - q) + joint.damping * (v - w)
        motion = w, (tau_j + tau_ext) / self.mass, v, (tau_m + tau_f - tau_j) / joint.motor_inertia
        return np.concatenate([motion, z_rate])

    def advanced(self, x: Array, held: tuple[float, float], dt: float) -> Array:
        """The state dt seconds on, under held torques; raises RuntimeError where the solver gives up."""
        law, t = self.law, 0.0
        watches = [_watch(law, i) for i in range(len(law.events(float(x[3]), x[4:])))]
        x = np.concatenate([x[:4], law.switched(float(x[3]), x[4:])])
        for _ in range(_MOST_EVENTS):
            run: Any = solve_ivp(
                self.rates, (t, dt), x, method="LSODA", args=held, rtol=RTOL, atol=ATOL, events=watches or None
            )
            x, t, before = run.y[:, -1].copy(), run.t[-1], run.y[3, -2]
            if run.status == 0:
                return np.asarray(x)
            if run.status < 0:
                break
            if watches and run.t_events[0].size and abs(x[3]) < 1e-9 and before != 0.0:
                x[3] = -np.sign(before) * _ASIDE
            x[4:] = law.switched(float(x[3]), x[4:])
            if dt - t < 1e-15:
                return np.asarray(x)
        raise RuntimeError(f"{type(law).__name__}: {run.message}")


def _watch(law: FrictionLaw, i: int) -> Any:
    """The i-th event of a law as SciPy watches for it."""

    def event(_: float, x: Array, *held: float) -> float:
        return float(law.events(float(x[3]), x[4:])[i])

    event.terminal = True  # type: ignore[attr-defined]
    return event


def law_motion(link: LawLink, control: Control, tau_ext: Array) -> Array:
    """Link and motor at the ticks, (periods, 2), from rest under sampled control; both torques are held."""
    x, history = np.zeros(4 + link.law.states), np.empty((len(tau_ext), 2))
    joint: Any = link.joint
    for k, push in enumerate(tau_ext):
        tau_j = joint.stiffness * (x[2] - x[0]) + joint.damping * (x[3] - x[1])
        tau_m = float(control(x[2], x[3], tau_j))
        x = link.advanced(x, (tau_m, float(push)), control.dt)
        history[k] = x[0], x[2]
    return history
