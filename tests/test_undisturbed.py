"""Motors that nothing disturbs, as the reference `ideal` has them; and what the truth says of a disturbance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from answering import episodes
from environments import every_env, make

import fo_gym
from fo_gym import hardware as hw
from fo_gym.compensators import Ideal, NoCompensation
from fo_gym.hardware import Effect, FrictionChange, Hardware

STICTION = "FJRStiction-v0"


@dataclass(frozen=True)
class Stubborn(Effect):
    """An effect of a user's that disturbs the motors by every way there is."""

    def motor_torque(self, episodes):
        return 0.3

    def friction(self, episodes):
        return FrictionChange(dry=2.0, added=0.1, viscous=3.0)


def states(env, steps=60):
    """The plant's motion under no estimate."""
    nothing = np.zeros(env.action_space.shape)
    return np.array([[env.step(nothing)[4][name] for name in ("theta", "q")] for _ in range(steps)])


@every_env
def test_nothing_disturbs_the_motors(env_id):
    """With every effect that disturbs, the motion is to the bit that of joints without friction and without them."""
    ripple = hw.GearRipple(amplitude=0.5, period=0.01)
    rough = hw.LinkFriction(coulomb=0.1, viscous=0.4, width=0.01)
    disturbing = Hardware(ripple=ripple, load=hw.LoadFriction(0.2), link_friction=rough, others=(Stubborn(),))
    undisturbed = make(env_id, hardware=disturbing, disturbed=False)
    bare = make(env_id, friction=fo_gym.FRICTIONLESS, hardware=Hardware(link_friction=rough))
    np.testing.assert_array_equal(states(undisturbed), states(bare))
    assert not np.array_equal(states(make(env_id, hardware=disturbing)), states(make(env_id, disturbed=False)))


@every_env
def test_it_draws_and_measures_what_the_disturbed_one_does(env_id):
    """The same episode: draws, and noise and offset of the sensors."""
    one, other = make(env_id, variant="hardware"), make(env_id, variant="hardware", disturbed=False)
    for first, second in zip(one.simulation.scenarios, other.simulation.scenarios, strict=True):
        assert first.hardware.noise_seeds == second.hardware.noise_seeds
        for name, drawn in first.hardware.drawn.items():
            for key, value in drawn.items():
                np.testing.assert_array_equal(value, second.hardware.drawn[name][key])
    for env in (one, other):
        env.step(np.zeros(env.action_space.shape))
    seen = (env.simulation.hardware_model.readings.tau_j - env.simulation.plant.tau_j for env in (one, other))
    filtered = 0.05 * np.max(np.abs(one.simulation.robot.hardware.sensors.torque.offset))
    np.testing.assert_allclose(*seen, atol=filtered)  # the sensor's low-pass lags behind two motions


def test_the_disturbance_is_friction_and_what_effects_add():
    hardware = Hardware(ripple=hw.GearRipple(amplitude=0.2, period=1e-3), others=(Stubborn(),))
    env = make(STICTION, hardware=hardware)
    phase = env.simulation.scenarios[0].hardware.drawn["GearRipple"]["phase"]
    for _ in range(20):
        theta = env.simulation.plant.theta[0].copy()
        *_, info = env.step([0.1])
        added = 0.2 * np.sin(2 * np.pi * theta / 1e-3 + phase) + 0.3
        np.testing.assert_allclose(info["tau_dist"] - info["tau_f"], added, atol=1e-12)


def test_ideal_runs_undisturbed_and_none_does_not():
    """Both report what disturbed them."""
    batch = episodes(STICTION, hardware=Hardware(ripple=hw.GearRipple(amplitude=0.2, period=1e-3)))
    ideal, none = batch.record(Ideal(), "ideal"), batch.record(NoCompensation(), "none")
    assert np.all(ideal.periods["tau_dist"] == 0.0)
    assert np.any(none.periods["tau_dist"] != none.periods["tau_f"])


def test_an_evaluation_does_not_let_it_be_chosen():
    with pytest.raises(ValueError, match="disturbed cannot be chosen in an evaluation"):
        fo_gym.evaluate("pid-low", STICTION, duration=0.01, disturbed=False)
