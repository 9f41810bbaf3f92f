"""Compensators: the protocol they follow, how they are made, and the references that the suite itself makes."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, number, shown, text
from fo_gym.modules import import_file
from fo_gym.parameters import JointInfo
from fo_gym.signals import Signals
from fo_gym.specs import BUILT_IN, check_spec, plug_in, spec_of

Array = NDArray[np.float64]

__all__ = [
    "BOUND_RATES",
    "Bound",
    "Compensator",
    "CompensatorError",
    "Ideal",
    "NoCompensation",
    "declared_gains",
    "diagnostics_of",
    "has_array_gains",
    "has_learned",
    "is_privileged",
    "make_compensator",
]


class CompensatorError(RuntimeError):
    """A compensator raised, or returned what is not a finite (num_envs, dof) array; the message says where."""


@runtime_checkable
class Compensator(Protocol):
    """What an object needs to be scored. No base class is needed.

    Attributes:
        feedback: "measured" or "nominal", which motor signal the task's controller gets.
        learned: optional; True where data trained it, which tables say of it. Without this attribute it did not learn.
        privileged: optional; True where it is to see the truth, as `Signals.truth` and `JointInfo.identified`. Such a
            one is a reference, not a competitor: tables show it and never rank it. It runs in the suite's own process:
            a class or an instance that is handed over, or the project's own. Without this attribute it sees nothing.
        array_gains: optional; True where its gains may be arrays that broadcast against (num_envs, dof), so that one
            instance serves a batch in which every environment has gains of its own: maps of gains are then quick.
        diagnostics: optional; torques by name that explain the last estimate, (num_envs, dof) each, N or N m, always
            the same names. Traces keep them and pages draw them, below friction and its estimate; no score sees them.
    """

    feedback: str

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start `num_envs` new episodes of robots with these `joints`, with no memory of earlier ones."""

    def estimate(self, signals: Signals) -> Array:
        """The friction estimate tau_f_hat, (num_envs, dof), N or N m: tau_m = tau_c - tau_f_hat."""


class NoCompensation:
    """`none`: measured feedback and a zero estimate."""

    feedback = "measured"

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Remember the shape."""
        self._zero = np.zeros((num_envs, joints.dof))

    def estimate(self, signals: Signals) -> Array:
        """Zeros, (num_envs, dof)."""
        return self._zero


class Ideal(NoCompensation):
    """`ideal`: no compensation of motors that nothing disturbs; a reference, not a competitor."""


BOUND_RATES = (60.0, 300.0)
"""Rates of the lag among which `bound` takes the best for each set of episodes, by mean FRR [1/s]."""


class Bound:
    """`bound`: the true disturbance of the motors, a period late, and what was missed by being late; a reference.

        tau_f_hat = tau_dist + 2 rate P + rate^2 S,   P' = tau_dist - tau_f_hat,   S' = P

    tau_dist is the mean over the past period. P, the momentum that friction took from the motor before it was known,
    and S, its integral, are paid back through the lag 1/(s + rate)^2; without that the motor would stay where they have
    left it. No sensor errs in it and no model is wrong: what remains to `ideal` is the price of a period, of the lag
    and of the delay of the motors' commands. Measured feedback: the nominal motor knows the joint torque by its sensor
    alone, whose errors are none of the bound's.

    Args:
        rate: of the lag [1/s], above 0.
    """

    feedback = "measured"
    privileged = True

    def __init__(self, rate: float = BOUND_RATES[0]) -> None:
        self.rate = number("Bound: rate", rate, POSITIVE, "1/s")

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start with nothing to compensate."""
        self._dt = joints.control_dt
        self._momentum = np.zeros((num_envs, joints.dof))
        self._integral = np.zeros((num_envs, joints.dof))

    def estimate(self, signals: Signals) -> Array:
        """The estimate, (num_envs, dof), N or N m. Raises ValueError where it is not given the truth."""
        if signals.truth is None:
            raise ValueError("signals.truth is None; the bound needs the truth: run it by fo_gym.evaluate")
        disturbance = signals.truth["tau_dist"]
        self._momentum = self._momentum + self._dt * (disturbance - signals.truth["tau_f_hat"])
        self._integral = self._integral + self._dt * self._momentum
        return disturbance + 2.0 * self.rate * self._momentum + self.rate**2 * self._integral


def _factory(given: str) -> Any:
    """What a text names: a class or a function that makes a compensator."""
    if (entry := plug_in(given)) is not None:
        return entry.load()
    if given in BUILT_IN:
        return {"none": NoCompensation, "ideal": Ideal, "bound": Bound}[given]
    check_spec(given)
    spec = spec_of(given)
    module: Any
    if spec.kind == "file":
        module = import_file(Path(spec.where))
    else:
        try:
            module = importlib.import_module(spec.where)
        except ModuleNotFoundError as error:
            raise ValueError(
                f"compensator {given!r}: {error}; is the package installed? A file is named file.py:Class"
            ) from error
    if not hasattr(module, spec.attribute):
        raise ValueError(f"compensator {given!r}: {spec.where} has no {spec.attribute!r}; name a class that it has")
    factory = getattr(module, spec.attribute)
    if not callable(factory):
        raise ValueError(f"compensator {given!r} is {shown(factory)}; name a class, or a function that makes one")
    return factory


def _gain_names(factory: Any) -> list[str] | None:
    """Keyword arguments of a class, or of the class of what a function makes; None where they cannot be told."""
    try:
        while True:
            parameters = inspect.signature(factory).parameters
            if all(parameter.kind is not parameter.VAR_KEYWORD for parameter in parameters.values()):
                return list(parameters)
            if inspect.isclass(factory):
                return None
            factory = type(factory())
    except Exception:  # it is anybody's code
        return None


def _made(spec: str, factory: Any, gains: Mapping[str, Any]) -> Any:
    """What the factory makes of the gains; a TypeError names those there are where one is not among them."""
    try:
        return factory(**gains)
    except TypeError as error:
        known = _gain_names(factory) if gains else None
        unknown = [] if known is None else [name for name in gains if name not in known]
        if not unknown:
            raise TypeError(f"compensator {spec!r} cannot be made: {error}; give what it needs as gains") from error
        there = f"it takes {', '.join(known or ['none'])}"
        raise TypeError(f"compensator {spec!r} has no gain {unknown[0]!r}; {there}") from None


def make_compensator(spec: str, /, **gains: Any) -> Compensator:
    """Make a compensator, in this process: whatever code `spec` names runs here (`evaluate` has it run elsewhere).

    Args:
        spec: a registered name (see `list_compensators`), "module:Class" or "file.py:Class".
        gains: keyword arguments of the class, or of the registered factory, replacing its defaults.

    Raises:
        ValueError: nothing is called so, or a gain is out of range.
        TypeError: the class does not take such a gain, or what it makes is no compensator.
        CompensatorError: importing or making it raised something else.
    """
    text("compensator", spec)
    with _telling(spec):
        return checked(_made(spec, _factory(spec), gains), spec)


def handed(compensator: Any, name: str) -> Compensator:
    """A compensator of a class or an instance that is handed over as it is. Raises as `make_compensator` does."""
    with _telling(name):
        return checked(_made(name, compensator, {}) if inspect.isclass(compensator) else compensator, name)


@contextmanager
def _telling(name: str) -> Iterator[None]:
    """What making a compensator raises, by its name, unless it is a ValueError or TypeError, which tell themselves."""
    try:
        yield
    except (ValueError, TypeError):
        raise
    except (Exception, SystemExit) as error:
        raise CompensatorError(f"compensator {name!r}: making it raised {type(error).__name__}: {error}") from error


def checked(candidate: Any, name: str) -> Compensator:
    """`candidate`, if it has what the protocol asks for.

    Raises:
        ValueError: it is the reference `ideal` under another name.
        TypeError: it lacks `feedback`, `reset` or `estimate`, or an optional attribute is no truth value; the message
            shows what is needed.
    """
    if inspect.isclass(candidate) or not isinstance(candidate, Compensator):
        missing = [part for part in ("feedback", "reset", "estimate") if not hasattr(candidate, part)]
        raise TypeError(
            f"compensator {name!r} lacks {', '.join(missing) or 'an instance'}; it needs feedback = 'measured' | "
            "'nominal', reset(joints, num_envs) and estimate(signals)"
        )
    if isinstance(candidate, Ideal) and name != "ideal":
        raise ValueError(f"compensator {name!r} is the reference 'ideal', not a competitor; name it 'ideal'")
    if candidate.feedback not in ("measured", "nominal"):
        raise TypeError(f"compensator {name!r}: feedback is {candidate.feedback!r}; allowed are 'measured', 'nominal'")
    for optional in ("learned", "privileged", "array_gains"):
        if not isinstance(value := getattr(candidate, optional, False), bool):
            raise TypeError(f"compensator {name!r}: {optional} is {shown(value)}; give True or False, or leave it out")
    return candidate


def has_learned(compensator: Compensator) -> bool:
    """Whether data trained it, as it says itself."""
    return bool(getattr(compensator, "learned", False))


def is_privileged(compensator: Compensator) -> bool:
    """Whether it is to see the truth, and so is a reference, as it says itself."""
    return bool(getattr(compensator, "privileged", False))


def has_array_gains(compensator: Compensator) -> bool:
    """Whether each environment may have gains of its own, as it says itself."""
    return bool(getattr(compensator, "array_gains", False))


def diagnostics_of(compensator: Compensator) -> Mapping[str, Array]:
    """Torques by name that explain its last estimate, (num_envs, dof) each, N or N m; none where it tells none."""
    told: Mapping[str, Array] = getattr(compensator, "diagnostics", {})
    return told


def declared_gains(compensator: Any) -> dict[str, tuple[float, float, float]]:
    """The gains that may be tuned, its `search_space`: {name: (low, high, its own)}; NaN without such an attribute."""
    space: Mapping[str, tuple[float, float]] = getattr(compensator, "search_space", {})
    own = {name: float(getattr(compensator, name, math.nan)) for name in space}
    return {name: (float(low), float(high), own[name]) for name, (low, high) in space.items()}
