"""The experiments on many arms at once: each is what it is alone, through the environment's door."""

from __future__ import annotations

import numpy as np
import pytest

import fo_gym
from fo_gym.friction import LuGre
from fo_gym.reproduction.arms import ARM, FRICTION, run_arms
from fo_gym.reproduction.runs import REGULATION
from fo_gym.reproduction.sensitivity import AS_IT_IS, Variation, finding
from fo_gym.reproduction.team import run_team
from fo_gym.simulation.settings import Settings
from fo_gym.tasks.regulation import regulation

OTHER = Variation("other", bristle=0.5, ratio=1.2, stribeck=2.0)
NAMES = ("pid-low", "letien-low")


def members() -> dict[str, fo_gym.Compensator]:
    return {name: fo_gym.make_compensator(name) for name in NAMES}


@pytest.mark.parametrize("place", [0, 1])
def test_an_arm_of_many_is_what_it_is_alone(place: int) -> None:
    """Four seconds, a step among them, under the arm's own friction and another; both feedbacks."""
    frictions = [FRICTION, OTHER.friction(FRICTION)]
    many = run_arms(members(), regulation, Settings(duration=4.0), frictions=frictions)
    alone = run_team(members(), REGULATION, duration=4.0, friction=frictions[place])
    for name, run in alone.items():
        ticks = run.recording.ticks
        arm = many[name][place]
        assert np.ptp(arm.error[:, 1]) > 0.05
        for found, expected in (
            (arm.error, ticks["theta"] - ticks["theta_d"]),
            (arm.error_n, ticks["theta_n"] - ticks["theta_d"]),
            (arm.q, ticks["q"]),
        ):
            np.testing.assert_allclose(found, expected[: 10 * len(found) : 10, run.row], rtol=0.0, atol=1e-12)
    assert np.abs(many["pid-low"][0].error - many["pid-low"][1].error).max() > 1e-4


def test_a_variation_changes_what_it_says() -> None:
    law = OTHER.friction(LuGre(sigma_0=4.0, sigma_1=3.0, sigma_2=2.0, f_c=1.0, f_s=2.0, v_s=0.1))
    assert vars(law) == {
        "sigma_0": 2.0,
        "sigma_1": 3.0 * np.sqrt(0.5),
        "sigma_2": 2.0,
        "f_c": 1.0,
        "f_s": 1.2,
        "v_s": 0.2,
    }
    halved = Variation("half", damping=0.5).gains(ARM.pd_gains)
    np.testing.assert_array_equal(halved.kd, 0.5 * np.asarray(ARM.pd_gains.kd))  # type: ignore[union-attr]
    np.testing.assert_array_equal(halved.kp, ARM.pd_gains.kp)  # type: ignore[union-attr]


def test_a_finding_tells_what_turns_it() -> None:
    settings = Settings(duration=0.1)
    (arm,) = run_arms({"pid-low": fo_gym.make_compensator("pid-low")}, regulation, settings)["pid-low"]
    runs = {AS_IT_IS.name: {"x": arm}, "less": {}, "more": {"x": arm, "y": arm}}
    found = finding(runs, lambda each: float(len(each)), "mrad", 1.0, np.inf, "how many")
    assert found.holds
    assert found.measured == "how many. It would be 0 with less (which turns it), 2 with more"
