"""The claims of the paper: known verdicts, and verdicts that turn when something is broken on purpose.

Control at 1 kHz, which changes no verdict but those of the low-passes; the published table runs at 10 kHz.
"""

from __future__ import annotations

import numpy as np
import pytest

import fo_gym
from fo_gym.reproduction.claims import CLAIMS
from fo_gym.reproduction.statement import Finding, at_least, at_most, near
from fo_gym.reproduction.subject import Subject

COARSE = Subject(control_dt=1e-3, quick=True)
MODULES = ("algebra", "experiments", "panels", "rest", "stiction", "theorem2")
IDS = [name for name, claim in CLAIMS.items() if claim.group.rpartition(".")[2] in MODULES]


class WrongSign:
    """An observer whose estimate adds to friction."""

    def __init__(self, name: str) -> None:
        self._observer = fo_gym.make_compensator(name)
        self.feedback = self._observer.feedback

    def reset(self, joints: fo_gym.JointInfo, num_envs: int) -> None:
        self._observer.reset(joints, num_envs)

    def estimate(self, signals: fo_gym.Signals) -> np.ndarray:
        return -self._observer.estimate(signals)


class HalfFriction(WrongSign):
    """An observer that takes half of the friction that it sees."""

    def estimate(self, signals: fo_gym.Signals) -> np.ndarray:
        return 0.5 * self._observer.estimate(signals)


def measured_feedback(name: str) -> fo_gym.Compensator:
    compensator = fo_gym.make_compensator(name)
    compensator.feedback = "measured"
    return compensator


WRONG_SIGN = Subject(control_dt=1e-3, make=WrongSign, quick=True)
HALF = Subject(control_dt=1e-3, make=HalfFriction, quick=True)
MEASURED = Subject(control_dt=1e-3, make=measured_feedback, quick=True)


@pytest.mark.parametrize("name", IDS)
def test_verdicts_are_the_known_ones(name: str) -> None:
    finding = CLAIMS[name].measure(COARSE)
    assert finding.holds != bool(CLAIMS[name].fails), finding
    assert np.isfinite(finding.number)
    assert finding.measured


def test_there_are_enough_of_them() -> None:
    """At least twenty; every known failure says why, and every statement is a sentence from somewhere."""
    assert len(CLAIMS) >= 20
    for claim in CLAIMS.values():
        assert claim.source
        assert claim.text.endswith(".")
        assert claim.fails == "" or claim.fails.endswith(".")


@pytest.mark.parametrize("name", ["theorem2-pd", "theorem2-pid", "pd-rest-bound", "coulomb-pid", "constant-pd"])
def test_a_wrong_sign_turns(name: str) -> None:
    with np.errstate(all="ignore"):
        assert not CLAIMS[name].measure(WRONG_SIGN).holds


def test_a_wrong_sign_ends_the_simulation() -> None:
    with pytest.raises(RuntimeError, match="ended early"):
        CLAIMS["panel-pid-high"].measure(WRONG_SIGN)


@pytest.mark.parametrize(
    "name", ["panel-pid-high", "panel-pd-low", "panel-pd-high", "pd-rest-size", "coulomb-pid", "theorem2-pid-stuck"]
)
def test_measured_feedback_turns(name: str) -> None:
    assert not CLAIMS[name].measure(MEASURED).holds


def test_half_an_estimate_turns_the_size_at_rest() -> None:
    assert not CLAIMS["pd-rest-size"].measure(HALF).holds


def test_a_coarse_step_turns_the_low_pass() -> None:
    """At 1 kHz an observer of 100 rad/s is no longer the continuous low-pass within 2 %."""
    assert not CLAIMS["lowpass-letien-magnitude"].measure(COARSE).holds
    assert not CLAIMS["lowpass-letien-phase"].measure(COARSE).holds


def test_intervals() -> None:
    assert at_most(1.0, 1.0, "", "").holds
    assert not at_most(1.1, 1.0, "", "").holds
    assert at_least(1.0, 1.0, "", "").holds
    assert not at_least(0.9, 1.0, "", "").holds
    assert near(-1.04, -1.0, 0.05, "", "").holds
    assert not near(-1.06, -1.0, 0.05, "", "").holds
    for nothing in (np.nan, np.inf, -np.inf):
        assert not Finding(nothing, "", -np.inf, np.inf, "").holds
