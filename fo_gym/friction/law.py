"""The seam between friction laws and everything else: what a law has to say of itself.

A law says how it is stepped, which of its parameters are which level of friction, and its equations. The joint kernel,
the hardware's effects, the "randomized" variant and the certificate know laws through this alone.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from operator import attrgetter
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import Value
from fo_gym.modules import file_module, is_of_file

Array = NDArray[np.float64]

UNDAMPED = 0.2
"""A bristle whose damping is below this times sqrt(stiffness B), 0 included, counts as one with that much."""

__all__ = ["UNDAMPED", "FrictionLaw", "Levels"]


@dataclass(frozen=True)
class Levels:
    """Names of the parameters that are a law's levels of friction; "" where a law has none such.

    Attributes:
        coulomb: dry friction of a sliding joint [N | N m].
        stiction: dry friction near standstill, at least `coulomb` [N | N m].
        stribeck: velocity over which stiction falls to `coulomb` [m/s | rad/s].
        stiffness: of what yields before the joint slips [N/m | N m/rad].
        damping: of the same [N s/m | N m s/rad].
        viscous: friction over velocity [N s/m | N m s/rad].
    """

    coulomb: str = ""
    stiction: str = ""
    stribeck: str = ""
    stiffness: str = ""
    damping: str = ""
    viscous: str = ""

    def value(self, level: str, values: Any, default: Any = 0.0) -> Any:
        """That of a level in `values`, an array of the law's `dtype`; `default` where the law has none such."""
        name = getattr(self, level)
        return values[name] if name else default


class FrictionLaw:
    """A friction law of the motors. Derive a frozen dataclass from it whose fields are the law's parameters.

    A parameter is one value for all joints or one for each, (dof,); a tuple is the same for all joints. `respond` and
    `step` are plain Python over numbers and one-dimensional arrays, `math` and functions of the same kind; they are
    compiled when the law is first used, with what they call, and again when one of them has changed.

    The kernel looks for the motor's velocity v at the middle of a micro-step of h seconds, in sweeps: it asks `respond`
    at the velocity that it has so far, and takes the answer implicitly. With the velocity that follows it calls `step`.
    What is second order and stable for any h: to hold what is nonlinear at v and at the middle states, in one and the
    same way in both functions, and to let states that relax do so without overshoot (`fo_gym.friction.bristle`).

    Attributes:
        levels: which parameters are which level.
        memory: how many numbers `respond` leaves to `step`.
    """

    levels: ClassVar[Levels] = Levels()
    memory: ClassVar[int] = 0

    def level(self, level: str, default: Value = 0.0) -> Value:
        """One of its levels by its name in `Levels`; `default` where it has none such."""
        name = getattr(self.levels, level)
        return getattr(self, name) if name else default

    @property
    def states(self) -> int:
        """Number of internal states of a joint, all 0 at the start; a class may just have a number."""
        return 1

    def __reduce__(self) -> Any:
        """Pickled with the file of its class where that is a user's, which no other process can import by name."""
        kind = type(self)
        if not is_of_file(kind.__module__):
            return super().__reduce__()
        return _restored, (str(sys.modules[kind.__module__].__file__), kind.__qualname__, dict(vars(self)))

    @staticmethod
    def respond(v: float, z: Array, h: float, p: Any, memory: Array) -> tuple[float, float]:
        """Mean friction over the next h seconds as a line over the middle velocity, near v: (held, damping).

        tau_f = -(held + damping v), with damping at least 0: what does not depend on v, such as the springs of bent
        bristles, and what does.

        Args:
            v: middle velocity [m/s | rad/s].
            z: internal states at the start of the step, (states,), not to be changed.
            h: length of the step [s].
            p: the joint's parameters, by attribute.
            memory: for `step`, (memory,).
        """
        raise NotImplementedError("a friction law has a function `respond`")

    @staticmethod
    def step(v: float, z: Array, h: float, p: Any, memory: Array) -> float:
        """Put the states h seconds on at the middle velocity v; returns the mean tau_f [N | N m], which opposes v.

        Args:
            v: middle velocity [m/s | rad/s], the one at which the line of `respond` meets the motor's equation.
            z: internal states, (states,), to be changed.
            h: length of the step [s].
            p: the joint's parameters, by attribute.
            memory: what `respond` left, (memory,).
        """
        raise NotImplementedError("a friction law has a function `step`")

    def equations(self, v: float, z: Array) -> tuple[Array, float]:
        """The law as it is written: (z', tau_f) of one joint at velocity v and states z, (states,).

        The certificate solves these with SciPy and holds `respond` and `step` against it; parameters are numbers then.
        """
        raise NotImplementedError("a friction law has its `equations`")

    def events(self, v: float, z: Array) -> Array:
        """Numbers at whose zeros the equations change, for laws that switch between equations; else none."""
        return np.empty(0)

    def switched(self, v: float, z: Array) -> Array:
        """The states after such an event, where it changes them; also asked at the start of every control period."""
        return z

    def steady(self, v: Value) -> Array:
        """Friction torque tau_f at constant velocity v [m/s | rad/s], in N | N m; it opposes v."""
        raise NotImplementedError("a friction law has a curve `steady`")

    @classmethod
    def like(cls, lugre: Any) -> FrictionLaw:
        """The law that is as near as it can be to a `LuGre`: where laws are compared, by name, they are made so."""
        raise NotImplementedError(f"{cls.__name__} has no `like`, which makes it from a LuGre; give an instance")

    @classmethod
    def rates(cls, values: Any, inertia: Array) -> dict[str, Array]:
        """What a micro-step must follow beside the spring, [1/s], by the names of fo_gym.micro_steps.LIMITS.

        By default from the levels, as bristles have it; without stiffness damping plays no part.

        Args:
            values: parameters, an array with the law's `dtype`, (n, dof).
            inertia: B [kg | kg m^2], likewise.
        """
        stiffness, damping, viscous, coulomb = (
            np.broadcast_to(cls.levels.value(level, values), inertia.shape)
            for level in ("stiffness", "damping", "viscous", "coulomb")
        )
        stiction = cls.levels.value("stiction", values, coulomb)
        bristle = np.sqrt(stiffness / inertia)
        ratio = np.divide(damping, bristle * inertia, out=np.zeros_like(inertia), where=stiffness > 0.0)
        excess = np.divide(stiction - coulomb, coulomb, out=np.zeros_like(inertia), where=coulomb > 0.0)
        return {
            "bristle": bristle,
            "ringing": bristle / np.maximum(UNDAMPED, ratio),
            "friction_damping": (np.where(stiffness > 0.0, damping, 0.0) + viscous) / inertia,
            "stribeck": bristle * np.sqrt(excess),
        }

    @classmethod
    def vary(cls, own: Any, values: Any, dry: Any, added: Any, viscous: Any, stiction: Any) -> None:
        """Write into `values` what loads and temperatures make of the parameters `own`, arrays of the law's `dtype`.

        Coulomb friction and stiction times `dry` plus `added`, viscous friction times `viscous`, stiction plus
        `stiction` as well; factors, and [N | N m].
        """
        levels = cls.levels
        if levels.coulomb:
            values[levels.coulomb] = dry * own[levels.coulomb] + added
        if levels.stiction:
            values[levels.stiction] = dry * own[levels.stiction] + added + stiction
        if levels.viscous:
            values[levels.viscous] = viscous * own[levels.viscous]

    def drawn(self, factors: Mapping[str, Array]) -> Self:
        """The law with its levels times random factors, one for each joint.

        Args:
            factors: "friction" on Coulomb friction, with stiction in proportion; "stiction" on the share by which that
                exceeds Coulomb friction; "stribeck", "viscous"; "bristle" on the stiffness, its root on the damping.
        """
        levels, new = self.levels, {}
        if levels.coulomb:
            coulomb = np.asarray(getattr(self, levels.coulomb))
            new[levels.coulomb] = coulomb * factors["friction"]
            if levels.stiction:
                # The ratio varies about its nominal value, and stiction never falls below Coulomb friction.
                above = getattr(self, levels.stiction) - coulomb
                excess = np.divide(above, coulomb, out=np.zeros(np.shape(coulomb)), where=coulomb > 0)
                new[levels.stiction] = new[levels.coulomb] * (1.0 + excess * factors["stiction"])
        roots = {"stiffness": factors["bristle"], "damping": np.sqrt(factors["bristle"])}
        for level, factor in {**roots, "viscous": factors["viscous"], "stribeck": factors["stribeck"]}.items():
            if name := getattr(levels, level):
                new[name] = getattr(self, name) * factor
        return replace(self, **new)  # type: ignore[type-var]

    @property
    def dtype(self) -> np.dtype[np.void]:
        """One joint's parameters as the kernel reads them: a number for each field, several where it is a tuple."""
        parts = [(each.name, getattr(self, each.name)) for each in fields(self)]  # type: ignore[arg-type]
        return np.dtype([(name, "f8", (len(value),) if isinstance(value, tuple) else ()) for name, value in parts])

    def packed(self, dof: int) -> NDArray[np.void]:
        """The parameters of all joints, (dof,), of the law's `dtype`."""
        array = np.empty(dof, self.dtype)
        for name in self.dtype.names or ():
            array[name] = getattr(self, name)
        return array


def _restored(file: str, name: str, values: dict[str, Any]) -> FrictionLaw:
    """The law of a class of a user's file, which is imported where it has not been."""
    law = object.__new__(attrgetter(name)(file_module(Path(file))))
    law.__dict__.update(values)
    return law
