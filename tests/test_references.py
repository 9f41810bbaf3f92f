"""Privileged compensators: who sees the truth is a reference, and who is none never sees it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from answering import REGULATION, STICTION, Answering, episodes, silent

import fo_gym
from baselines.kim2019 import pid_high
from baselines.lugre1995 import LuGreIdentified, LuGreObserver
from fo_gym import LuGre, Signals
from fo_gym import hardware as hw
from fo_gym.compensators import BOUND_RATES, Bound, make_compensator
from fo_gym.evaluation.competitors.competitor import SUBMISSION, Competitor
from fo_gym.evaluation.competitors.team import Team, alike
from fo_gym.evaluation.results.leaderboard import leaderboard, overall
from fo_gym.evaluation.results.tables import finding, rankings, summary
from fo_gym.evaluation.runs.bound import bound_of
from fo_gym.evaluation.runs.contest import Contest
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.evaluate import evaluate
from fo_gym.evaluation.runs.trial import competitor_trial, reference_trials, trials_together
from fo_gym.hardware import Hardware

FIELDS = ("sigma_0", "sigma_1", "sigma_2", "f_c", "f_s", "v_s")
ORACLE = """
import numpy as np

class Oracle:
    feedback = "measured"
    privileged = True

    def reset(self, joints, num_envs):
        self.zero = np.zeros((num_envs, joints.dof))

    def estimate(self, signals):
        return self.zero
"""


class Oracle(Answering):
    """A user's own: the true disturbance as it was, and a look at everything."""

    privileged = True

    def __init__(self) -> None:
        super().__init__(self.look)
        self.seen: list[Signals] = []

    def look(self, signals: Signals, _: int) -> np.ndarray:
        self.seen.append(signals)
        assert signals.truth is not None
        return signals.truth["tau_dist"]


def test_the_privileged_see_the_truth_of_every_tick():
    oracle = Oracle()
    recording = episodes(REGULATION, (7, 8)).record(oracle, "oracle")
    for name in ("theta", "theta_dot", "q", "q_dot"):
        told = [signals.truth[name] for signals in oracle.seen]
        np.testing.assert_array_equal(told, recording.ticks[name][:-1])
    late = np.array([signals.truth["tau_dist"] for signals in oracle.seen[1:]])
    np.testing.assert_array_equal(late, recording.periods["tau_dist"][:-1])
    np.testing.assert_array_equal(recording.periods["tau_f_hat"][1:], late)


@pytest.mark.parametrize("env_id", [STICTION, REGULATION])
def test_they_know_the_friction_of_their_episodes_at_the_start(env_id):
    """As it was drawn, and as load and temperature have it there."""
    oracle = Oracle()
    temperature = hw.Temperature(start=(10.0, 20.0), dry=0.005, viscous=0.02)
    hardware = Hardware(load=hw.LoadFriction(0.1), temperature=temperature)
    recording = episodes(env_id, (7, 8), hardware=hardware).record(oracle, "oracle")
    for i, scenario in enumerate(recording.scenarios):
        assert scenario.hardware is not None
        warm = scenario.hardware.drawn["Temperature"]["start"]
        q = oracle.seen[0].truth["q"][i]
        load = scenario.joints.stiffness * (oracle.seen[0].truth["theta"][i] - q)
        for name in FIELDS:
            expected = getattr(scenario.friction, name)
            if name in ("f_c", "f_s"):
                expected = expected * np.exp(-0.005 * warm) + 0.1 * np.abs(load)
            if name == "sigma_2":
                expected = expected * np.exp(-0.02 * warm)
            np.testing.assert_allclose(getattr(oracle.joints.identified, name)[i], expected, rtol=1e-7)


def test_nobody_else_does():
    """Not even beside one who does, in the same batch."""
    members = {"oracle": Oracle(), "other": Answering(silent), "bound": Bound()}
    assert alike(members) == [["oracle", "bound"], ["other"]]
    with pytest.raises(ValueError, match="too many values"):
        Team(list(members.values()))
    blind = Answering(lambda signals, _: np.full(signals.theta.shape, float(signals.truth is not None)))
    recording = episodes(STICTION).record(blind, "blind")
    assert not recording.periods["tau_f_hat"].any()
    assert np.shape(blind.joints.identified.f_c) != (1, 1)


def test_a_team_of_the_privileged_is_what_each_is_alone():
    members = [Bound(), LuGreIdentified(), Bound(1000.0)]
    seeds = (7, 8)
    together = episodes(REGULATION, seeds * 3).record(Team(members, 2), "team")
    for place, member in enumerate(members):
        alone = episodes(REGULATION, seeds).record(member, "alone")
        part = together.part(slice(2 * place, 2 * place + 2))
        np.testing.assert_array_equal(part.periods["tau_f_hat"], alone.periods["tau_f_hat"])


def test_the_bound_is_the_disturbance_late_and_pays_back_what_it_missed():
    batch = episodes(STICTION, (7, 8), duration=0.3)
    for rate in BOUND_RATES:
        recording = batch.record(Bound(rate), "bound")
        estimates, disturbance = recording.periods["tau_f_hat"], recording.periods["tau_dist"]
        momentum = 1e-3 * np.cumsum(disturbance - estimates, axis=0)
        paid = 2.0 * rate * momentum + rate**2 * 1e-3 * np.cumsum(momentum, axis=0)
        assert not estimates[0].any()
        np.testing.assert_allclose(estimates[1:], (disturbance + paid)[:-1], rtol=1e-9, atol=1e-12)


def test_nobody_is_above_the_bound_where_nothing_but_lateness_counts():
    """The best of the paper's observers on the paper's single link, and on the arm."""
    for env_id, highest in ((STICTION, 0.99), (REGULATION, 0.98)):
        batch = EpisodeSet(env_id, "nominal", (0,), {"duration": 5.0})
        references, trials = reference_trials(batch)
        best = competitor_trial(batch, Competitor("pid-high", "pid-high"), references)
        assert trials[2].rows["frr"].item() > max(highest, best.rows["frr"].item())


def test_the_bound_of_a_set_is_the_best_lag():
    batch = episodes(STICTION, (7, 8), duration=0.5)
    references, trials = reference_trials(batch)
    best = bound_of(batch, references)
    scores = []
    for rate in BOUND_RATES:
        one = evaluate(Bound(rate), STICTION, variant="randomized", seeds=[7, 8], duration=0.5)
        scores.append(one["frr"].mean())
    assert trials[2].rows["frr"].mean() == max(scores)
    assert len(set(scores)) == len(scores)
    by_name = evaluate("bound", STICTION, variant="randomized", seeds=[7, 8], duration=0.5)
    assert by_name["frr"].tolist() == trials[2].rows["frr"].tolist()
    assert best.periods["tau_f_hat"].shape == (500, 2, 1)


def test_the_bound_tells_who_runs_it_without_the_truth():
    bound = Bound()
    env = fo_gym.envs.single.gym.make(STICTION).unwrapped
    bound.reset(env.joint_info, 1)
    with pytest.raises(ValueError, match=r"signals\.truth is None; the bound needs the truth"):
        bound.estimate(Signals.from_observation(np.zeros((1, 9)), 1))


def test_the_observer_of_a_perfect_model_has_the_episodes_own():
    """One by one it is the LuGre observer with the friction that was drawn."""
    for seed in (7, 8):
        batch = episodes(REGULATION, (seed,))
        perfect = batch.record(LuGreIdentified(), "perfect")
        friction = perfect.scenarios[0].friction
        assert isinstance(friction, LuGre)
        own = batch.record(LuGreObserver(friction), "own")
        np.testing.assert_allclose(perfect.periods["tau_f_hat"], own.periods["tau_f_hat"], rtol=1e-9, atol=1e-9)
    registered = make_compensator("baselines.lugre1995:LuGreIdentified")
    assert registered.privileged


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """Two who compete and three references, one of them a user's own class that nobody could beat."""
    who = {"pid-high": pid_high(), "zero": Answering(silent), "oracle": Bound(), "ideal": "ideal", "none": "none"}
    seeds = {"variant": "randomized", "seeds": [1, 2], "duration": 0.4}
    rows = [evaluate(each, STICTION, **seeds).assign(compensator=name) for name, each in who.items()]
    return pd.concat(rows, ignore_index=True)


def test_references_are_never_ranked(table):
    ranked = leaderboard(table).set_index("compensator")
    assert ranked["frr"]["oracle"] > ranked["frr"]["pid-high"] > 0.0
    assert ranked["verdict"]["pid-high"] == "best"
    assert ranked.loc[["oracle", "ideal", "none"], ["rank", "verdict", "tied_group"]].isna().all(axis=None)
    both = pd.concat([table, table.assign(env=REGULATION)], ignore_index=True)
    assert overall(both).set_index("compensator").loc[["oracle", "none"], "rank"].isna().all()


def test_tables_show_them_as_references(table):
    (ranking,) = rankings(table)
    verdicts = {cells[1]: cells[-1] for cells in ranking.cells}
    assert {name for name, verdict in verdicts.items() if verdict == "reference"} == {"oracle", "ideal", "none"}
    assert [cells[1] for cells in ranking.cells][:2] == ["pid-high", "zero"]
    ranked = leaderboard(table)
    assert "oracle" not in finding(ranked, "randomized")
    assert [cells[0] for cells in summary(ranked).cells] == ["pid-high", "zero", "oracle (reference)"]


def test_every_contest_has_the_bound():
    competitor = Competitor("pid-high", "pid-high")
    everybody = Contest(episodes(STICTION), (competitor,)).everybody
    assert [each.name for each in everybody] == ["none", "ideal", "bound", "pid-high"]


@pytest.mark.parametrize("origin", [SUBMISSION, "yours"])
def test_who_runs_in_a_process_of_its_own_cannot_be_privileged(tmp_path: Path, origin):
    file = tmp_path / "oracle.py"
    file.write_text(ORACLE, encoding="utf-8")
    batch = episodes(STICTION)
    references, _ = reference_trials(batch)
    trial = competitor_trial(batch, Competitor("oracle", f"{file}:Oracle", origin), references)
    assert trial.failed
    assert "oracle.py:Oracle' is privileged, but the truth stays" in trial.rows["error"].iloc[0]
    with pytest.raises(ValueError, match=r"hand its class or an instance to fo_gym\.evaluate"):
        evaluate(f"{file}:Oracle", STICTION, duration=0.1)


def test_a_privileged_entry_of_the_projects_own_is_a_reference():
    batch = episodes(STICTION)
    references, _ = reference_trials(batch)
    competitor = Competitor("wise", "bound", gains={"rate": 300.0})
    (trial,) = trials_together(batch, [competitor], references)
    assert set(trial.labelled(batch, competitor, "p").rows["origin"]) == {"reference"}


def test_privileged_is_a_truth_value():
    odd = Answering(silent)
    odd.privileged = "yes"
    with pytest.raises(TypeError, match="privileged is 'yes'; give True or False, or leave it out"):
        evaluate(odd, STICTION, duration=0.01)
