"""Maps: metrics over two parameters, from folders as `fo-gym map` writes them."""

from __future__ import annotations

import html
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from fo_gym.evaluation.results.map import SHORT_NAMES
from fo_gym.evaluation.results.map_drawing import Drawing, is_logarithmic, layer_of, symbol, unit_of
from fo_gym.evaluation.runs.episodes import place_of
from fo_gym.files import read_csv
from fo_gym.text import NAME_LIMIT, one_line

FOLDER = "maps"
"""Where they are looked for, beside the tables."""
TABLE, DRAWING = "map.csv", "map.json"
_DIGITS = 4
"""Of a colour; the table that can be downloaded has all of them."""

__all__ = ["DRAWING", "FOLDER", "TABLE", "Axis", "Layer", "Map", "Marks", "maps_in"]


@dataclass(frozen=True)
class Axis:
    """A parameter: its name, that with unit as markup, its values, ascending, and whether they are spaced evenly."""

    name: str
    title: str
    values: list[float]
    logarithmic: bool


@dataclass(frozen=True)
class Layer:
    """A metric in the plane; see `map_drawing.Layer`. A value is None where there is none."""

    title: str
    values: list[list[float | None]]
    low: float
    high: float
    rest: bool


@dataclass(frozen=True)
class Marks:
    """Points as [name, x, y], a line as [x, y] and its name as markup."""

    points: list[tuple[str, float, float]]
    line: list[list[float]]
    line_name: str


@dataclass(frozen=True)
class Map:
    """Metrics over two parameters.

    Attributes:
        name: of its folder.
        compensator: whose they are.
        place: in which environment, on which robot, in which variant.
        x, y: the parameters.
        layers: metrics, the one that the map was drawn for first.
        marks: what is marked.
        refused: how many cells the compensator refused, or failed in.
    """

    name: str
    compensator: str
    place: str
    x: Axis
    y: Axis
    layers: list[Layer]
    marks: Marks
    refused: int


def maps_in(folder: Path) -> list[Map]:
    """The maps in the folders of a folder, by their names; none without it.

    Raises:
        ValueError: one of them is not as `fo-gym map` writes it.
    """
    return [_read(path.parent) for path in sorted(folder.glob(f"*/{DRAWING}"))]


def _read(folder: Path) -> Map:
    drawing = Drawing.read(folder / DRAWING)
    if not (folder / TABLE).is_file():
        raise ValueError(f"{folder} has a {DRAWING}, but no {TABLE}; write both again with `fo-gym map`")
    table = read_csv((folder / TABLE).read_text(encoding="utf-8"))
    if wrong := _wrong(table, drawing):
        raise ValueError(f"{folder / TABLE} {wrong}; write it again with `fo-gym map`")
    first = table.iloc[0]
    columns = [name for name in dict.fromkeys([drawing.metric, *SHORT_NAMES.values()]) if name in table]
    shown = [name for name in columns if table[name].notna().any()]
    layers = [_layer(table, drawing, name) for name in shown]
    _, failed = layer_of(table, drawing, drawing.metric)
    x, y = (_axis(name, table) for name in (drawing.x, drawing.y))
    place = f"{place_of(first['env'], first['robot'])}, {first['variant']}"
    return Map(folder.name, str(first["compensator"]), place, x, y, layers, _marks(drawing), int(failed.sum()))


def _wrong(table: pd.DataFrame, drawing: Drawing) -> str:
    """What keeps a table from being drawn, or ""."""
    missing = [name for name in (drawing.x, drawing.y, drawing.metric) if name not in table]
    if missing:
        return f"has no column {missing[0]}"
    if table.duplicated([drawing.x, drawing.y]).any():
        return f"has a cell of {drawing.x} and {drawing.y} twice"
    return "" if table[drawing.metric].notna().any() else f"has no number in {drawing.metric}"


def _axis(name: str, table: pd.DataFrame) -> Axis:
    values = np.unique(table[name].to_numpy(dtype=np.float64))
    told = symbol(name, unit_of(table))
    title = html.escape(one_line(name, NAME_LIMIT)) if told is None else _markup(told)
    return Axis(name, title, values.tolist(), is_logarithmic(values))


def _layer(table: pd.DataFrame, drawing: Drawing, metric: str) -> Layer:
    layer, _ = layer_of(table, drawing, metric)
    return Layer(layer.title, [_told(row) for row in layer.values], layer.low, layer.high, layer.rest)


def _told(values: NDArray[np.float64]) -> list[float | None]:
    return [float(f"{value:.{_DIGITS}g}") if np.isfinite(value) else None for value in values]


def _marks(drawing: Drawing) -> Marks:
    marks = drawing.marks
    points = [(html.escape(name), x, y) for name, (x, y) in marks.points.items()]
    return Marks(points, [] if marks.line is None else marks.line.tolist(), _markup(marks.line_name))


def _markup(text: str) -> str:
    """TeX's mathematics as far as maps use it, $L_p^2$, as the markup that Plotly knows."""
    plain = html.escape(text.replace("$", ""))
    return re.sub(r"\^(\w)", r"<sup>\1</sup>", re.sub(r"_([a-z])", r"<sub>\1</sub>", plain))
