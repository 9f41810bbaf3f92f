"""Every metric on signals whose answer is known in closed form, and where it does not apply."""

from __future__ import annotations

import math
import pkgutil
from dataclasses import replace
from importlib.metadata import EntryPoint
from typing import Any

import numpy as np
import pytest

from fo_gym.evaluation import metrics
from fo_gym.evaluation.episode.record import Episode, Motion, Push
from fo_gym.evaluation.metrics import GROUP, METRICS, registry, score
from fo_gym.tasks.hand import Hand

DT = 1e-3
TIME = np.arange(20_001) * DT
PERIODS = TIME[:-1]
OVER_TICKS = ("theta_dot", "q", "q_dot", "theta_n", "theta_n_dot", "theta_d")
OVER_PERIODS = ("tau_f_hat", "tau_f", "tau_m", "tau_ext")
JOINT_SIGNALS = (*OVER_TICKS, *OVER_PERIODS)
ABSENT = dict.fromkeys(("tool_d", "step_time", "limit_cycle_window", "motion_window", "push", "hand", "damped"))
FIXED = {"torque_limit": np.full(2, 10.0), "joint_unit": "rad", "termination": ""}


def over(length: int, size: int, value: Any) -> np.ndarray:
    """A number, (length,), (size,) or (length, size) as a signal (length, size)."""
    value = np.asarray(value, dtype=float)
    return np.broadcast_to(value[:, None] if value.shape == (length,) else value, (length, size))


def motion(theta: Any, tool: Any, f_hand: Any = None, lost: Any = None) -> Motion:
    return Motion(over(len(TIME), 2, theta), None if tool is None else over(len(TIME), 3, tool), f_hand, lost)


def episode(*, theta: Any = 0.0, ideal: Any = 0.0, none: Any = 0.0, tool: Any = None, **changes: Any) -> Episode:
    """20 s of two joints at rest of which only the given parts differ; the tools of the references are at 0.

    `pulls` are the forces of the hand, `losses` what friction takes: of the arm, the ideal one, and that without
    compensation.
    """
    fields: dict[str, Any] = {**ABSENT, **FIXED, **dict.fromkeys(JOINT_SIGNALS, 0.0), **changes}
    fields |= {name: over(len(TIME), 2, fields[name]) for name in OVER_TICKS}
    fields |= {name: over(len(PERIODS), 2, fields[name]) for name in OVER_PERIODS}
    tools = [None if tool is None else fields.pop(name, 0.0) for name in ("tool_ideal", "tool_none")]
    guided = [*zip(*(fields.pop(name, (None, None, None)) for name in ("pulls", "losses")), strict=True)]
    references = {"ideal": motion(ideal, tools[0], *guided[1]), "none": motion(none, tools[1], *guided[2])}
    return Episode(DT, motion=motion(theta, tool, *guided[0]), **references, **fields)


def columns(*joints: Any) -> np.ndarray:
    return np.stack(np.broadcast_arrays(*joints), axis=-1)


def stick_slip(period: float) -> np.ndarray:
    """From 0 to 1 and back in pairs of slips, 0.3 s apart."""
    slips = np.repeat([0.0, 0.3, period / 2, period / 2 + 0.3], 2)
    return np.interp(TIME % period, slips, [0, 0.5, 0.5, 1, 1, 0.5, 0.5, 0])


def friction(delay: float = 0.0) -> np.ndarray:
    """A burst of friction around 4 s and a reversal at 8 s, both smooth, `delay` late."""
    late = PERIODS - delay
    return np.exp(-(((late - 4.0) / 0.2) ** 2)) + np.tanh((late - 8.0) / 0.05)


def line(lag: Any = 0.0, offset: Any = 0.0) -> np.ndarray:
    """A tool on a line along x at 0.1 m/s, at rest after 10 s, `lag` behind and `offset` beside its path [m]."""
    return columns(0.1 * np.minimum(TIME, 10.0) - lag, offset, 0.0)


def observer(*tau_f_hat: float) -> dict[str, Any]:
    """Joints stuck from 1 to 1.5 s and sliding otherwise, while e grows by 0.1 per s all the time."""
    stuck = (TIME > 0.9995) & (TIME < 1.5005)
    return {"theta": TIME, "theta_n": 1.1 * TIME, "theta_dot": np.where(stuck, 0.0, 1.0), "tau_f_hat": tau_f_hat}


def bursts(speed: float, *starts: float) -> np.ndarray:
    """At rest, but for 10 ms of `speed` from each of the starts [s]."""
    return speed * sum((np.abs(TIME - start - 0.0049) < 0.005).astype(float) for start in starts)


def rowing(share: float) -> dict[str, Any]:
    """To and fro against a friction of 2, of which the estimate takes a share."""
    direction = np.where(np.arange(len(PERIODS)) // 100 % 2, -1.0, 1.0)
    theta = np.concatenate([[0.0], np.cumsum(1e-3 * direction)])
    return {"theta": theta, "tau_f": -2.0 * direction, "tau_f_hat": -2.0 * share * direction}


FLIP = np.where(np.arange(len(PERIODS)) % 2, -1.0, 1.0)
RING = np.exp(-0.4 * TIME) * np.cos(5.0 * TIME)
RIPPLE = 0.1 * np.sin(20 * np.pi * TIME)
REST = {"theta": 0.5 + columns(np.where(TIME < 13.0005, 0.002, 0.007), -0.003), "theta_d": 0.5}
PUSH = Push(13.0, 0.5, np.array([10.0, 0.0]))
WINDOW = {"limit_cycle_window": (10.0, 20.0)}
SLIDE = {"ideal": TIME, **WINDOW}
STEP = {"step_time": 3.0, "theta_d": columns(np.where(TIME < 2.9995, 0.0, -0.1), 0.0)}
RISE = columns(np.where(TIME < 3.0, 0.0, -0.1 * (1 - np.exp(-(TIME - 3.0) / 0.5))), 0.0)
SETTLED = math.ceil(0.5 * math.log(50) / DT) * DT
UNDERDAMPED = np.exp(-0.6 * TIME) * (np.cos(0.8 * TIME) + 0.75 * np.sin(0.8 * TIME))  # 1 / (s^2 + 1.2 s + 1)
PATH = {"motion_window": (0.0, 10.0), "tool_d": line()}
BESIDE = 2e-3 * (np.abs(TIME - 4.05) < 0.04) + 5e-3 * (np.abs(TIME - 7.0) < 0.5)
GLITCH = {"tool": line(0.0, BESIDE), "tool_ideal": line(), **PATH, "motion_window": (1.0, 10.0)}
ROUND = columns(np.cos(0.6 * TIME), np.sin(0.6 * TIME), 0.0)
CORNERS = 0.1 * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])[np.minimum(TIME // 2, 3).astype(int)]
PUSHED = {"push": Push(1.0, 1.0, np.ones(2)), "tau_ext": columns(2.0 * (np.abs(PERIODS - 1.4999) < 0.5), 0.0)}

HAND = Hand(1.0, 3, 0.5, 0.5, 0.1, 0.15, 0.1, 1000.0, 30.0, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
WAY, SPEED = HAND.at(TIME)
HELD = HAND.let_go > PERIODS


def pull(friction: float, damping: float = 50.0) -> np.ndarray:
    """Force of HAND on an arm that follows it, under 200 N/m, a damper [N s/m] and dry friction [N]."""
    midway, slow = (WAY[1:] + WAY[:-1]) / 2, np.abs(np.diff(WAY)) < 1e-12
    resistance = damping * (SPEED[1:] + SPEED[:-1]) / 2 + friction * np.where(slow, 0.0, np.sign(np.diff(WAY)))
    return HELD[:, None] * columns(200.0 * midway + resistance, 0.3, -0.2)


def gone(x: float, y: float) -> np.ndarray:
    """The tool follows HAND, and is at (x, y, 0) from a second after it let go [m]."""
    free = (HAND.let_go + 1.0 < TIME)[:, None]
    return np.where(free, [x, y, 0.0], columns(WAY, 0.0, 0.0))


GUIDED: dict[str, Any] = {"tool": gone(0.003, 0.004), "tool_ideal": gone(0.0, 0.0), "tool_none": gone(0.0, 0.0)}
GUIDED |= {"tool_d": 0.0 * TIME[:, None], "hand": HAND, "pulls": (pull(6.0), pull(0.0), pull(24.0))}
HOLDS = np.where((PERIODS > 0.9999) & (PERIODS < 7.5999), DT, 0.0)  # from the grip until it has let go
GUIDED |= {"losses": (6.0 * HOLDS, 0.0 * HOLDS, 24.0 * HOLDS), "damped": 0.0 * HOLDS}
DAMPED = 50.0 * float(np.sum((SPEED[1:] + SPEED[:-1]) / 2 * np.diff(WAY)))
SPENT = 0.5 * 200.0 * 0.15**2 + DAMPED
"""Work of the hand on the ideal arm: what the spring holds and the damper took, up to a thousandth."""
BURST = DT * np.where(np.abs(PERIODS - 5.4999) < 0.5, -2.0, 1.0)
"""What friction takes where the compensation gives 2 J within a second, else 1 J/s."""


def fed(energy: Any) -> dict[str, Any]:
    """GUIDED with this in place of what friction takes of the arm."""
    return {**GUIDED, "losses": (energy, *GUIDED["losses"][1:])}


CLOSED_FORM: list[tuple[str, float, dict[str, Any]]] = [
    ("frr", 0.75, {"ideal": 1.0, "none": [4.0, 5.0], "theta": [1.75, 2.0]}),
    ("frr", 1 - math.sqrt(10_000 / 20_001 / 2), {"none": 1.0, "theta": columns(TIME > 10.0, 0.0)}),
    ("frr", 0.5, {"theta": 9.0, "tool": line(0.1), "tool_ideal": line(), "tool_none": line(0.0, 0.2), **PATH}),
    ("steady_state_error_before_push_ju", 0.003, {**REST, "push": PUSH, "step_time": 12.0}),
    ("steady_state_error_ju", 0.007, {**REST, "push": PUSH}),
    ("steady_state_error_ju", 0.01, {"theta": 0.01 * np.cos(np.pi * np.arange(len(TIME)))}),
    (
        "limit_cycle_peak_to_peak_ju",
        0.006,
        {"theta": columns(0.1 + 0.02 * TIME + 3e-3 * np.sin(3 * TIME), 0), **WINDOW},
    ),
    ("limit_cycle_peak_to_peak_ju", 1e-3, {"theta": 1e-3 * stick_slip(8.3), **WINDOW}),
    ("limit_cycle_peak_to_peak_ju", 1e-3, {"theta": RING + 1e-3 * stick_slip(3.0), "ideal": RING, **WINDOW}),
    ("limit_cycle_peak_to_peak_ju", 0.0, {"theta": 0.01, "ideal": RING, **WINDOW}),
    ("limit_cycle_peak_to_peak_ju", 0.0, {"theta": RING, "ideal": RING, **WINDOW}),
    ("limit_cycle_period_s", 4.0, {"theta": 1e-3 * columns(RIPPLE + stick_slip(4.0), stick_slip(2.0)), **WINDOW}),
    ("limit_cycle_period_s", 9.5, {"theta": 1e-3 * stick_slip(9.5) + 1e-5 * TIME, **WINDOW}),
    ("limit_cycle_period_s", 1.7, {"theta": np.sin(2 * np.pi * TIME / 1.7) + 0.1 * TIME, **WINDOW}),
    ("stick_slip_count", 3.0, {"theta_dot": bursts(0.04, 9.0, 11.0, 13.0, 13.05, 13.1, 17.0), **SLIDE}),
    ("stick_slip_count", 1.0, {"theta_dot": columns(bursts(0.02, 11.0, 12.0), bursts(-9.0, 16.0)), **SLIDE}),
    ("stick_slip_count", 0.0, {"theta_dot": 0.01 * np.sin(20 * TIME) + bursts(9.0, 12.0, 15.0), **SLIDE}),
    ("stick_slip_count", 6.0, {"theta_dot": np.where(TIME % 1.6 < 0.3, 0.0, 0.5), **SLIDE}),
    ("settling_time_s", SETTLED, {"theta": RISE, **STEP}),
    ("settling_time_s", SETTLED, {"theta": RISE + 0.1 * (TIME > 13.0005)[:, None], "push": PUSH, **STEP}),
    ("settling_time_s", 10.0, {"push": PUSH, **STEP}),
    ("settling_time_s", 17.0, {"push": replace(PUSH, time=1.0), **STEP}),
    ("settling_time_s", 0.0, {"theta": STEP["theta_d"], **STEP}),
    ("overshoot_percent", 100 * math.exp(-0.75 * math.pi), {"theta": -UNDERDAMPED, "ideal": -1.0, "step_time": 0.0}),
    ("overshoot_percent", 30.0, {"theta": columns(-0.13 * (TIME > 4.0), 0.0), **STEP}),
    ("overshoot_percent", 0.0, {"theta": RISE, **STEP}),
    ("joint_rms_error_ju", 0.03, {"theta": columns(TIME + 0.02, TIME - 0.03), "theta_d": TIME}),
    ("tool_rms_error_mm", 50.0, {"tool": line(0.03, 0.04), **PATH}),
    ("tool_rms_error_mm", 10 * math.sqrt(2500 / 10_001), {"tool": line(0.0, 0.01 * (TIME > 7.5)), **PATH}),
    ("tool_max_error_mm", 10.0, {"tool": line(0.0, 0.01 * (TIME == 7.5) + (TIME > 11.0)), **PATH}),
    ("contour_error_mm", 4.0, {"tool": line(np.minimum(0.02, 0.1 * TIME), 0.004), **PATH}),
    ("contour_error_mm", 5.0, {"tool": [0.003, 0.0, 0.004], **PATH, "tool_d": np.zeros((len(TIME), 3))}),
    ("contour_error_mm", 5.0, {"tool": [1.003, 0.0, 0.004], **PATH}),
    ("contour_error_mm", 2.0, {"tool": 0.102 * ROUND[::-1], "tool_d": 0.1 * ROUND, "motion_window": (0.0, 20.0)}),
    ("contour_error_mm", 4.0, {"tool": columns(0.096, np.where(TIME < 5, 0.04, 0.06), 0), **PATH, "tool_d": CORNERS}),
    ("quadrant_glitch_mm", 2.0, {**GLITCH, "theta_d": columns(0.0, np.abs(TIME - 4.0))}),
    ("quadrant_glitch_mm", 2.0, {**GLITCH, "theta_d": np.maximum(np.abs(TIME - 3.5), 0.5)}),
    ("estimate_rmse_ratio", 0.3, {"tau_f": columns(FLIP, 5.0), "tau_f_hat": columns(0.7 * FLIP, 4.0)}),
    ("estimate_rmse_ratio", 1.0, {"tau_f": columns(FLIP, 0.0), "tau_f_hat": [0.0, 9.0]}),
    ("estimate_lag_ms", 12.3, {"tau_f": columns(friction(), 0.1), "tau_f_hat": columns(0.5 * friction(0.0123), 9)}),
    ("estimate_lag_ms", -300.0, {"tau_f": friction(), "tau_f_hat": friction(-0.3) + 1.0}),
    ("observer_work_in_stiction_j", -0.5 * 0.1 * 3.0, observer(-2.0, 3.0)),
    ("observer_work_in_stiction_j", 0.5 * 0.1 * 2.0, observer(-2.0, -3.0)),
    ("over_compensation_ratio", 0.0, rowing(0.0)),
    ("over_compensation_ratio", 0.0, rowing(1.0)),
    ("over_compensation_ratio", 0.5, rowing(1.5)),
    ("over_compensation_ratio", 0.0, rowing(-1.0)),
    ("over_compensation_ratio", 0.3 / 1.2, {"theta": TIME, "tau_f": [-1.0, -0.2], "tau_f_hat": [-1.2, -0.3]}),
    ("over_compensation_ratio", 0.5, {"theta": TIME, "tau_f": [-1.0, 3.0], "tau_f_hat": [-0.5, -0.5]}),
    ("passivity_index_j", -0.2, {"q_dot": columns(0.1 - 0.4 * (TIME - 1.0), 7.0), **PUSHED}),
    ("passivity_index_j", 0.0, {"q_dot": 0.3, "push": replace(PUSH, time=0.0), "tau_ext": 2.0}),
    ("hand_work_j", SPENT + 6.0 * 0.45, GUIDED),
    ("hand_work_j", SPENT - 2.0 * 0.45, {**GUIDED, "pulls": (pull(-2.0), pull(0.0), pull(24.0))}),
    ("hand_friction_work_ratio", 0.25, GUIDED),
    ("hand_friction_work_ratio", 0.5, fed(-12.0 * HOLDS + 9.0 * (HOLDS == 0.0))),
    ("apparent_friction_n", 6.0, GUIDED),
    ("apparent_friction_n", 4.0, {**GUIDED, "pulls": (pull(2.0, 70.0), pull(0.0), pull(24.0))}),
    ("apparent_friction_n", 3.0, {**GUIDED, "pulls": (pull(-3.0), pull(0.0), pull(24.0))}),
    ("return_error_mm", 5.0, GUIDED),
    ("hand_energy_created_j", 2.0, fed(BURST)),
    ("hand_energy_created_j", 1.5, {**fed(BURST), "damped": 0.5 * DT + 0.0 * PERIODS}),
    ("hand_energy_created_j", 0.0, fed(np.abs(BURST))),
    ("hand_passivity_violation_count", 1.0, fed(BURST)),
    ("hand_passivity_violation_count", 0.0, fed(0.009 * SPENT / 2.0 * BURST)),
    ("control_effort_ratio", 0.5, {"tau_m": columns(FLIP, 3 * FLIP), "torque_limit": np.array([2.0, 10.0])}),
    ("torque_roughness_ratio", 0.6, {"tau_m": columns(9.0, 3 * FLIP)}),
]

DOES_NOT_APPLY: list[tuple[str, dict[str, Any]]] = [
    ("frr", {"none": 1e-10, "theta": 1.0}),
    ("steady_state_error_before_push_ju", {"push": PUSH, "step_time": 12.5}),
    ("steady_state_error_before_push_ju", {"push": PUSH, "motion_window": (0.0, 12.5)}),
    ("steady_state_error_before_push_ju", {"push": replace(PUSH, time=0.9)}),
    ("steady_state_error_before_push_ju", {"push": replace(PUSH, time=30.0)}),
    ("steady_state_error_ju", {"step_time": 19.5}),
    ("steady_state_error_ju", {"push": replace(PUSH, time=18.6)}),
    ("limit_cycle_peak_to_peak_ju", {"limit_cycle_window": (10.0, 20.001)}),
    ("limit_cycle_period_s", {"theta": 0.9e-5 * np.sin(TIME), **WINDOW}),
    ("limit_cycle_period_s", {"theta": 1.0 * (TIME > 15.0), **WINDOW}),
    ("stick_slip_count", WINDOW),
    ("stick_slip_count", {"ideal": TIME}),
    ("stick_slip_count", {"ideal": TIME, "limit_cycle_window": (10.0, 20.001)}),
    ("settling_time_s", {"step_time": 3.0}),
    ("settling_time_s", {"step_time": 20.0, "theta_d": 1.0}),
    ("overshoot_percent", {"step_time": 3.0}),
    ("tool_max_error_mm", {"tool": 1.0, **PATH, "motion_window": (21.0, 22.0)}),
    ("quadrant_glitch_mm", {"tool": 1.0, **PATH, "theta_d": TIME}),
    ("quadrant_glitch_mm", {"tool": 1.0, **PATH, "theta_d": np.minimum(TIME, 3.0)}),
    ("estimate_lag_ms", {"tau_f": friction()}),
    ("estimate_lag_ms", {"tau_f": friction(), "tau_f_hat": 3.0}),
    ("estimate_lag_ms", {"tau_f": friction() + PERIODS, "tau_f_hat": friction() - PERIODS}),
    ("estimate_lag_ms", {"tau_f": friction(), "tau_f_hat": friction(0.7)}),
    ("estimate_lag_ms", {"tau_f": PERIODS, "tau_f_hat": PERIODS - 0.1}),
    ("observer_work_in_stiction_j", {"theta_dot": 2e-4, "tau_f_hat": 1.0}),
    ("over_compensation_ratio", {"theta": TIME, "tau_f": 2.0, "tau_f_hat": -1.0}),
    ("passivity_index_j", {"push": replace(PUSH, time=20.0)}),
    ("hand_work_j", {**GUIDED, "hand": replace(HAND, grip=20.0)}),
    ("hand_friction_work_ratio", {**GUIDED, "losses": (HOLDS, HOLDS, 0.0 * HOLDS)}),
    ("apparent_friction_n", {**GUIDED, "hand": replace(HAND, strokes=1)}),
    ("apparent_friction_n", {**GUIDED, "tool": 0.1}),
    ("return_error_mm", {**GUIDED, "hand": replace(HAND, rest=12.0)}),
    ("hand_energy_created_j", {**GUIDED, "hand": None}),
    ("hand_passivity_violation_count", {**GUIDED, "hand": None}),
]


@pytest.mark.parametrize(("name", "expected", "fields"), CLOSED_FORM, ids=[case[0] for case in CLOSED_FORM])
def test_closed_form(name: str, expected: float, fields: dict[str, Any]) -> None:
    assert score(episode(**fields))[name] == pytest.approx(expected, rel=1e-5, abs=1e-9)


def test_every_metric_has_a_closed_form() -> None:
    assert {name for name, _, _ in CLOSED_FORM} == set(METRICS)


@pytest.mark.parametrize(("name", "fields"), DOES_NOT_APPLY, ids=[case[0] for case in DOES_NOT_APPLY])
def test_does_not_apply(name: str, fields: dict[str, Any]) -> None:
    assert math.isnan(score(episode(**fields))[name])


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
    fields["tau_f_hat"] = fields["tau_f"] + rng.normal(size=(len(PERIODS), 2))
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
