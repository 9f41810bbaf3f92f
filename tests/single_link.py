"""The single link under the controls of the paper's simulation, for the tests of the plant."""

from __future__ import annotations

from dataclasses import replace

from envs_assets import asset_path
from fo_gym.parameters import FlexibleJoint, LuGre
from fo_gym.reproduction.reference import SingleLink
from fo_gym.robots import LinkSide

JOINT = FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=100.0)
PAPER = LuGre(sigma_0=1e5, sigma_1=1e5**0.5, sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=1e-3)
# The equations divide by g(v): for them, no friction is a bristle without force.
NO_FRICTION = LuGre(sigma_0=0.0, sigma_1=0.0, sigma_2=0.0, f_c=1.0, f_s=1.0, v_s=1.0)

CASES: dict[str, dict[str, float]] = {
    "none": {},
    "pid-low": {"nominal": True, "L": 50.0, "L_p": 10.0, "L_i": 25.0},
    "pid-high": {"nominal": True, "L": 100.0, "L_p": 20.0, "L_i": 100.0},
    "pd-low": {"nominal": True, "L": 50.0, "L_p": 10.0},
    "pd-high": {"nominal": True, "L": 100.0, "L_p": 20.0},
    "letien-low": {"L": 50.0},
    "letien-high": {"L": 100.0},
    "no-friction": {},
}
TARGET = 0.01
SLIDER = LinkSide(asset_path("single_link"), ("joint",))
"""1 kg on a slide, without gravity along it."""


def link_of(name: str, damping: float = 0.0) -> SingleLink:
    return SingleLink(replace(JOINT, damping=damping), NO_FRICTION if name == "no-friction" else PAPER)
