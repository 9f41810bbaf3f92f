"""What compensators say besides their estimate: kept in traces, whoever runs beside them, and wherever they run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tables import STICTION
from tellers import Half, Short, Twice

import fo_gym
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.episode.trace import DIAGNOSTIC
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.trial import reference_trials, trials_together

TELLERS = Path(__file__).with_name("tellers.py")


def own(trace):
    """The signals that are a compensator's own."""
    return {name for name in trace.signals if name.startswith(DIAGNOSTIC)}


@pytest.mark.parametrize("teller", [Half, f"{TELLERS}:Half"], ids=["here", "in a process of its own"])
def test_a_trace_has_what_was_said(teller):
    trace = fo_gym.trace(teller, STICTION, duration=0.5)
    assert own(trace) == {f"{DIAGNOSTIC}half", f"{DIAGNOSTIC}where"}
    np.testing.assert_allclose(trace.signals[f"{DIAGNOSTIC}half"], 0.5 * trace.signals["tau_f_hat"], rtol=1e-6)
    assert np.ptp(trace.signals["tau_f_hat"]) > 0.0


@pytest.mark.parametrize("teller", [Twice, f"{TELLERS}:Twice"], ids=["here", "in a process of its own"])
def test_where_nothing_is_said_there_is_no_number(teller):
    trace = fo_gym.trace(teller, STICTION, duration=0.1)
    said = np.isfinite(trace.signals[f"{DIAGNOSTIC}half"][:, 0])
    np.testing.assert_array_equal(said, np.arange(len(said)) < 2)


def test_in_a_team_everybody_says_its_own(monkeypatch):
    monkeypatch.setattr(Competitor, "guarded", property(lambda self: False))
    episodes = EpisodeSet(STICTION, "randomized", (1, 2), {"duration": 0.3}, traced=True)
    names = {"pid-high": "pid-high", "half": "tellers:Half", "another": "tellers:Half"}
    competitors = [Competitor(name, spec) for name, spec in names.items()]
    trials = trials_together(episodes, competitors, reference_trials(episodes)[0])
    assert all(own(trace) == set() for trace in trials[0].traces)
    for trial in trials[1:]:
        for trace in trial.traces:
            place = episodes.seeds.index(trace.seed)
            np.testing.assert_array_equal(trace.signals[f"{DIAGNOSTIC}where"], place)
            np.testing.assert_allclose(trace.signals[f"{DIAGNOSTIC}half"], 0.5 * trace.signals["tau_f_hat"], rtol=1e-6)


@pytest.mark.parametrize(
    ("teller", "message"),
    [
        (Short, r"diagnostics\['half'\] has shape \(3,\) at tick 0; \(num_envs, dof\) is \(1, 1\)"),
        (f"{TELLERS}:Short", r"diagnostics\['half'\] has shape \(3,\) at tick 0"),
        (f"{TELLERS}:Listed", "tick 0"),
        (f"{TELLERS}:Worded", "tick 0: its diagnostics are no numbers by name"),
    ],
)
def test_what_cannot_be_said(teller, message):
    with pytest.raises(fo_gym.CompensatorError, match=message):
        fo_gym.trace(teller, STICTION, duration=0.1)


def test_the_adaptive_compensator_tells_zero_and_correction():
    trace = fo_gym.trace("rl-adaptive", STICTION, variant="hardware", duration=3.0)
    zero, correction = (trace.signals[f"{DIAGNOSTIC}{name}"] for name in ("zero", "correction"))
    assert np.ptp(zero) > 0.0
    assert (np.sign(zero[-1]) == -np.sign(correction[-1])).all() or np.abs(correction[-1]) > 0.0
