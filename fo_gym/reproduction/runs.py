"""The runs that statements and figures share; each is made once per process."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from fo_gym.certificate.subject import Subject
from fo_gym.compensators import NoCompensation
from fo_gym.reproduction.team import Run, run_team

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
INTERACTION = "FJRInteraction-v0"
PAPER = ("pid-low", "pid-high", "pd-low", "pd-high", "letien-low", "letien-high")
"""The paper's observers, by their registered names."""

GAINS = {"low": {"L": 50.0, "Lp": 10.0, "Li": 25.0}, "high": {"L": 100.0, "Lp": 20.0, "Li": 100.0}}
"""The paper's gains [1/s, 1/s, 1/s^2]; the PD-type has no L_i, Le Tien's observer only L."""

__all__ = [
    "GAINS",
    "INTERACTION",
    "PAPER",
    "REGULATION",
    "SQUARE",
    "STICTION",
    "interaction",
    "panels",
    "regulation",
    "square",
]


def _everybody(subject: Subject, env_id: str, **env_kwargs: Any) -> dict[str, Run]:
    """none, ideal and the paper's six on the nominal episode."""
    kwargs: dict[str, Any] = {"physics_dt": subject.physics_dt, **env_kwargs}
    ideal = run_team({"ideal": NoCompensation()}, env_id, disturbed=False, **kwargs)
    members = {"none": NoCompensation(), **{name: subject.make(name) for name in PAPER}}
    return ideal | run_team(members, env_id, **kwargs)


@lru_cache(maxsize=1)
def panels(subject: Subject) -> dict[str, Run]:
    """The paper's simulations: the single link, 20 s, control as good as continuous."""
    return _everybody(subject, STICTION, control_dt=subject.control_dt)


@lru_cache(maxsize=1)
def regulation(subject: Subject) -> dict[str, Run]:
    """The regulation experiment on the arm, 20 s: step at 3 s, push at 13 s, control at 1 kHz."""
    return _everybody(subject, REGULATION, duration=20.0)


@lru_cache(maxsize=1)
def square(subject: Subject) -> dict[str, Run]:
    """The square in task space on the arm, control at 1 kHz."""
    return _everybody(subject, SQUARE)


@lru_cache(maxsize=1)
def interaction(subject: Subject) -> dict[str, Run]:
    """A hand guides the tool of the arm and lets it go, control at 1 kHz."""
    return _everybody(subject, INTERACTION)
