"""Traces as scripts: a page that is opened from a folder may load scripts, and nothing else."""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.evaluation.episode.trace import DIAGNOSTIC, Trace

_LEVELS = 65_534
"""Steps of a column between its least and its largest value; the number above them stands for a gap."""
_TICK = 1e-5
"""Times are whole numbers of this [s]."""

__all__ = ["packed", "script", "trace_script"]


def packed(values: NDArray[np.float32]) -> dict[str, Any]:
    """A column in two bytes a value.

    Args:
        values: (n,).

    Returns:
        low and step in the column's unit, and data: base64 of unsigned 16-bit numbers k, little-endian, each meaning
        low + k step; the largest k means that there is no finite value. "" where all values are low.
    """
    numbers = np.asarray(values, dtype=np.float64)
    finite = np.isfinite(numbers)
    low = float(np.min(numbers, where=finite, initial=np.inf)) if finite.any() else 0.0
    high = float(np.max(numbers, where=finite, initial=-np.inf)) if finite.any() else 0.0
    step = (high - low) / _LEVELS
    if finite.all() and step == 0.0:
        return {"low": float(f"{low:.9g}"), "step": 0.0, "data": ""}
    levels = np.full(len(numbers), _LEVELS + 1, dtype="<u2")
    levels[finite] = np.round((numbers[finite] - low) / step) if step > 0.0 else 0
    data = base64.b64encode(levels.tobytes()).decode("ascii")
    return {"low": float(f"{low:.9g}"), "step": float(f"{step:.9g}"), "data": data}


def script(call: str, *arguments: Any) -> str:
    """A script that hands its arguments to a function of the page."""
    return f"{call}({','.join(_json(each) for each in arguments)});\n"


def _json(value: Any) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False, ensure_ascii=True)


def trace_script(key: str, trace: Trace) -> str:
    """The script of a trace: what `fg.trace(key, {...})` is given.

    `error` and `away` are differences to the friction-free episode, packed on their own so that they stay exact where
    they are small; of a tool, x and y are the two directions in which its reference moves most.

    Args:
        key: by which the page asks for it.
        trace: one episode.
    """
    signals = trace.signals
    ticks = np.round(np.asarray(signals["time"], dtype=np.float64) / _TICK).astype(np.int64)
    told: dict[str, Any] = {
        "name": trace.compensator,
        "seed": str(trace.seed),
        "frr": float(f"{trace.frr:.6g}"),
        "tick": _TICK,
        "ticks": np.diff(ticks, prepend=0).tolist(),
        "theta": _columns(signals["theta"]),
        "error": _columns(signals["theta"] - signals["theta_ideal"]),
        "target": _columns(signals["theta_d"]),
        "tau_f": _columns(signals["tau_f"]),
        "tau_f_hat": _columns(signals["tau_f_hat"]),
    }
    own = {name.removeprefix(DIAGNOSTIC): _columns(signals[name]) for name in signals if name.startswith(DIAGNOSTIC)}
    if own:
        told["diagnostics"] = own
    if "tool" in signals:
        plane = np.sort(np.argsort(np.ptp(signals["tool_d"], axis=0), kind="stable")[1:])
        told["axes"] = "".join("xyz"[axis] for axis in plane)
        for name, signal in (("tool", "tool"), ("tool_ideal", "tool_ideal"), ("tool_target", "tool_d")):
            told[name] = _columns(signals[signal][:, plane])
        told["away"] = packed(np.linalg.norm(signals["tool"] - signals["tool_ideal"], axis=1))
    return script("fg.trace", key, told)


def _columns(values: NDArray[np.float32]) -> list[dict[str, Any]]:
    return [packed(column) for column in values.T]
