"""The single link under the controls of the paper's simulation, for the tests of the plant."""

from __future__ import annotations

from dataclasses import replace

from fo_gym.certificate.cases import FRICTION, JOINT, LINK, OBSERVERS, WITHOUT_FRICTION
from fo_gym.certificate.oracle import SingleLink

CASES = {**OBSERVERS, "no-friction": {}}
TARGET = 0.01
SLIDER = LINK
"""1 kg on a slide, without gravity along it."""


def link_of(name: str, damping: float = 0.0) -> SingleLink:
    return SingleLink(replace(JOINT, damping=damping), WITHOUT_FRICTION if name == "no-friction" else FRICTION)
