"""Maps: a metric over two parameters, from CSV files with the columns x, y and value."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from fo_gym.files import read_csv

FOLDER = "maps"
"""Where they are looked for, beside the tables."""

__all__ = ["FOLDER", "Map", "maps_in"]


@dataclass(frozen=True)
class Map:
    """A metric over two parameters.

    Attributes:
        name: of its file.
        x_name, y_name, value_name: what stands on the axes and in the field.
        x, y: the values of the parameters, ascending.
        values: (len(y), len(x)), None where there is none.
    """

    name: str
    x_name: str
    y_name: str
    value_name: str
    x: list[float]
    y: list[float]
    values: list[list[float | None]]


def maps_in(folder: Path) -> list[Map]:
    """The maps in a folder, by the name of their file; none without the folder.

    A file has three columns, one row per point: two parameters, then the metric, under their names.

    Raises:
        ValueError: a file has other columns, or a point twice.
    """
    return [_read(path) for path in sorted(folder.glob("*.csv"))]


def _read(path: Path) -> Map:
    table = read_csv(path.read_text(encoding="utf-8"))
    if len(table.columns) != 3:
        raise ValueError(f"{path} has the columns {', '.join(map(str, table))}; a map has three: x, y and the value")
    x_name, y_name, value_name = map(str, table.columns)
    if table.duplicated([x_name, y_name]).any():
        raise ValueError(f"{path} has a point of {x_name} and {y_name} twice; each may be there once")
    grid: pd.DataFrame = table.pivot(index=y_name, columns=x_name, values=value_name)
    numbers = grid.to_numpy(dtype=np.float64)
    return Map(
        path.stem,
        x_name,
        y_name,
        value_name,
        [float(x) for x in grid.columns],
        [float(y) for y in grid.index],
        [[float(value) if np.isfinite(value) else None for value in row] for row in numbers],
    )
