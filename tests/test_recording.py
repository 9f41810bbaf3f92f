"""What is kept of an episode, what a compensator gets to see, and what happens when it misbehaves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import pandas as pd
import pytest

from fo_gym import CompensatorError, FlexibleJoint, JointInfo, Signals, evaluate, make_compensator
from fo_gym.compensators import Ideal, NoCompensation
from fo_gym.evaluation.evaluate import EpisodeSet, rows
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.recording import Recording, References
from fo_gym.sensors import SIGNALS

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
DOF = {STICTION: 1, REGULATION: 7, SQUARE: 7}
PRIVATE = ("q", "q_dot", "z", "tau_f")
STRONG = FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=1e308)


class Answering:
    """A compensator whose answer to tick k is `answer(signals, k)`."""

    def __init__(self, answer: Callable[[Signals, int], Any], feedback: str = "measured") -> None:
        self.answer = answer
        self.feedback = feedback
        self.tick = -1

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        self.joints, self.num_envs = joints, num_envs

    def estimate(self, signals: Signals) -> Any:
        self.tick += 1
        return self.answer(signals, self.tick)


def silent(signals: Signals, _: int) -> np.ndarray:
    return np.zeros_like(signals.theta)


def episodes(env_id: str, seeds: tuple[int, ...] = (7,), duration: float = 0.1, **kwargs: Any) -> EpisodeSet:
    return EpisodeSet(env_id, "randomized", seeds, {"duration": duration, **kwargs})


def arrays(recording: Recording) -> dict[str, np.ndarray]:
    return {**recording.ticks, **recording.periods}


def assert_same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    assert one.keys() == other.keys()
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name], err_msg=name, strict=True)


# What a compensator sees


def contents(thing: Any, path: str) -> dict[str, Any]:
    """All plain values that can be reached from `thing` by attributes, by the way that leads there."""
    if is_dataclass(thing):
        names = {*(field.name for field in fields(thing)), *vars(thing)}
        return {k: v for name in names for k, v in contents(getattr(thing, name), f"{path}.{name}").items()}
    if isinstance(thing, np.ndarray) and thing.base is not None:
        return {path: thing, **contents(thing.base, f"{path}.base")}
    return {path: thing}


@pytest.mark.parametrize("env_id", DOF)
def test_no_compensator_sees_the_truth(env_id: str) -> None:
    truth: dict[str, list[np.ndarray]] = {name: [] for name in PRIVATE}
    seen: dict[str, list[Any]] = {}

    def look(signals: Signals, _: int) -> np.ndarray:
        for path, value in (contents(signals, "signals") | contents(spy.joints, "joints")).items():
            seen.setdefault(path, []).append(np.copy(value) if isinstance(value, np.ndarray) else value)
        return silent(signals, 0)

    spy = Answering(look)
    env = gym.make_vec(env_id, num_envs=2, variant="randomized", duration=0.1)
    _, info = env.reset(seed=[7, 8])
    for _ in range(100):
        for name in PRIVATE:
            truth[name].append(info[name])
        _, _, _, _, info = env.step(np.zeros((2, DOF[env_id])))
    episodes(env_id, (7, 8)).record(spy, "spy")

    expected = {f"signals.{name}" for name in (*SIGNALS, "reference", "available")}
    expected |= {f"joints.{name}" for name in ("dof", "motor_inertia", "stiffness", "torque_limit", "control_dt")}
    assert {path for path in seen if not path.endswith(".base")} == expected
    simulation = env.unwrapped.simulation
    secrets = {name: np.array(values) for name, values in truth.items()}
    for field in ("sigma_0", "sigma_1", "sigma_2", "f_c", "f_s", "v_s"):
        secrets[field] = np.array([getattr(each.friction, field) for each in simulation.scenarios])
    secrets["M"] = simulation.plant.body.dense_inertia(info["q"])
    for path, values in seen.items():
        if isinstance(values[0], np.ndarray):
            for name, secret in secrets.items():
                shared = np.intersect1d(np.array(values), secret[secret != 0.0])
                # At rest without gravity the spring is relaxed: motor and link are where they started.
                at_rest = np.intersect1d(values[0], secret) if name == "q" else []
                assert set(shared) <= set(at_rest), f"{name} in {path}"
    env.close()


def test_it_does_see_what_it_should() -> None:
    """The search above finds a value that is there."""
    signals = Signals.from_observation(np.array([np.arange(8.0)]), 1)
    found = contents(signals, "signals")
    assert found["signals.tau_c"] == 6.0
    assert found["signals.tau_c.base"].shape == (1, 8)


@pytest.mark.parametrize("env_id", DOF)
def test_writing_into_what_it_sees_changes_nothing(env_id: str) -> None:
    def vandalize(signals: Signals, _: int) -> np.ndarray:
        for thing in (*contents(signals, "").values(), *contents(vandal.joints, "").values()):
            if isinstance(thing, np.ndarray) and thing.flags.writeable:
                thing[...] = 1.2345678
        return np.zeros((vandal.num_envs, vandal.joints.dof))

    vandal = Answering(vandalize)
    batch = episodes(env_id, (7, 8))
    assert_same(arrays(batch.record(vandal, "vandal")), arrays(batch.record(Answering(silent), "silent")))


def test_writing_into_an_old_answer_changes_nothing() -> None:
    buffer = np.zeros((1, 1))

    def reuse(_: Signals, tick: int) -> np.ndarray:
        buffer[:] = 0.01 * tick
        return buffer

    fresh = Answering(lambda _, tick: np.full((1, 1), 0.01 * tick))
    batch = episodes(STICTION)
    assert_same(arrays(batch.record(Answering(reuse), "reuse")), arrays(batch.record(fresh, "fresh")))


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
    for one, other in zip(ideal.pushes, none.pushes, strict=True):
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
    table = rows(batch, "pushed", pushed, references)
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


# Compensators that misbehave


def explode(*_: Any) -> Any:
    raise KeyError("oops")


def from_tick_3(value: Any) -> Callable[[Signals, int], Any]:
    return lambda signals, tick: value if tick >= 3 else silent(signals, tick)


BROKEN: list[tuple[Callable[[Signals, int], Any], str]] = [
    (lambda signals, tick: explode() if tick == 3 else silent(signals, tick), "estimate raised KeyError at tick 3"),
    (from_tick_3(np.array([[0.0], [math.nan]])), r"returned \[nan\] at tick 3 in episode 1; it must be finite"),
    (from_tick_3(np.array([[math.inf], [0.0]])), r"returned \[inf\] at tick 3 in episode 0; it must be finite"),
    (from_tick_3(np.zeros(2)), r"shape \(2,\) at tick 3; \(num_envs, dof\) is \(2, 1\)"),
    (from_tick_3(np.zeros((2, 2))), r"shape \(2, 2\) at tick 3; \(num_envs, dof\) is \(2, 1\)"),
    (from_tick_3(0.0), r"shape \(\) at tick 3"),
    (from_tick_3(None), "at tick 3"),
    (from_tick_3("zero"), "estimate .* at tick 3"),
]


@pytest.mark.parametrize(("answer", "message"), BROKEN)
def test_a_broken_estimate_is_named(answer: Callable[[Signals, int], Any], message: str) -> None:
    with pytest.raises(CompensatorError, match=f"^who: .*{message}"):
        episodes(STICTION, (1, 2)).record(Answering(answer), "who")


def test_a_broken_reset_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Answering, "reset", explode)
    with pytest.raises(CompensatorError, match=r"^Answering: reset raised KeyError: 'oops'"):
        evaluate(Answering(silent), STICTION, duration=0.1)


def test_gains_that_do_not_fit_the_sampling_are_named() -> None:
    with pytest.raises(CompensatorError, match=r"^PDObserver: reset raised ValueError.*too fast"):
        evaluate(make_compensator("pd-low", L=250.0), STICTION, duration=0.1, decimation=5)


@pytest.mark.parametrize("value", [np.array([[1], [-2]]), [[1], [-2]], np.array([[1.0], [-2.0]], dtype=np.float32)])
def test_whatever_is_a_finite_array_will_do(value: Any) -> None:
    batch = episodes(STICTION, (1, 2))
    exact = batch.record(Answering(lambda *_: np.array([[1.0], [-2.0]])), "exact")
    assert_same(arrays(batch.record(Answering(lambda *_: value), "other")), arrays(exact))
