"""A law that the package has never seen runs through environments, evaluation, workers and certificate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import fo_gym
from fo_gym.certificate.law import certify
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.trial import reference_trials
from fo_gym.modules import import_file

OWN = import_file(Path(__file__).parent / "outside" / "own_laws.py")
LAWS = {"smooth": OWN.SmoothCoulomb(), "sharp": OWN.Sharp()}


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("variant", ["nominal", "hardware"])
def test_it_runs_in_an_environment(name: str, variant: str) -> None:
    """Its friction opposes the motion, its states are in info and in the state that an environment saves."""
    law = LAWS[name]
    env = gym.make("FJRStiction-v0", friction=law, variant=variant)
    env.reset(seed=1)
    for _ in range(300):
        info = env.step(np.array([-3.0]))[4]
    assert info["theta_dot"][0] > 0.1
    own = env.unwrapped.simulation.scenarios[0].friction  # type: ignore[attr-defined]
    assert isinstance(own, type(law))
    if variant == "nominal":
        assert info["tau_f"][0] == pytest.approx(law.steady(info["theta_dot"][0]), rel=1e-2)
    else:
        assert own.f_c != law.f_c
    assert info["z"].shape == ((1,) if law.states == 1 else (1, law.states))
    state = env.unwrapped.get_state()  # type: ignore[attr-defined]
    there = env.step(np.array([1.0]))[4]["theta"]
    env.unwrapped.set_state(state)  # type: ignore[attr-defined]
    np.testing.assert_array_equal(env.step(np.array([1.0]))[4]["theta"], there)


def test_it_runs_in_a_batch_on_the_arm() -> None:
    """One law for seven joints, a value for each of them; a batch is its environments one by one."""
    law = OWN.SmoothCoulomb(f_c=np.linspace(2.0, 5.0, 7))
    batch: Any = gym.make_vec("FJRRegulation-v0", num_envs=2, friction=law, variant="randomized")
    batch.reset(seed=3)
    alone = gym.make("FJRRegulation-v0", friction=law, variant="randomized")
    alone.reset(seed=4)
    for _ in range(20):
        together = batch.step(np.ones((2, 7)))[4]["theta"]
        single = alone.step(np.ones(7))[4]["theta"]
    np.testing.assert_array_equal(together[1], single)
    assert batch.unwrapped.simulation.scenarios[0].friction.f_c.shape == (7,)


def test_it_is_evaluated_here_and_in_workers() -> None:
    """The same score in this process and in others, which have to import the user's file on their own."""
    compared = {"duration": 1.0}
    table = fo_gym.evaluate("pd-high", "FJRStiction-v0", seeds=1, friction=LAWS["smooth"], **compared)
    assert 0.5 < table["frr"].iloc[0] < 1.0
    sets = [EpisodeSet("FJRStiction-v0", "nominal", (0,), {"friction": law, **compared}) for law in LAWS.values()]
    there = dict(Processes(2).run(reference_trials, [(episodes,) for episodes in sets]))
    for place, episodes in enumerate(sets):
        here, found = reference_trials(episodes), there[place]
        assert found is not None
        np.testing.assert_array_equal(found[0].none.theta, here[0].none.theta)
        assert np.ptp(found[0].none.theta) > 1e-6


def test_it_is_certified() -> None:
    """Both follow their own equations and their steady curves; the smooth one creeps, and the certificate says so."""
    smooth, sharp = certify(LAWS["smooth"], 1e-4), certify(LAWS["sharp"])
    assert {name: finding.holds for name, finding in smooth.items()} == {"solver": True, "steady": True, "creep": False}
    assert {name: finding.holds for name, finding in sharp.items()} == {"solver": True, "steady": True, "creep": True}


def test_a_step_that_is_not_what_the_equations_say_is_found() -> None:
    class Wrong(OWN.SmoothCoulomb):  # type: ignore[misc, name-defined]
        """Feels 1 % more than it says."""

        def equations(self, v: float, z: Any) -> Any:
            return np.empty(0), 1.01 * super().equations(v, z)[1]

    assert not certify(Wrong(), 1e-4)["solver"].holds


def test_what_is_no_law_is_refused() -> None:
    with pytest.raises(ValueError, match=r"friction is 1\.0; give a FrictionLaw"):
        gym.make("FJRStiction-v0", friction=1.0)
