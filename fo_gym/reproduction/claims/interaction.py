"""Interaction: what a hand that guides the arm feels of friction. The paper shows it in a video, without numbers.

That it is hardly felt is taken as: a fifth at most of the hand's work against it is left, and a tenth of its force.
"""

from __future__ import annotations

from fo_gym.certificate.statement import Finding, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.metrics import METRICS
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.runs import PAPER, interaction

_FELT, _WORK, _HELD = 0.1, 0.2, 0.2
"""Shares of what it is without compensation: force, work, and distance from the target once the tool is free."""
_PASSIVE = 0.01
"""Energy that may come out beyond what was stored, as a share of the hand's work without friction."""

__all__: list[str] = []


def _scores(subject: Subject, metric: str) -> dict[str, float]:
    """A metric of everybody's run."""
    runs = interaction(subject)
    alone = {name: run.recording.part(slice(run.row, run.row + 1)) for name, run in runs.items()}
    references = References(alone["ideal"].motions, alone["none"].motions)
    return {name: METRICS[metric].function(part.episode(0, references)) for name, part in alone.items()}


def _told(scores: dict[str, float], names: tuple[str, ...] = PAPER) -> str:
    return ", ".join(f"{name} {scores[name]:.2g}" for name in names)


@claim(
    "interaction-work",
    source="interaction experiment (video)",
    text="With the PD-type at high gains the work of the hand against friction falls by at least 80 %.",
)
def _work(subject: Subject) -> Finding:
    shares, works = (_scores(subject, name) for name in ("hand_friction_work_ratio", "hand_work_j"))
    text = f"what is left of it; all: {_told(shares)}; work of the hand without friction {works['ideal']:.3g} J, "
    return at_most(shares["pd-high"], _WORK, "", f"{text}without compensation {works['none']:.3g} J")


@claim(
    "interaction-force",
    source="interaction experiment (video)",
    text="With every observer friction is hardly felt at the tool.",
)
def _force(subject: Subject) -> Finding:
    forces = _scores(subject, "apparent_friction_n")
    text = f"worst observer's apparent friction over none's {forces['none']:.3g} N; in N: {_told(forces)}"
    return at_most(max(forces[name] for name in PAPER) / forces["none"], _FELT, "", text)


@claim(
    "interaction-return",
    source="interaction experiment (video)",
    text="Let go, the tool returns to its target with every observer; without compensation it sticks.",
)
def _return(subject: Subject) -> Finding:
    errors = _scores(subject, "return_error_mm")
    text = f"worst observer's distance over none's {errors['none']:.3g} mm; in mm: {_told(errors, ('ideal', *PAPER))}"
    return at_most(max(errors[name] for name in PAPER) / errors["none"], _HELD, "", text)


@claim(
    "interaction-passive",
    source="passivity of the compensated joint",
    text="With every observer the arm gives the hand no more energy than what was put in and stored.",
)
def _passive(subject: Subject) -> Finding:
    created, works = (_scores(subject, name) for name in ("hand_energy_created_j", "hand_work_j"))
    text = f"largest energy beyond that over the hand's work without friction; in J: {_told(created, ('none', *PAPER))}"
    return at_most(max(created[name] for name in PAPER) / works["ideal"], _PASSIVE, "", text)
