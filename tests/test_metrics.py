"""What metrics are, each and all: columns, directions, the registry, and what they are of an episode at rest."""

from __future__ import annotations

import math
import pkgutil
from dataclasses import replace
from importlib.metadata import EntryPoint
from typing import Any

import numpy as np
import pytest
from metric_episodes import JOINT_SIGNALS, OVER_PERIODS, OVER_TICKS, PERIODS, PUSH, STEP, TIME, WINDOW, episode
from metric_hands import HAND

from fo_gym.evaluation import metrics
from fo_gym.evaluation.episode.record import Episode
from fo_gym.evaluation.metrics import GROUP, METRICS, registry, score


def test_an_episode_at_rest_leaves_everything_empty_that_needs_more() -> None:
    applies = {name for name, value in score(episode()).items() if not math.isnan(value)}
    effort = {"control_effort_ratio", "torque_roughness_ratio"}
    assert applies == {"steady_state_error_ju", "joint_rms_error_ju", "observer_work_in_stiction_j"} | effort


def test_only_the_headline_survives_an_early_end() -> None:
    scores = score(episode(none=1.0, theta=2.0, termination="joint_limit", push=PUSH, **STEP))
    assert scores.pop("frr") == pytest.approx(-1.0)
    assert all(math.isnan(value) for value in scores.values())


def busy_episode(rng: np.random.Generator) -> Episode:
    """Something of everything, different in every joint."""
    fields: dict[str, Any] = {name: rng.normal(size=(len(TIME), 2)) for name in OVER_TICKS}
    fields |= {name: np.cumsum(rng.normal(size=(len(PERIODS), 2)), axis=0) for name in OVER_PERIODS}
    fields["theta_dot"] *= 1e-4
    fields["tau_f_hat"] = fields["tau_dist"] + rng.normal(size=(len(PERIODS), 2))
    theta, ideal, none = rng.normal(size=(3, len(TIME), 2))
    tool, tool_d, tool_none = rng.normal(size=(3, len(TIME), 3))
    windows = {"step_time": 1.0, "motion_window": (0.0, 12.0), "push": PUSH, **WINDOW}
    tools = {"tool": tool, "tool_d": tool_d, "tool_none": tool_none}
    tools |= {"tool_ideal": rng.normal(size=(len(TIME), 3)), "pulls": rng.normal(size=(3, len(PERIODS), 3))}
    works = {"losses": rng.normal(size=(3, len(PERIODS))), "damped": rng.normal(size=len(PERIODS)), "hand": HAND}
    return episode(theta=theta, ideal=ideal, none=none, **tools, **works, **windows, **fields)


def mapped(source: Episode, joints: Any) -> Episode:
    """The episode with `joints` applied to every signal of the joints."""
    moved = {name: getattr(source, name) for name in ("motion", "ideal", "none")}
    motions = {name: replace(each, theta=joints(each.theta)) for name, each in moved.items()}
    return replace(source, **motions, **{name: joints(getattr(source, name)) for name in JOINT_SIGNALS})


@pytest.mark.parametrize("joints", [lambda signal: signal[:, ::-1], np.negative], ids=["reordered", "mirrored"])
def test_order_and_direction_of_joints_do_not_matter(joints: Any) -> None:
    source = busy_episode(np.random.default_rng(3))
    before, after = score(source), score(mapped(source, joints))
    assert after == pytest.approx(before, rel=1e-6, nan_ok=True)
    assert not any(math.isnan(value) for value in before.values())


def test_scores_follow_the_registry() -> None:
    scores = score(episode())
    assert next(iter(METRICS)) == "frr"
    assert list(scores) == list(METRICS)
    assert all(type(value) is float for value in scores.values())
    with pytest.raises(TypeError):
        METRICS["frr"] = METRICS["frr"]  # type: ignore[index]


@pytest.mark.parametrize("each", METRICS.values(), ids=METRICS)
def test_metric_says_what_it_is(each: registry.Metric) -> None:
    assert each.name == "frr" or each.name.endswith(registry.UNIT_ENDINGS[each.unit])
    assert each.description.endswith(".")
    assert 0.0 <= each.tolerance.exact <= each.tolerance.hardware
    assert not each.where or METRICS[each.where].share


def test_every_module_of_metrics_is_a_family() -> None:
    files = {module.name for module in pkgutil.iter_modules(metrics.__path__)} - {"registry", "reductions"}
    assert files == {each.function.__module__.rpartition(".")[2] for each in METRICS.values()}


WRONG = [
    ("frr", "1", "higher", "exists already"),
    ("jerk", "1", "lower", "must end in '_ratio'"),
    ("jerk_mps3", "m/s^3", "lower", "use one of"),
    ("jerk_ratio", "1", "smaller", "use 'lower' or 'higher'"),
]


@pytest.mark.parametrize(("name", "unit", "better", "message"), WRONG)
def test_a_wrong_registration_is_refused(name: str, unit: str, better: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        registry.metric(name, unit=unit, better=better, tolerance=registry.Tolerance(0.0, 0.0))(lambda _: 0.0)


def test_a_tolerance_is_wider_where_sensors_quantise() -> None:
    tolerance = registry.Tolerance(0.1, 0.5)
    for variant, limit in (("nominal", 0.1), ("randomized", 0.1), ("hardware", 0.5)):
        assert tolerance.holds(0.0, -0.99 * limit, variant)
        assert not tolerance.holds(0.0, 1.01 * limit, variant)
        assert tolerance.holds(1e6, 1e6 + limit + 19.9, variant)  # two units in the sixth digit
        assert not tolerance.holds(-1e6, -1e6 - limit - 20.1, variant)
        assert tolerance.holds(math.nan, math.nan, variant)
        assert not tolerance.holds(math.nan, 0.0, variant)
        assert not tolerance.holds(0.0, math.nan, variant)


def test_a_module_of_metrics_that_cannot_be_had_is_named(monkeypatch):
    """Nothing of it is left out in silence: whoever asks for the metrics is told what to mend."""
    entry = EntryPoint("theirs", "no_such_module_of_theirs", GROUP)
    monkeypatch.setattr("fo_gym.evaluation.metrics.entry_points", lambda *, group: [entry])
    with pytest.raises(ValueError, match="the metrics of no_such_module_of_theirs cannot be loaded: ModuleNotFound"):
        list(type(METRICS)())
