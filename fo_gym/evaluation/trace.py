"""Nominal episodes, thinned for the figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.evaluation.recording import Recording

Array = NDArray[np.float64]

_POINTS = 4000

__all__ = ["Trace", "trace_of"]


@dataclass(frozen=True)
class Trace:
    """A nominal episode, thinned for a figure.

    Attributes:
        env: environment id.
        compensator: name.
        joint_unit: "m" or "rad".
        time: (n,), s.
        error: theta - theta_d, (n, dof), m or rad.
        tool, tool_d: tool and its reference, (n, 3), m, or None.
    """

    env: str
    compensator: str
    joint_unit: str
    time: Array
    error: Array
    tool: Array | None
    tool_d: Array | None


def trace_of(env_id: str, name: str, recording: Recording) -> Trace:
    """The first episode of a recording."""
    ticks = {key: value[:, 0] for key, value in recording.ticks.items()}
    keep = slice(None, None, max(1, len(ticks["theta"]) // _POINTS))
    return Trace(
        env=env_id,
        compensator=name,
        joint_unit=recording.task.joint_unit,
        time=(np.arange(len(ticks["theta"]), dtype=np.float64) * recording.dt)[keep],
        error=(ticks["theta"] - ticks["theta_d"])[keep],
        tool=ticks["tool"][keep] if "tool" in ticks else None,
        tool_d=ticks["reference"][keep] if "tool" in ticks else None,
    )
