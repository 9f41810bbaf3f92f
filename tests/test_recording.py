"""What is kept of an episode: shapes, ticks, references, seeds, early ends."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest
from answering import DOF, REGULATION, SQUARE, STICTION, Answering, arrays, assert_same, episodes, silent

from fo_gym import FlexibleJoint, JointInfo, Signals, evaluate
from fo_gym.compensators import Ideal, NoCompensation
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.runs.episodes import rows

STRONG = FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=1e308)


# What is kept


@pytest.mark.parametrize("env_id", DOF)
@pytest.mark.parametrize("decimation", [1, 5])
def test_shapes(env_id: str, decimation: int) -> None:
    batch = episodes(env_id, (1, 2, 3), duration=0.05, decimation=decimation)
    recording = batch.record(NoCompensation(), "none")
    periods, dof = 50 // decimation, DOF[env_id]
    per_tick = {"theta", "theta_dot", "q", "q_dot", "theta_n", "theta_n_dot", "theta_d"}
    assert {name: recording.ticks[name].shape for name in per_tick} == dict.fromkeys(per_tick, (periods + 1, 3, dof))
    assert set(recording.ticks) == per_tick | {"reference"} | ({"tool"} if env_id == SQUARE else set())
    assert {array.shape for array in recording.periods.values()} == {(periods, 3, dof)}
    assert recording.dt == pytest.approx(1e-3 * decimation)
    assert recording.seconds.shape == (periods,)
    episode = recording.episode(1, References(recording.motions, recording.motions))
    assert episode.duration == pytest.approx(0.05)
    assert episode.theta_d.shape == (periods + 1, dof)
    assert episode.tau_f.shape == (periods, dof)
    assert (episode.tool_d is not None) == (env_id == SQUARE)


def test_signals_and_truth_are_kept_at_their_ticks() -> None:
    seen = []

    def look(signals: Signals, tick: int) -> np.ndarray:
        seen.append([signals.theta, signals.theta_n_dot, signals.theta_d, signals.tau_c])
        return np.full((1, 7), 0.1 * tick)

    recording = episodes(SQUARE).record(Answering(look), "look")
    theta, theta_n_dot, theta_d, tau_c = (np.array(values) for values in zip(*seen, strict=True))
    np.testing.assert_array_equal(recording.ticks["theta"][:-1], theta)
    np.testing.assert_array_equal(recording.ticks["theta_n_dot"][:-1], theta_n_dot)
    np.testing.assert_array_equal(recording.ticks["theta_d"][:-1], theta_d)
    np.testing.assert_array_equal(recording.periods["tau_m"], tau_c - recording.periods["tau_f_hat"])


def test_the_estimate_is_kept_as_applied() -> None:
    answers = iter(np.linspace(-25.0, 25.0, 50))
    batch = episodes(STICTION, duration=0.05)
    recording = batch.record(Answering(lambda *_: np.full((1, 1), next(answers))), "loud")
    expected = np.clip(np.linspace(-25.0, 25.0, 50), -10.0, 10.0)
    np.testing.assert_array_equal(recording.periods["tau_f_hat"][:, 0, 0], expected)


@pytest.mark.parametrize("feedback", ["measured", "nominal"])
def test_feedback_is_taken_from_the_compensator(feedback: str) -> None:
    seen: list[Signals] = []
    batch = episodes(STICTION, duration=0.3)
    batch.record(Answering(lambda signals, _: seen.append(signals) or silent(signals, 0), feedback), "who")
    position, velocity = ("theta", "theta_dot") if feedback == "measured" else ("theta_n", "theta_n_dot")
    for signals in seen:
        expected = -50.0 * (getattr(signals, position) - signals.theta_d) - 5.0 * getattr(signals, velocity)
        np.testing.assert_allclose(signals.tau_c, expected, atol=1e-12)
    assert np.max(np.abs(seen[-1].theta - seen[-1].theta_n)) > 1e-4


# References and seeds


@pytest.mark.parametrize("env_id", DOF)
def test_ideal_and_none_meet_the_same_episodes(env_id: str) -> None:
    batch = episodes(env_id, (3, 4))
    ideal, none = batch.record(Ideal(), "ideal"), batch.record(NoCompensation(), "none")
    np.testing.assert_array_equal(ideal.ticks["theta"][0], none.ticks["theta"][0])
    np.testing.assert_array_equal(ideal.ticks["theta_d"], none.ticks["theta_d"])
    for one, other in zip((s.push for s in ideal.scenarios), (s.push for s in none.scenarios), strict=True):
        assert one is not None
        assert other is not None
        assert (one.time, one.duration, *one.torque) == (other.time, other.duration, *other.torque)
    assert np.all(ideal.periods["tau_f"] == 0.0)
    if env_id != REGULATION:  # which is at rest until its step
        assert np.all(np.any(none.periods["tau_f"] != 0.0, axis=0))


def test_only_the_reference_itself_runs_without_friction() -> None:
    class Pretender(Ideal):
        """Calls itself a kind of ideal."""

    recording = episodes(STICTION).record(Pretender(), "ideal")
    assert np.any(recording.periods["tau_f"] != 0.0)


class Shaking:
    """Moves every joint at once, and has a memory."""

    feedback = "nominal"

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        self.gain = 10.0 * joints.motor_inertia
        self.sum = np.zeros((num_envs, joints.dof))

    def estimate(self, signals: Signals) -> np.ndarray:
        self.sum += signals.theta - signals.theta_n + 1e-3 * signals.tau_j
        return 10.0 + self.gain * np.sin(self.sum)


@pytest.mark.parametrize("env_id", DOF)
def test_a_batch_is_its_seeds_one_by_one(env_id: str) -> None:
    seeds = (11, 5, 2_000_003)
    arguments: dict[str, Any] = {"variant": "randomized", "duration": 0.2}
    together = evaluate(Shaking(), env_id, seeds=seeds, **arguments)
    for i, seed in enumerate(seeds):
        alone = evaluate(Shaking(), env_id, seeds=[seed], **arguments)
        expected = together.iloc[[i]].reset_index(drop=True)
        pd.testing.assert_frame_equal(alone, expected, check_exact=True)
    assert together["seed"].tolist() == list(seeds)
    assert together["joint_rms_error_ju"].nunique() == 3


def test_the_seed_list_is_passed_on() -> None:
    starts = {seed: episodes(SQUARE, (seed,)).record(Ideal(), "ideal").ticks["theta"][0, 0] for seed in (0, 1, 2)}
    both = episodes(SQUARE, (2, 0)).record(Ideal(), "ideal").ticks["theta"][0]
    np.testing.assert_array_equal(both, [starts[2], starts[0]])
    assert len({tuple(start) for start in starts.values()}) == 3


# Early ends


def push_one(which: int, level: float = -150.0) -> Callable[[Signals, int], np.ndarray]:
    """Push the joints of one episode of the batch out of their range, and return NaN there when it has ended."""

    def answer(signals: Signals, tick: int) -> np.ndarray:
        estimate = np.zeros_like(signals.theta)
        estimate[which] = level if tick < 400 else math.nan
        return estimate

    return answer


def test_an_early_end_is_held_and_spoils_nobody() -> None:
    batch = episodes(SQUARE, (1, 2, 3), duration=0.5)
    pushed, calm = batch.record(Answering(push_one(1)), "pushed"), batch.record(NoCompensation(), "none")
    assert pushed.terminations == ["", "joint_limit", ""]
    end = int(pushed.ended[1])
    assert pushed.ended.tolist() == [500, end, 500]
    assert 0 < end < 400
    for name, values in pushed.ticks.items():
        assert np.all(values[end:, 1] == values[end, 1]), name
    for name, values in pushed.periods.items():
        assert np.all(values[end:, 1] == values[end - 1, 1]), name
    assert np.any(pushed.ticks["theta"][end, 1] != pushed.ticks["theta"][end - 1, 1])
    others = [{name: values[:, [0, 2]] for name, values in arrays(each).items()} for each in (pushed, calm)]
    assert_same(*others)

    references = References(batch.record(Ideal(), "ideal").motions, calm.motions)
    table = rows(batch, "pushed", pushed, references, NoCompensation())
    assert table["status"].tolist() == ["ok", "terminated", "ok"]
    assert table["error"].tolist() == ["", f"joint_limit at {end / 1000:.3f} s", ""]
    assert table["frr"][1] < -1.0
    assert table["frr"][[0, 2]].tolist() == [0.0, 0.0]
    others_than_frr = table[[name for name in METRICS if name != "frr"]]
    assert others_than_frr.loc[1].isna().all()
    assert others_than_frr.loc[0].notna().any()


def test_nobody_is_asked_when_all_episodes_have_ended() -> None:
    pushy = Answering(lambda signals, _: np.full_like(signals.theta, -150.0))
    recording = episodes(SQUARE, (1, 2), duration=0.5).record(pushy, "pushy")
    assert recording.terminations == ["joint_limit", "joint_limit"]
    assert pushy.tick + 1 == len(recording.seconds) == max(recording.ended) < 500
    assert recording.ticks["theta"].shape == (501, 2, 7)
    assert all(np.isfinite(values).all() for values in arrays(recording).values())


def test_numbers_that_explode_end_the_episode_on_the_last_finite_ones(tmp_path: Any, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)  # MuJoCo leaves a log there
    batch = episodes(STICTION, (1, 2), duration=0.05, joints=STRONG)
    with np.errstate(all="ignore"):
        recording = batch.record(Answering(push_one(1, 1e307)), "bomb")
    assert recording.terminations == ["", "non_finite"]
    assert all(np.isfinite(values).all() for values in arrays(recording).values())
    calm = batch.record(NoCompensation(), "none")
    np.testing.assert_array_equal(recording.ticks["q"][:, 0], calm.ticks["q"][:, 0])
