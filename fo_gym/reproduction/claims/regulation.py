"""The regulation experiment on the arm: who comes to rest, and who never does. On our arm, not on the paper's robot."""

from __future__ import annotations

import numpy as np

from fo_gym.certificate.statement import Finding
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.claim import claim
from fo_gym.reproduction.sensitivity import Quantity, finding, held_arms

_JOINT = 1
"""Joint 2, the one that the paper shows."""
_BEFORE, _AFTER = (12.0, 13.0), (19.0, 20.0)
"""The last second before the push, and of the paper's experiment [s]."""
_HELD = (50.0, 60.0)
"""When the arm, pushed at 13 s, has long had time to come to rest [s]."""
_RESTS, _HARDLY, _OSCILLATES = 0.01, 0.1, 1.0
"""Peak to peak of a joint that rests, that hardly moves, and that oscillates [mrad]."""
_SPAN = f"peak to peak of joint 2 over {_HELD[0]:g}-{_HELD[1]:g} s, after the push at 13 s"

__all__: list[str] = []


def _moves(name: str) -> Quantity:
    """Peak to peak of joint 2 in the end [mrad]."""
    return lambda runs: float(np.ptp(runs[name].errors(*_HELD, _JOINT)))


def _error(name: str, window: tuple[float, float]) -> Quantity:
    """Size of joint 2's mean error in a window [mrad]."""
    return lambda runs: abs(float(runs[name].errors(*window, _JOINT).mean()))


def _register_rest(name: str, title: str, limit: float, text: str) -> None:
    @claim(f"arm-{name}-rests", source=f"regulation experiment, {title}", text=text)
    def _rest(subject: Subject) -> Finding:
        arms = held_arms(subject)
        rings = _moves("ideal")(next(iter(arms.values())))
        said = f"{_SPAN}; without friction the under-damped joint still rings by {rings:.2g} mrad"
        return finding(arms, _moves(name), "mrad", -np.inf, limit, said)


def _register_oscillation(name: str, title: str, text: str) -> None:
    @claim(f"arm-{name}-oscillates", source=f"regulation experiment, {title}", text=text)
    def _oscillation(subject: Subject) -> Finding:
        return finding(held_arms(subject), _moves(name), "mrad", _OSCILLATES, np.inf, _SPAN)


_register_oscillation("pid-low", "PID-type, low gains", "On the arm the PID-type with low gains oscillates.")
_register_rest(
    "pid-high", "PID-type, high gains", _HARDLY, "On the arm the PID-type with high gains hardly oscillates."
)
_register_rest("pd-low", "PD-type, low gains", _RESTS, "On the arm the PD-type with low gains comes to rest.")
_register_rest("pd-high", "PD-type, high gains", _RESTS, "On the arm the PD-type with high gains comes to rest.")
for _gains in ("low", "high"):
    _register_oscillation(
        f"letien-{_gains}",
        f"Le Tien, {_gains} gain",
        f"On the arm Le Tien's observer with {_gains} gain does not come to rest.",
    )


def _register_error(when: str, window: tuple[float, float], paper: float) -> None:
    @claim(
        f"arm-pd-low-error-{when}",
        source="regulation experiment, PD-type, low gains",
        text=f"On the arm the PD-type with low gains rests about {paper:g} mrad off the target {when} the push.",
    )
    def _off(subject: Subject) -> Finding:
        said = f"|mean of theta - theta_d| of joint 2 over {window[0]:g}-{window[1]:g} s; a factor of 2 either way "
        said += "counts as the same, as the friction is not the paper's"
        quantity = _error("pd-low", window)
        return finding(held_arms(subject), quantity, "mrad", paper / 2.0, paper * 2.0, said)


_register_error("before", _BEFORE, 3.6)
_register_error("after", _AFTER, 1.9)


@claim(
    "arm-pd-gains",
    source="regulation experiment, PD-type",
    text="On the arm higher gains bring the PD-type's rest closer to the target.",
)
def _pd_gains(subject: Subject) -> Finding:
    text = f"|theta - theta_d| of joint 2, high gains over low, mean over {_HELD[0]:g}-{_HELD[1]:g} s"
    high, low = _error("pd-high", _HELD), _error("pd-low", _HELD)
    return finding(held_arms(subject), lambda runs: high(runs) / low(runs), "", -np.inf, 0.5, text)
