"""Every metric on signals whose answer is known in closed form, and where it does not apply."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from metric_episodes import (
    CORNERS,
    FLIP,
    GLITCH,
    PATH,
    PERIODS,
    PUSH,
    PUSHED,
    REST,
    RING,
    RIPPLE,
    RISE,
    ROUND,
    SETTLED,
    SLIDE,
    STEP,
    TIME,
    UNDERDAMPED,
    WINDOW,
    bursts,
    columns,
    episode,
    friction,
    line,
    observer,
    rowing,
    stick_slip,
)
from metric_hands import HAND_CLOSED_FORM, HAND_DOES_NOT_APPLY

from fo_gym.evaluation.metrics import METRICS, score

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
    ("hunting_ratio", 1.0, {"theta": columns(0.0, 1.1e-4 * stick_slip(8.3)), **WINDOW}),
    ("hunting_ratio", 0.0, {"theta": columns(0.0, 0.9e-4 * stick_slip(8.3)), **WINDOW}),
    ("hunting_ratio", 0.0, {"theta": 1e-4 * TIME, **WINDOW}),
    ("hunting_ratio", 0.0, {"theta": RING, "ideal": RING, **WINDOW}),
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
    ("estimate_rmse_ratio", 0.3, {"tau_dist": columns(FLIP, 5.0), "tau_f_hat": columns(0.7 * FLIP, 4.0)}),
    ("estimate_rmse_ratio", 1.0, {"tau_dist": columns(FLIP, 0.0), "tau_f_hat": [0.0, 9.0]}),
    ("estimate_lag_ms", 12.3, {"tau_dist": columns(friction(), 0.1), "tau_f_hat": columns(0.5 * friction(0.0123), 9)}),
    ("estimate_lag_ms", -300.0, {"tau_dist": friction(), "tau_f_hat": friction(-0.3) + 1.0}),
    ("observer_work_in_stiction_j", -0.5 * 0.1 * 3.0, observer(-2.0, 3.0)),
    ("observer_work_in_stiction_j", 0.5 * 0.1 * 2.0, observer(-2.0, -3.0)),
    ("over_compensation_ratio", 0.0, rowing(0.0)),
    ("over_compensation_ratio", 0.0, rowing(1.0)),
    ("over_compensation_ratio", 0.5, rowing(1.5)),
    ("over_compensation_ratio", 0.0, rowing(-1.0)),
    ("over_compensation_ratio", 0.3 / 1.2, {"theta": TIME, "tau_dist": [-1.0, -0.2], "tau_f_hat": [-1.2, -0.3]}),
    ("over_compensation_ratio", 0.5, {"theta": TIME, "tau_dist": [-1.0, 3.0], "tau_f_hat": [-0.5, -0.5]}),
    ("passivity_index_j", -0.2, {"q_dot": columns(0.1 - 0.4 * (TIME - 1.0), 7.0), **PUSHED}),
    ("passivity_index_j", 0.0, {"q_dot": 0.3, "push": replace(PUSH, time=0.0), "tau_ext": 2.0}),
    ("passivity_violation_ratio", 1.0, {"q_dot": -0.3, **PUSHED, "stored": 0.59}),
    ("passivity_violation_ratio", 0.0, {"q_dot": -0.3, **PUSHED, "stored": 0.6}),
    ("passivity_violation_ratio", 1.0, {"q_dot": columns(0.1 - 0.4 * (TIME - 1.0), 7.0), **PUSHED, "stored": 0.19}),
    ("passivity_violation_ratio", 0.0, {"q_dot": columns(0.1 - 0.4 * (TIME - 1.0), 7.0), **PUSHED, "stored": 0.199}),
    ("passivity_violation_ratio", 0.0, {"q_dot": 0.3, **PUSHED, "stored": 0.0}),
    ("control_effort_ratio", 0.5, {"tau_m": columns(FLIP, 3 * FLIP), "torque_limit": np.array([2.0, 10.0])}),
    ("torque_roughness_ratio", 0.6, {"tau_m": columns(9.0, 3 * FLIP)}),
    *HAND_CLOSED_FORM,
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
    ("estimate_lag_ms", {"tau_dist": friction()}),
    ("estimate_lag_ms", {"tau_dist": friction(), "tau_f_hat": 3.0}),
    ("estimate_lag_ms", {"tau_dist": friction() + PERIODS, "tau_f_hat": friction() - PERIODS}),
    ("estimate_lag_ms", {"tau_dist": friction(), "tau_f_hat": friction(0.7)}),
    ("estimate_lag_ms", {"tau_dist": PERIODS, "tau_f_hat": PERIODS - 0.1}),
    ("observer_work_in_stiction_j", {"theta_dot": 2e-4, "tau_f_hat": 1.0}),
    ("over_compensation_ratio", {"theta": TIME, "tau_dist": 2.0, "tau_f_hat": -1.0}),
    ("passivity_index_j", {"push": replace(PUSH, time=20.0)}),
    ("passivity_violation_ratio", {"push": replace(PUSH, time=20.0), "stored": 0.0}),
    ("passivity_violation_ratio", {"q_dot": -0.3, **PUSHED, "stored": 0.0, "motion_window": (0.0, 1.5)}),
    ("passivity_violation_ratio", {"q_dot": -0.3, **PUSHED, "stored": 0.0, "step_time": 1.5}),
    ("hunting_ratio", {"theta": stick_slip(4.0)}),
    *HAND_DOES_NOT_APPLY,
]


@pytest.mark.parametrize(("name", "expected", "fields"), CLOSED_FORM, ids=[case[0] for case in CLOSED_FORM])
def test_closed_form(name: str, expected: float, fields: dict[str, Any]) -> None:
    assert score(episode(**fields))[name] == pytest.approx(expected, rel=1e-5, abs=1e-9)


def test_every_metric_has_a_closed_form() -> None:
    assert {name for name, _, _ in CLOSED_FORM} == set(METRICS)


@pytest.mark.parametrize(("name", "fields"), DOES_NOT_APPLY, ids=[case[0] for case in DOES_NOT_APPLY])
def test_does_not_apply(name: str, fields: dict[str, Any]) -> None:
    assert math.isnan(score(episode(**fields))[name])
