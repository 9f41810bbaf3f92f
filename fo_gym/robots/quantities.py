"""Parameters as tables of quantities, {value, unit, source}, and back: what robot.toml is made of."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from fo_gym.checks import shown

# What a field is counted in, at a joint that turns and at one that slides.
_UNITS: dict[str, tuple[str, str]] = {
    "stiffness": ("N m/rad", "N/m"),
    "damping": ("N m s/rad", "N s/m"),
    "motor_inertia": ("kg m^2", "kg"),
    "torque_limit": ("N m", "N"),
    "sigma_0": ("N m/rad", "N/m"),
    "sigma_1": ("N m s/rad", "N s/m"),
    "sigma_2": ("N m s/rad", "N s/m"),
    "f_c": ("N m", "N"),
    "f_s": ("N m", "N"),
    "v_s": ("rad/s", "m/s"),
    "attraction": ("N m/s", "N/s"),
    "kp": ("N m/rad", "N/m"),
    "kd": ("N m s/rad", "N s/m"),
    "kp_position": ("N/m", "N/m"),
    "kd_position": ("N s/m", "N s/m"),
    "kp_orientation": ("N m/rad", "N m/rad"),
    "kd_orientation": ("N m s/rad", "N m s/rad"),
    "kp_elbow": ("N m/rad", "N/m"),
    "kd_elbow": ("N m s/rad", "N s/m"),
    "encoder.resolution": ("rad", "m"),
    "encoder.cutoff": ("rad/s", "rad/s"),
    "torque.noise": ("N m", "N"),
    "torque.offset": ("N m", "N"),
    "torque.cutoff": ("rad/s", "rad/s"),
    "torque.nulled": ("s", "s"),
    "torque.drift": ("N m", "N"),
    "delay.seconds": ("s", "s"),
    "link_friction.coulomb": ("N m", "N"),
    "link_friction.viscous": ("N m s/rad", "N s/m"),
    "link_friction.width": ("rad/s", "m/s"),
    "ripple.amplitude": ("N m", "N"),
    "ripple.period": ("rad", "m"),
    "load.quadratic_load": ("1/(N m)", "1/N"),
    "load.quadratic_motor": ("1/(N m)", "1/N"),
    "temperature.start": ("K", "K"),
    "temperature.rise": ("K", "K"),
    "temperature.time": ("s", "s"),
    "temperature.dry": ("1/K", "1/K"),
    "temperature.viscous": ("1/K", "1/K"),
    "push_time.start": ("s", "s"),
    "model_error.motor_inertia": ("1", "1"),
    "model_error.stiffness": ("1", "1"),
}
_SHARE = "1"
"""The unit of what has none."""

__all__ = ["parts_of", "quantity", "read_parts", "read_quantity", "table_of", "unit_of"]


def unit_of(path: str, units: tuple[str, ...]) -> str | list[str]:
    """The unit of a field, by its dotted path: one for all joints, or, where they differ, one for each."""
    two, one = ".".join(path.split(".")[-2:]), path.rsplit(".", maxsplit=1)[-1]
    turning, sliding = _UNITS.get(two) or _UNITS.get(one) or (_SHARE, _SHARE)
    each = [turning if unit == "rad" else sliding for unit in units]
    return each[0] if len(set(each)) == 1 else each


def quantity(path: str, value: Any, units: tuple[str, ...], source: str) -> dict[str, Any]:
    """One value, or one for each joint, as a table."""
    plain = value.tolist() if isinstance(value, np.ndarray) else list(value) if isinstance(value, tuple) else value
    return {"value": plain, "unit": unit_of(path, units), **({"source": source} if source else {})}


def parts_of(path: str, parameters: Any) -> Iterator[tuple[str, Any]]:
    """(dotted path, value) of all that parameters hold, and that is not None; parts within parts included."""
    for field in dataclasses.fields(parameters):
        value, inner = getattr(parameters, field.name), f"{path}.{field.name}"
        if inner == "hardware.others":
            if value:
                raise ValueError(
                    f"{inner} is {shown(value)}; a robot.toml holds numbers alone: write the robot without these "
                    "effects, and give them where it is used"
                )
        elif dataclasses.is_dataclass(value):
            yield from parts_of(inner, value)
        elif value is not None:
            yield inner, value


def table_of(path: str, parameters: Any, units: tuple[str, ...], sources: Mapping[str, str]) -> dict[str, Any]:
    """Parameters as nested tables of quantities."""
    table: dict[str, Any] = {}
    for inner, value in parts_of(path, parameters):
        *folders, name = inner.removeprefix(f"{path}.").split(".")
        place = table
        for folder in folders:
            place = place.setdefault(folder, {})
        place[name] = quantity(inner, value, units, sources.get(inner, ""))
    return table


def read_quantity(path: str, table: Any, units: tuple[str, ...]) -> Any:
    """The value of a quantity: a float, or an array.

    Raises:
        ValueError: the table is none of a quantity, or in another unit.
    """
    if not isinstance(table, dict) or "value" not in table or not set(table) <= {"value", "unit", "source"}:
        raise ValueError(f"{path} is {shown(table)}; give a table of value, unit and source")
    wanted = unit_of(path, units)
    if table.get("unit", wanted) != wanted:
        raise ValueError(f"{path} is in {shown(table['unit'])}; give it in {shown(wanted)}")
    if not isinstance(table.get("source", ""), str):
        raise ValueError(f"{path}: its source is {shown(table['source'])}; give a text")
    value = table["value"]
    several = value if isinstance(value, list) else [value]
    if not several or not all(isinstance(one, int | float) and not isinstance(one, bool) for one in several):
        raise ValueError(
            f"{path} is {shown(value)}; give a number in {shown(wanted)}, or a list with one for each joint"
        )
    return np.array(value, dtype=np.float64) if isinstance(value, list) else float(value)


def read_parts(kind: type, path: str, table: Any, units: tuple[str, ...]) -> Any:
    """Parameters of a class from their tables; what is not there has the class's default.

    Raises:
        ValueError: there is something that the class has not, or a value that it does not take.
    """
    hints = get_type_hints(kind)
    if not isinstance(table, dict) or not set(table) <= set(hints):
        unknown = sorted(set(table) - set(hints)) if isinstance(table, dict) else table
        raise ValueError(f"{path}: there is {shown(unknown)}; allowed are {', '.join(hints)}")
    values = {}
    for name, inner in table.items():
        parts = [part for part in (hints[name], *get_args(hints[name])) if dataclasses.is_dataclass(part)]
        if parts and isinstance(parts[0], type):
            values[name] = read_parts(parts[0], f"{path}.{name}", inner, units)
            continue
        value = read_quantity(f"{path}.{name}", inner, units)
        is_range = get_origin(hints[name]) is tuple and isinstance(value, np.ndarray)
        values[name] = tuple(value.tolist()) if is_range else value
    try:
        return kind(**values)
    except TypeError as error:
        raise ValueError(f"{path}: {error}; allowed are {', '.join(hints)}") from None
