"""Compensation by a LuGre model beside the paper's model-free observers: the best, if the model is right, but complex.

The paper says so in passing, without an experiment. Here it is one, on its single link: how far the motor is from where
it would be without friction, and how many numbers of friction an estimate depends on.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fo_gym.certificate.cases import FRICTION, JOINT
from fo_gym.certificate.statement import Finding, at_least, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.friction import LuGre
from fo_gym.parameters import JointInfo
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.runs import PAPER, STICTION, panels
from fo_gym.reproduction.team import Run, run_team
from fo_gym.signals import Signals

Array = NDArray[np.float64]

_EXACT, _OFF = "lugre-nominal", "lugre-off"
_DT = 1e-3
_TEXT = "RMS of theta - theta without friction over 20 s, "

__all__: list[str] = []


@lru_cache(maxsize=1)
def _models(subject: Subject) -> dict[str, Run]:
    """The LuGre observer with the true parameters, and with parameters that are 20 to 30 % off."""
    members = {name: subject.make(name) for name in (_EXACT, _OFF)}
    return run_team(members, STICTION, control_dt=subject.control_dt, physics_dt=subject.physics_dt)


def _distances(subject: Subject) -> dict[str, float]:
    """How far from the motion without friction, RMS [m]: the two models, and the paper's six."""
    runs = panels(subject)
    ideal = runs["ideal"].tick("theta")
    competitors = {name: runs[name] for name in PAPER} | _models(subject)
    return {name: float(np.sqrt(np.mean(np.square(run.tick("theta") - ideal)))) for name, run in competitors.items()}


@claim(
    "lugre-best",
    source="on compensation with a friction model",
    text="With the true parameters compensation by a LuGre model is at least as good as every model-free observer of "
    "the paper.",
)
def _best(subject: Subject) -> Finding:
    distances = _distances(subject)
    rival = min(PAPER, key=lambda name: distances[name])
    text = f"{_TEXT}over that of {rival}, the best of the six: {distances[_EXACT]:.3g} m over {distances[rival]:.3g} m"
    return at_most(distances[_EXACT] / distances[rival], 1.0, "", text)


@claim(
    "lugre-off-worst",
    source="on compensation with a friction model: what it takes",
    text="With parameters that are 20 to 30 % off it is worse than every one of them, at low gains too.",
)
def _worst(subject: Subject) -> Finding:
    distances = _distances(subject)
    rival = max(PAPER, key=lambda name: distances[name])
    text = f"{_TEXT}over that of {rival}, the worst of the six: {distances[_OFF]:.3g} m over {distances[rival]:.3g} m"
    return at_least(distances[_OFF] / distances[rival], 1.0, "", text)


def _answers(subject: Subject, name: str, friction: LuGre) -> Array:
    """Estimates over a random motion, (ticks,), by a compensator that believes in this friction."""
    inertia, stiffness, limit = (np.array([[value]]) for value in (JOINT.motor_inertia, JOINT.stiffness, 1e9))
    info = JointInfo(1, inertia, stiffness, limit, _DT, friction)
    compensator = subject.make(name)
    compensator.reset(info, 1)
    rows = np.random.default_rng(1907).normal(size=(200, 1, 9)) * float(FRICTION.v_s)
    return np.array([compensator.estimate(Signals.from_observation(row, 1))[0, 0] for row in rows])


def _needed(subject: Subject, name: str) -> int:
    """How many parameters of friction its estimate depends on: those whose change by a tenth changes it."""
    before = _answers(subject, name, FRICTION)
    changed = (replace(FRICTION, **{field.name: 1.1 * getattr(FRICTION, field.name)}) for field in fields(FRICTION))
    return sum(bool(np.any(_answers(subject, name, friction) != before)) for friction in changed)


@claim(
    "lugre-complex",
    source="on compensation with a friction model",
    text="It is complex: its estimate depends on six identified numbers of friction for every joint, that of the "
    "paper's observers on none.",
)
def _complex(subject: Subject) -> Finding:
    model, free = _needed(subject, _EXACT), sum(_needed(subject, name) for name in PAPER)
    text = (
        f"identified numbers of friction per joint whose change changes the estimate; of all of the paper's six {free}"
    )
    return at_least(model - free, 6, "", text)
