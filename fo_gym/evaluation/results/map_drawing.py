"""What is drawn of a map: its axes, the metric, what is marked, and the numbers that become colours."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.metrics.hunting import HUNTING
from fo_gym.evaluation.metrics.registry import HEADLINE
from fo_gym.evaluation.runs.episodes import FAILED

Array = NDArray[np.float64]

HUNTING_COLUMN = "limit_cycle_peak_to_peak_ju"
MILLI = 1e3
_DECADES = 4.0
"""Decades below the largest value that a logarithmic colour shows."""
_SYMBOLS = {
    "L": "$L$ [1/s]",
    "Lp": "$L_p$ [1/s]",
    "Li": "$L_i$ [1/s²]",
    "f_s/f_c": "$f_s/f_c$",
    "v_s": "$v_s$ [{unit}/s]",
}

__all__ = ["HUNTING_COLUMN", "MILLI", "Drawing", "Layer", "Marks", "is_logarithmic", "layer_of", "symbol", "unit_of"]


@dataclass(frozen=True)
class Marks:
    """What is marked on a map.

    Attributes:
        points: places (x, y) by their names.
        line: a curve of points (n, 2), or None.
        line_name: what that is.
    """

    points: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    line: Array | None = None
    line_name: str = ""


@dataclass(frozen=True)
class Drawing:
    """What is drawn of the rows of a map, as map.json beside map.csv keeps it.

    Attributes:
        x, y: names of the two parameters, columns of the rows.
        metric: column of the metric.
        marks: what is marked.
    """

    x: str
    y: str
    metric: str
    marks: Marks = Marks()

    def text(self) -> str:
        """As JSON, numbers with six digits, as CSV files have them."""
        line = [] if self.marks.line is None else self.marks.line.tolist()
        told = {
            "x": self.x,
            "y": self.y,
            "metric": self.metric,
            "points": {name: _rounded(place) for name, place in self.marks.points.items()},
            "line": [_rounded(place) for place in line],
            "line_name": self.marks.line_name,
        }
        return json.dumps(told, indent=1) + "\n"

    @classmethod
    def read(cls, path: Path) -> Drawing:
        """What `text` wrote. Raises ValueError where it is something else."""
        try:
            told = json.loads(path.read_text(encoding="utf-8"))
            points = {str(name): (float(x), float(y)) for name, (x, y) in told["points"].items()}
            line = np.array(told["line"], dtype=np.float64).reshape(-1, 2)
            marks = Marks(points, line if len(line) else None, str(told["line_name"]))
            return cls(str(told["x"]), str(told["y"]), str(told["metric"]), marks)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise ValueError(
                f"{path} does not say what is drawn ({type(error).__name__}: {error}); write it again with `fo-gym map`"
            ) from error


def _rounded(numbers: Any) -> list[float]:
    return [float(f"{number:.6g}") for number in numbers]


@dataclass(frozen=True)
class Layer:
    """A metric over the plane of a map, as it is coloured.

    Attributes:
        values: (len(y), len(x)), in the unit of `title`; NaN where there is none.
        title: what it is, with its unit.
        low, high: ends of the colours; both 0 where the colours are linear, from the least to the largest value.
        rest: whether what lies below `low` is at rest, and grey.
    """

    values: Array
    title: str
    low: float = 0.0
    high: float = 0.0
    rest: bool = False

    @property
    def logarithmic(self) -> bool:
        """Whether the colours are."""
        return self.high > 0.0


def layer_of(table: pd.DataFrame, drawing: Drawing, metric: str) -> tuple[Layer, NDArray[np.bool_]]:
    """A metric of a map, and which cells (len(y), len(x)) were refused or failed.

    Limit cycles are coloured above what counts as hunting; of the friction rejection ratio, what is missing to 1.

    Args:
        table: as `map_table` gives it.
        drawing: its axes.
        metric: column of the metric.

    Raises:
        ValueError: a cell is there twice.
    """
    shown = table.assign(failed=table["status"] == FAILED).pivot(
        index=drawing.y, columns=drawing.x, values=[metric, "failed"]
    )
    values = shown[metric].to_numpy(dtype=np.float64)
    values, title = _told(values, metric, unit_of(table))
    return Layer(values, title, *_colours(values, metric)), shown["failed"].eq(True).to_numpy()


def _told(values: Array, metric: str, joint_unit: str) -> tuple[Array, str]:
    """What is coloured, and what it is called."""
    if metric == HEADLINE:
        return 1.0 - values, "1 - FRR, what is left of friction's effect"
    if metric == HUNTING_COLUMN:
        return MILLI * values, f"limit cycle, peak to peak [m{joint_unit}]"
    if METRICS[metric].unit == "ju":
        return MILLI * values, f"{metric.removesuffix('_ju').replace('_', ' ')} [m{joint_unit}]"
    return values, metric.replace("_", " ")


def _colours(values: Array, metric: str) -> tuple[float, float, bool]:
    """The attributes low, high and rest of a layer: logarithmic where nothing is below 0."""
    finite = values[np.isfinite(values)]
    high = float(np.max(finite, initial=0.0))
    if metric == HUNTING_COLUMN:
        return MILLI * HUNTING, max(high, 10.0 * MILLI * HUNTING), True
    if high > 0.0 and (finite >= 0.0).all():
        low = max(float(np.min(finite[finite > 0.0], initial=high)), high * 10.0**-_DECADES)
        return min(low, 0.999 * high), high, False
    return 0.0, 0.0, False


def unit_of(table: pd.DataFrame) -> str:
    """The unit of the joints, "m" or "rad"; "" where every cell failed."""
    return max((unit for unit in table["joint_unit"].dropna()), default="")


def symbol(name: str, joint_unit: str) -> str | None:
    """A parameter as an axis tells it, in TeX's mathematics, with its unit; None where it has no symbol."""
    told = _SYMBOLS.get(name)
    return None if told is None else told.replace("{unit}", joint_unit)


def is_logarithmic(values: Array) -> bool:
    """Whether an axis is: its values are above 0 and reach far."""
    return bool(values[0] > 0.0 and values[-1] > 4.0 * values[0])
