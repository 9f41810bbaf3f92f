"""Episodes whose signals are known in closed form, for the tests of the metrics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fo_gym.evaluation.episode.record import Episode, Motion, Push

DT = 1e-3
TIME = np.arange(20_001) * DT
PERIODS = TIME[:-1]
OVER_TICKS = ("theta_dot", "q", "q_dot", "theta_n", "theta_n_dot", "theta_d")
OVER_PERIODS = ("tau_f_hat", "tau_f", "tau_dist", "tau_m", "tau_ext")
JOINT_SIGNALS = (*OVER_TICKS, *OVER_PERIODS)
ABSENT = dict.fromkeys(("tool_d", "step_time", "limit_cycle_window", "motion_window", "push", "hand", "damped"))
FIXED = {"torque_limit": np.full(2, 10.0), "joint_unit": "rad", "termination": "", "stored": math.nan}


def over(length: int, size: int, value: Any) -> np.ndarray:
    """A number, (length,), (size,) or (length, size) as a signal (length, size)."""
    value = np.asarray(value, dtype=float)
    return np.broadcast_to(value[:, None] if value.shape == (length,) else value, (length, size))


def motion(theta: Any, tool: Any, f_hand: Any = None, lost: Any = None) -> Motion:
    return Motion(over(len(TIME), 2, theta), None if tool is None else over(len(TIME), 3, tool), f_hand, lost)


def episode(*, theta: Any = 0.0, ideal: Any = 0.0, none: Any = 0.0, tool: Any = None, **changes: Any) -> Episode:
    """20 s of two joints at rest of which only the given parts differ; the tools of the references are at 0.

    `pulls` are the forces of the hand, `losses` what friction takes: of the arm, the ideal one, and that without
    compensation.
    """
    fields: dict[str, Any] = {**ABSENT, **FIXED, **dict.fromkeys(JOINT_SIGNALS, 0.0), **changes}
    fields |= {name: over(len(TIME), 2, fields[name]) for name in OVER_TICKS}
    fields |= {name: over(len(PERIODS), 2, fields[name]) for name in OVER_PERIODS}
    tools = [None if tool is None else fields.pop(name, 0.0) for name in ("tool_ideal", "tool_none")]
    guided = [*zip(*(fields.pop(name, (None, None, None)) for name in ("pulls", "losses")), strict=True)]
    references = {"ideal": motion(ideal, tools[0], *guided[1]), "none": motion(none, tools[1], *guided[2])}
    return Episode(DT, motion=motion(theta, tool, *guided[0]), **references, **fields)


def columns(*joints: Any) -> np.ndarray:
    return np.stack(np.broadcast_arrays(*joints), axis=-1)


def stick_slip(period: float) -> np.ndarray:
    """From 0 to 1 and back in pairs of slips, 0.3 s apart."""
    slips = np.repeat([0.0, 0.3, period / 2, period / 2 + 0.3], 2)
    return np.interp(TIME % period, slips, [0, 0.5, 0.5, 1, 1, 0.5, 0.5, 0])


def friction(delay: float = 0.0) -> np.ndarray:
    """A burst of friction around 4 s and a reversal at 8 s, both smooth, `delay` late."""
    late = PERIODS - delay
    return np.exp(-(((late - 4.0) / 0.2) ** 2)) + np.tanh((late - 8.0) / 0.05)


def line(lag: Any = 0.0, offset: Any = 0.0) -> np.ndarray:
    """A tool on a line along x at 0.1 m/s, at rest after 10 s, `lag` behind and `offset` beside its path [m]."""
    return columns(0.1 * np.minimum(TIME, 10.0) - lag, offset, 0.0)


def observer(*tau_f_hat: float) -> dict[str, Any]:
    """Joints stuck from 1 to 1.5 s and sliding otherwise, while e grows by 0.1 per s all the time."""
    stuck = (TIME > 0.9995) & (TIME < 1.5005)
    return {"theta": TIME, "theta_n": 1.1 * TIME, "theta_dot": np.where(stuck, 0.0, 1.0), "tau_f_hat": tau_f_hat}


def bursts(speed: float, *starts: float) -> np.ndarray:
    """At rest, but for 10 ms of `speed` from each of the starts [s]."""
    return speed * sum((np.abs(TIME - start - 0.0049) < 0.005).astype(float) for start in starts)


def rowing(share: float) -> dict[str, Any]:
    """To and fro against a friction of 2, of which the estimate takes a share."""
    direction = np.where(np.arange(len(PERIODS)) // 100 % 2, -1.0, 1.0)
    theta = np.concatenate([[0.0], np.cumsum(1e-3 * direction)])
    return {"theta": theta, "tau_dist": -2.0 * direction, "tau_f_hat": -2.0 * share * direction}


FLIP = np.where(np.arange(len(PERIODS)) % 2, -1.0, 1.0)
RING = np.exp(-0.4 * TIME) * np.cos(5.0 * TIME)
RIPPLE = 0.1 * np.sin(20 * np.pi * TIME)
REST = {"theta": 0.5 + columns(np.where(TIME < 13.0005, 0.002, 0.007), -0.003), "theta_d": 0.5}
PUSH = Push(13.0, 0.5, np.array([10.0, 0.0]))
WINDOW = {"limit_cycle_window": (10.0, 20.0)}
SLIDE = {"ideal": TIME, **WINDOW}
STEP = {"step_time": 3.0, "theta_d": columns(np.where(TIME < 2.9995, 0.0, -0.1), 0.0)}
RISE = columns(np.where(TIME < 3.0, 0.0, -0.1 * (1 - np.exp(-(TIME - 3.0) / 0.5))), 0.0)
SETTLED = math.ceil(0.5 * math.log(50) / DT) * DT
UNDERDAMPED = np.exp(-0.6 * TIME) * (np.cos(0.8 * TIME) + 0.75 * np.sin(0.8 * TIME))  # 1 / (s^2 + 1.2 s + 1)
PATH = {"motion_window": (0.0, 10.0), "tool_d": line()}
BESIDE = 2e-3 * (np.abs(TIME - 4.05) < 0.04) + 5e-3 * (np.abs(TIME - 7.0) < 0.5)
GLITCH = {"tool": line(0.0, BESIDE), "tool_ideal": line(), **PATH, "motion_window": (1.0, 10.0)}
ROUND = columns(np.cos(0.6 * TIME), np.sin(0.6 * TIME), 0.0)
CORNERS = 0.1 * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])[np.minimum(TIME // 2, 3).astype(int)]
PUSHED = {"push": Push(1.0, 1.0, np.ones(2)), "tau_ext": columns(2.0 * (np.abs(PERIODS - 1.4999) < 0.5), 0.0)}
