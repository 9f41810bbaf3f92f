"""Effects of others that do what they must not: refused where the environment is made, by name."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest
from own_effects import Drift, Weak, replace_name

from fo_gym import hardware as hw
from fo_gym.hardware import Effect, FrictionChange, Hardware

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"


class Broken(Effect):
    """Gives what the test tells it to."""

    def __init__(self, **answers):
        self.answers = answers

    def draw(self, dof, generator):
        return self.answers.get("draw", {})

    def begin(self, episodes):
        return self.answers.get("begin", {})

    def measure(self, readings, episodes):
        episodes.memory.update(self.answers.get("remember", {}))
        return self.answers.get("measure", readings)

    def command(self, tau_m, episodes):
        return self.answers.get("command", tau_m)

    def motor_torque(self, episodes):
        return self.answers.get("motor_torque", 0.0)

    def friction(self, episodes):
        return self.answers.get("friction", FrictionChange())


@pytest.mark.parametrize(
    ("answers", "message"),
    [
        ({"draw": {"x": "much"}}, "Broken.draw, x is 'much'"),
        ({"begin": {"x": np.zeros(3)}}, r"Broken.begin, x is of shape \(3,\); it must have 1 rows"),
        ({"remember": {"x": np.zeros(3)}}, "Broken, memory is .*give a mapping"),
        ({"measure": None}, "Broken.measure is None; give a Readings"),
        ({"measure": hw.Readings(0.0, np.zeros((1, 7)), np.zeros((1, 7)))}, r"Broken.measure, theta is of shape \(\)"),
        ({"command": np.zeros(7)}, r"Broken.command is of shape \(7,\); it must be of shape \(1, 7\)"),
        ({"motor_torque": np.zeros(6)}, r"Broken.motor_torque is of shape \(6,\); it must be of shape \(1, 7\)"),
        ({"friction": (1.0, 0.0, 1.0)}, "Broken.friction is .*; give a FrictionChange"),
        ({"friction": FrictionChange(dry=None)}, "Broken.friction, dry is None"),
    ],
)
def test_what_an_effect_must_not_give(answers, message):
    """It is told when the environment is made, and by the hook's name."""
    with pytest.raises(ValueError, match=message):
        gym.make(REGULATION, hardware=Hardware(others=(Broken(**answers),)))


def test_noise_is_for_those_that_say_so():
    class Silent(Drift):
        noisy = False

    with pytest.raises(ValueError, match="the effect draws noise; give its class noisy = True"):
        gym.make(STICTION, hardware=Hardware(others=(Silent(),)))


def test_the_truth_cannot_be_written_into():
    class Vandal(Effect):
        def measure(self, readings, episodes):
            readings.theta[:] = 0.0
            return readings

    with pytest.raises(ValueError, match="read-only"):
        gym.make(STICTION, hardware=Hardware(others=(Vandal(),)))


@pytest.mark.parametrize(
    ("others", "message"),
    [
        (Weak(0.5), r"Hardware.others is Weak\(share=0.5\); give a tuple"),
        ((hw.Hardware(),), r"Hardware.others\[0\] is Hardware.*; give a Effect"),
        ((Weak(0.5), Weak(0.2)), "Hardware has 2 effects named 'Weak'; give each of them a `name` of its own"),
        ((replace_name(Weak(0.5), ""),), r"Hardware.others\[0\].name is ''; give a text that is not empty"),
    ],
)
def test_what_is_no_effect(others, message):
    with pytest.raises(ValueError, match=message):
        Hardware(others=others)
