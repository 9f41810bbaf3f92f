"""What an episode draws of the hardware's effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, instance, mapping, number, real, real_arrays, whole_number
from fo_gym.generators import Streams
from fo_gym.hardware.effect import Drawn
from fo_gym.hardware.hardware import Hardware
from fo_gym.parameters import FlexibleJoint, check_joints

__all__ = ["HardwareDraw", "check_draw", "draw_hardware"]


@dataclass(frozen=True, eq=False)
class HardwareDraw:
    """What one episode has of the effects.

    Attributes:
        believed: motors and springs as controller, nominal motor and compensator know them, arrays (dof,).
        believed_mass: factor on the true masses in what they know.
        push_time: when the joints are pushed [s]; None leaves it to the randomization.
        drawn: what each effect drew, by its name.
        noise_seeds: of the noise of the effects that are noisy, by their names.
    """

    believed: FlexibleJoint
    believed_mass: float
    push_time: float | None
    drawn: Mapping[str, Drawn]
    noise_seeds: Mapping[str, int]


def draw_hardware(hardware: Hardware, joints: FlexibleJoint, streams: Streams) -> HardwareDraw:
    """One episode's draws, each effect's from the random stream of its name, its noise from one of its own.

    Args:
        hardware: which effects there are.
        joints: the true motors and springs, arrays (dof,).
        streams: the episode's.
    """
    drawn: dict[str, Drawn] = {}
    seeds: dict[str, int] = {}
    believed, mass, push_time = joints, 1.0, None
    for effect in hardware.effects:
        values = effect.draw(np.size(joints.stiffness), streams(f"effect {effect.name}"))
        drawn[effect.name] = {key: real(f"{effect.name}.draw, {key}", value) for key, value in values.items()}
        if effect.noisy:
            seeds[effect.name] = int(streams(f"noise of {effect.name}").integers(np.iinfo(np.int64).max))
        believed, mass = effect.believe(believed, mass, drawn[effect.name])
        push_time = effect.pushed_at(push_time, drawn[effect.name])
    return HardwareDraw(believed, mass, push_time, drawn, seeds)


def check_draw(name: str, draw: Any, like: HardwareDraw) -> None:
    """Raise ValueError where this is no draw of the same effects as `like`, naming the field.

    Args:
        name: what to call it.
        draw: what is claimed to be one.
        like: one.
    """
    instance(name, draw, HardwareDraw)
    instance(f"{name}.believed", draw.believed, FlexibleJoint)
    check_joints(draw.believed, np.size(like.believed.stiffness))
    number(f"{name}.believed_mass", draw.believed_mass, POSITIVE)
    if draw.push_time is not None:
        number(f"{name}.push_time", draw.push_time, NOT_NEGATIVE, "s")
    mapping(f"{name}.drawn", draw.drawn, like.drawn)
    for effect, values in like.drawn.items():
        real_arrays(f"{name}.drawn[{effect!r}]", draw.drawn[effect], values)
    mapping(f"{name}.noise_seeds", draw.noise_seeds, like.noise_seeds)
    for effect, seed in draw.noise_seeds.items():
        whole_number(f"{name}.noise_seeds[{effect!r}]", seed, 0)
