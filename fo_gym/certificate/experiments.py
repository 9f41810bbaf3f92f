"""The five LuGre experiments of Canudas de Wit et al. (1995) on the joint kernel alone: one motor of unit mass.

Every function takes the kernel's micro-step `physics_dt` [s] (None: the plant's default) and returns traces; friction
is written as the force F = -tau_f that opposes motion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.friction import FrictionLaw, LuGre
from fo_gym.friction.bristle import bristle_step
from fo_gym.friction.lugre import bristle_rate
from fo_gym.micro_steps import DEFAULT_PHYSICS_DT, micro_steps
from fo_gym.parameters import JOINT
from fo_gym.plant.kernel import MOTION
from fo_gym.plant.kernels import kernel_of

Array = NDArray[np.float64]

PAPER = {"sigma_0": 1e5, "sigma_1": 1e5**0.5, "sigma_2": 0.4, "f_c": 1.0, "f_s": 1.5, "v_s": 1e-3}
"""Friction of the 1995 paper [N, m, s], by the names of `LuGre`."""

SAMPLE = 1e-3
"""Period at which forces are held and traces are kept [s]."""

__all__ = [
    "PAPER",
    "Joint",
    "Lag",
    "Trace",
    "break_away",
    "frictional_lag",
    "full_triangle",
    "hunting",
    "presliding",
    "presliding_force",
    "stick_slip",
]


def full_triangle(dof: int) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Layout of a lower triangle without structural zeros, row by row, as `advance` takes it."""
    count = np.arange(1, dof + 1, dtype=np.int32)
    columns = np.concatenate([np.arange(n, dtype=np.int32) for n in count])
    return count, np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int32), columns


class Joint:
    """One motor on the kernel, with a link of `mass` behind a spring; without `stiffness` the motor is alone.

    Its state is read by the names q, q_dot, theta, theta_dot, and z where friction has one state; `states` are all.

    Args:
        mass: of the link [kg].
        friction: of the motor; None for LuGre with PAPER, and those of `parameters` that are its.
        parameters: of `FlexibleJoint`, by default a motor of 1 kg and no spring.
    """

    def __init__(self, mass: float = 1.0, friction: FrictionLaw | None = None, **parameters: float) -> None:
        if friction is None:
            friction = LuGre(**{name: parameters.pop(name, value) for name, value in PAPER.items()})
        values = {"stiffness": 0.0, "damping": 0.0, "motor_inertia": 1.0, **parameters}
        self.joints = np.array([[[values[name] for name in JOINT]]])
        self.friction = friction.packed(1)[None]
        self.inertia = np.array([[mass]])
        self.state = np.zeros((len(MOTION) + friction.states, 1, 1))
        self.states = self.state[len(MOTION) :, 0, 0]
        self._advance = kernel_of(friction)
        self._layout, self._tau_f = full_triangle(1), np.zeros((1, 1))

    def __getattr__(self, name: str) -> float:
        return float(self.state[(*MOTION, "z").index(name)].item())

    def put(self, **values: float) -> Joint:
        """Set parts of the state by name [m, m/s]; returns the joint itself."""
        for name, value in values.items():
            self.state[(*MOTION, "z").index(name)] = value
        return self

    def advance(self, tau_m: float = 0.0, steps: int = 1, h: float = DEFAULT_PHYSICS_DT, tau_ext: float = 0.0) -> float:
        """Take `steps` micro-steps of h seconds under held forces [N]; returns the mean tau_f over them [N]."""
        drive, push, nothing = np.array([[tau_m]]), np.array([[tau_ext]]), np.zeros((1, 1))
        torques, links = (drive, nothing, push), (nothing, nothing, self.inertia, nothing, nothing[0])
        motor = self.joints, self.friction, h, steps
        self._advance(self.state, torques, links, self._layout, *motor, self._tau_f, 0, 1)
        return float(self._tau_f.item())


@dataclass(frozen=True)
class Trace:
    """A motor in motion; every array has one value per sample.

    Attributes:
        time: end of the sample [s].
        position, velocity: of the motor, at that time [m], [m/s].
        force: that drives the motor, held over the sample [N].
        friction: F = -tau_f, mean over the sample [N].
    """

    time: Array
    position: Array
    velocity: Array
    force: Array
    friction: Array


@dataclass(frozen=True)
class Lag:
    """One period of friction at a prescribed velocity.

    Attributes:
        velocity: [m/s].
        friction: F = -tau_f [N].
    """

    velocity: Array
    friction: Array


def _trace(period: float, rows: Array) -> Trace:
    """Rows of position, velocity, force and friction, one for every sample of `period` seconds."""
    return Trace(np.asarray(period * np.arange(1, len(rows) + 1)), *rows.T)


def _record(joint: Joint, samples: int, physics_dt: float | None, force: Callable[[int], float]) -> Trace:
    """Drive a joint by the force of every sample."""
    steps = micro_steps(SAMPLE, physics_dt)
    rows = np.empty((samples, 4))
    for k in range(samples):
        drive = force(k)
        friction = -joint.advance(drive, steps, SAMPLE / steps)
        rows[k] = joint.theta, joint.theta_dot, drive, friction
    return _trace(SAMPLE, rows)


def presliding_force(t: float) -> float:
    """Force of the presliding experiment [N]: to 1.425 N in 10 s, 5 s held, down to the opposite, 5 s held."""
    return float(np.interp(t, [0.0, 10.0, 15.0, 35.0, 40.0], [0.0, 1.425, 1.425, -1.425, -1.425]))


def presliding(physics_dt: float | None = None) -> Trace:
    """The motor below break-away, there and back: 40 s of `presliding_force`."""
    return _record(Joint(), 40_000, physics_dt, lambda k: presliding_force((k + 0.5) * SAMPLE))


def frictional_lag(omega: float, physics_dt: float | None = None) -> Lag:
    """The last of four periods of v = 1e-3 (1.5 + cos(omega t)), omega in rad/s, one value per micro-step."""
    h = physics_dt or DEFAULT_PHYSICS_DT
    friction = LuGre(**PAPER)
    per_period = round(2 * np.pi / omega / h)
    velocity = 1e-3 * (1.5 + np.cos(2 * np.pi * (np.arange(4 * per_period) + 0.5) / per_period))
    z, force = 0.0, np.zeros_like(velocity)
    for k, v in enumerate(velocity):
        z, tau_f = bristle_step(z, v, bristle_rate(v, friction), h, friction)
        force[k] = -tau_f
    return Lag(velocity[-per_period:], force[-per_period:])


def break_away(rate: float, physics_dt: float | None = None) -> Trace:
    """A force that rises at `rate` [N/s] until the motor passes 2 v_s; one sample per micro-step."""
    h = physics_dt or DEFAULT_PHYSICS_DT
    joint = Joint()
    rows: list[tuple[float, float, float, float]] = []
    while joint.theta_dot < 2 * PAPER["v_s"]:
        force = rate * (len(rows) + 0.5) * h
        friction = -joint.advance(force, h=h)
        rows.append((joint.theta, joint.theta_dot, force, friction))
    return _trace(h, np.array(rows))


def stick_slip(physics_dt: float | None = None) -> Trace:
    """34 s of the motor pulled over a spring of 2 N/m whose far end moves at 0.1 m/s."""
    joint = Joint(stiffness=2.0, mass=1e15).put(q_dot=0.1)  # the far end is a link too heavy to notice the motor
    trace = _record(joint, 34_000, physics_dt, lambda _: 0.0)
    return Trace(trace.time, trace.position, trace.velocity, 2.0 * (0.1 * trace.time - trace.position), trace.friction)


def hunting(physics_dt: float | None = None) -> Trace:
    """120 s of PID position control to x = 1 m: K_v = 6 N s/m, K_p = 3 N/m, K_i = 4 N/(m s)."""
    joint, integral = Joint(), 0.0

    def force(_: int) -> float:
        nonlocal integral
        error = joint.theta - 1.0
        drive = -6.0 * joint.theta_dot - 3.0 * error - 4.0 * integral
        integral += SAMPLE * error
        return drive

    return _record(joint, 120_000, physics_dt, force)
