"""Everything that a user can call says what it takes."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import fo_gym
from fo_gym.envs.interaction import InteractionEnv
from fo_gym.envs.tracking import TrackingEnv
from fo_gym.tasks.reference import Reference

_SECTION = re.compile(r"^(Args|Attributes):\n((?:(?: +.*)?\n)*)", re.MULTILINE)


def documented(doc: str) -> dict[str, list[str]]:
    """The names under Args and under Attributes: "name: ...", or several that belong together, "low, high: ..."."""
    found: dict[str, list[str]] = {"Args": [], "Attributes": []}
    for title, body in _SECTION.findall(f"{inspect.cleandoc(doc)}\n"):
        entries = re.findall(r"^    (\w+(?:, \w+)*): ", body, re.MULTILINE)
        found[title] += [name for entry in entries for name in entry.split(", ")]
    return found


def taken(function: Callable[..., Any]) -> list[str]:
    """Its arguments, those in ** apart, under their names."""
    return [name for name in inspect.signature(function).parameters if name not in ("self", "cls")]


def offers(name: str, thing: Any) -> Iterator[tuple[str, list[str], list[str]]]:
    """What has to be documented of it and of its public methods: where, the names, and the documented ones.

    The only argument of a method is what its one sentence is about; what `Reference` asks for, or what a class has from
    one that it derives from, is documented there.
    """
    if not inspect.isclass(thing):
        first = (thing.__doc__ or "").partition("\n\n    Args")[0]
        yield name, taken(thing), [*documented(thing.__doc__ or "")["Args"], *re.findall(r"`(\w+)`", first)]
        return
    said = documented(thing.__doc__ or "")
    if is_dataclass(thing):
        yield name, [each.name for each in fields(thing)], said["Attributes"]
    elif "__init__" in vars(thing) and not getattr(thing, "_is_protocol", False):
        yield name, taken(thing), said["Args"]
    members = [member for member in vars(Reference) if not member.startswith("_")]
    elsewhere = members if thing is not Reference and all(hasattr(thing, member) for member in members) else []
    elsewhere += [member for base in thing.__mro__[1:] for member in vars(base)]
    for method, value in vars(thing).items():
        function = getattr(value, "__func__", value)
        if not method.startswith("_") and inspect.isfunction(function) and method not in elsewhere:
            yield from (each for each in offers(f"{name}.{method}", function) if len(each[1]) > 1)


def public() -> Iterator[tuple[str, Any]]:
    """What is callable in __all__, and what references have to be like."""
    yield "Reference", Reference
    yield from ((name, getattr(fo_gym, name)) for name in fo_gym.__all__ if callable(getattr(fo_gym, name)))


def test_every_argument_of_what_is_public_is_documented() -> None:
    found = {where: (needed, said) for name, thing in public() for where, needed, said in offers(name, thing)}
    assert {"Robot", "Robot.from_file", "Task", "Settings", "evaluate", "Reference.control"} <= set(found)
    missing = {where: [name for name in needed if name not in said] for where, (needed, said) in found.items()}
    assert {where: names for where, names in missing.items() if names} == {}


def test_nothing_is_documented_that_is_not_there() -> None:
    extra = {}
    for name, thing in public():
        there = {*dir(thing), *getattr(thing, "__annotations__", {}), *(() if inspect.isclass(thing) else taken(thing))}
        told = documented(thing.__doc__ or "")
        if names := [each for each in (*told["Args"], *told["Attributes"]) if each not in there]:
            extra[name] = names
    # Which one may have, and need not.
    assert extra == {"Compensator": ["learned", "privileged", "array_gains", "diagnostics"]}


@pytest.mark.parametrize("env_id", fo_gym.ENVIRONMENTS)
def test_every_argument_of_an_environment_is_one_that_is_documented(env_id: str) -> None:
    """Those of Settings, and render_mode; nothing else is taken."""
    settings = documented(fo_gym.Settings.__doc__ or "")["Attributes"]
    assert settings == [each.name for each in fields(fo_gym.Settings)]
    env = gym.make(env_id).unwrapped
    with pytest.raises(TypeError) as refused:
        gym.make(env_id, colour="red")
    assert all(name in str(refused.value) for name in settings)
    assert "`fo_gym.Settings`" in (type(env).__doc__ or "")
    assert "`render_mode`" in (type(env).__doc__ or "")


def test_the_swing_of_tracking_is_the_one_that_is_told() -> None:
    simulation: Any = gym.make("FJRTracking-v0").unwrapped.simulation  # type: ignore[attr-defined]
    task, doc = simulation.task, " ".join((TrackingEnv.__doc__ or "").split())
    path, push = task.reference, task.random_push
    assert "A = 0.3 rad (0.24 rad at joint 4) and f from 0.15 Hz at joint 1 to 0.3 Hz at joint 7" in doc
    np.testing.assert_allclose(path.amplitude, [0.3, 0.3, 0.3, 0.24, 0.3, 0.3, 0.3])
    np.testing.assert_allclose(path.frequency[[0, -1]], [0.15, 0.3])
    assert f"for {path.duration:g} s" in doc
    assert f"0 to 1 in {path.swell:g} s" in doc
    assert f"truncated after {task.duration:g} s" in doc
    low, high = np.array(task.randomization.push) * push.torque[1]
    start, hardware = task.randomization.push_time, task.push_time.start
    assert f"{push.duration:g} s, of {low:g} to {high:g} N m either way at joint 2" in doc
    assert "at {:g} to {:g} s (hardware: {:g} to {:g} s)".format(*start, *hardware) in doc


def test_the_hand_of_interaction_is_the_one_that_is_told() -> None:
    simulation: Any = gym.make("FJRInteraction-v0").unwrapped.simulation  # type: ignore[attr-defined]
    task, doc = simulation.task, " ".join((InteractionEnv.__doc__ or "").split())
    hand, gains, spread = task.hand, task.gains, task.randomization
    assert f"K_p = {gains.kp_position:.0f} N/m and K_d = {gains.kd_position:.0f} N s/m" in doc
    assert f"{hand.stiffness:.0f} N/m and {hand.damping:.0f} N s/m" in doc
    assert f"where that is at {hand.grip:g} s; its point goes {100 * hand.stroke:.0f} cm sideways" in doc
    assert abs(hand.direction[2]) < 1e-9
    np.testing.assert_allclose(hand.across, [0.0, 0.0, -1.0])
    assert f"each stroke in {hand.stroke_time:.0f} s, half of it at {hand.speed:.1f} m/s" in doc
    assert hand.stroke_time - 2.0 * hand.turn == pytest.approx(0.5 * hand.stroke_time)
    assert f"rests for {hand.rest:g} s and lets go at {hand.let_go:.1f} s, within {hand.release:g} s" in doc
    assert "of {:g} to {:g} times the length".format(*spread.hand_stroke) in doc
    assert "{:g} to {:g} times as fast".format(*spread.hand_speed) in doc
    assert "{:g} to {:g} times as stiff".format(*spread.hand_stiffness) in doc
    assert f"truncated after {task.duration:g} s" in doc
