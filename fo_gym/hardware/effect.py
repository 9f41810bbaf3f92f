"""An effect of the hardware: what it draws for an episode, and what it does there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fo_gym.hardware.noise import Noise
from fo_gym.parameters import FlexibleJoint

Array = NDArray[np.float64]
Drawn = Mapping[str, Array]

__all__ = ["Effect", "Episodes", "FrictionChange", "Readings", "Truth"]


class Readings(NamedTuple):
    """What a robot's sensors give, arrays (n, dof); not to be written into: make others with `_replace`.

    Attributes:
        theta, theta_dot: motor position [m | rad] and velocity [m/s | rad/s].
        tau_j: joint torque [N | N m].
    """

    theta: Array
    theta_dot: Array
    tau_j: Array


class Truth(NamedTuple):
    """How the joints are, arrays (n, dof), not to be written into.

    Attributes:
        q, q_dot: links [m | rad, m/s | rad/s].
        theta, theta_dot: motors, likewise.
        tau_j: torque of the springs [N | N m].
    """

    q: Array
    q_dot: Array
    theta: Array
    theta_dot: Array
    tau_j: Array

    @property
    def readings(self) -> Readings:
        """What perfect sensors give."""
        return Readings(self.theta, self.theta_dot, self.tau_j)

    def rows(self, ids: NDArray[np.intp]) -> Truth:
        """That of some environments."""
        return Truth(*(array[ids] for array in self))


class FrictionChange(NamedTuple):
    """What becomes of an episode's friction; arrays (n, dof), or one number for all joints.

    It acts on the levels that the friction law has (`fo_gym.friction.Levels`).

    Attributes:
        dry: factor on Coulomb friction and stiction (LuGre: f_c and f_s), at least 0.
        added: what is then added to both [N | N m], at least 0.
        viscous: factor on viscous friction (sigma_2), at least 0.
        stiction: what is added to stiction alone [N | N m], at least 0.
    """

    dry: Array | float = 1.0
    added: Array | float = 0.0
    viscous: Array | float = 1.0
    stiction: Array | float = 0.0

    def then(self, other: FrictionChange) -> FrictionChange:
        """Both changes together."""
        return FrictionChange(
            self.dry * other.dry,
            self.added + other.added,
            self.viscous * other.viscous,
            self.stiction + other.stiction,
        )


@dataclass(eq=False)
class Episodes:
    """The episodes of a batch of n environments as one effect meets them; arrays have a row for each.

    Attributes:
        control_dt: control period [s].
        torque_limit: of the joints, (dof,) [N | N m].
        tachometer: whether the motors' velocity has a sensor of its own, and is exact.
        time: since the start of each episode, (n, 1) [s].
        truth: how the joints are at that time.
        drawn: what the effect's `draw` gave, (n, ...) each.
        memory: what its `begin` gave, (n, ...) each, for the hooks to change or to replace; it is part of the state
            that an environment saves.
        noise: of each episode, where the effect is `noisy`; it is part of the state as well.
    """

    control_dt: float
    torque_limit: Array
    tachometer: bool
    time: Array
    truth: Truth
    drawn: dict[str, Array]
    memory: dict[str, Array]
    noise: Noise

    def standard_normal(self) -> Array:
        """New noise for every episode and joint, (n, dof), not to be written into.

        Raises:
            ValueError: the effect is not `noisy`.
        """
        if not len(self.noise):
            raise ValueError("the effect draws noise; give its class noisy = True")
        return self.noise.standard_normal()

    def put(self, ids: NDArray[np.intp], new: Episodes) -> None:
        """Let new episodes take the place of those in the named rows."""
        for own, others in ((self.drawn, new.drawn), (self.memory, new.memory)):
            for name, array in others.items():
                own[name] = own[name].copy()
                own[name][ids] = array
        if len(self.noise):
            self.noise.put(ids, new.noise)


class Effect:
    """What sets a robot apart from its model in one respect. Derive from it, and override what the effect has.

    An effect is a description and does not change: frozen dataclasses do well. What an episode has of it is what
    `draw` gives; what it remembers within one is what `begin` gives. Then, in every control period, the motors' torque
    passes through `command`, gear and bearings add theirs, and when it is over `measure` makes the readings.

    Everything is for a batch, and an episode must not depend on its neighbours: work row by row. Nothing random but
    what `draw` takes from its generator, and the noise of `Episodes.standard_normal`.

    Attributes:
        noisy: whether it draws noise in every control period.
    """

    noisy: ClassVar[bool] = False

    @property
    def name(self) -> str:
        """What states and random streams call it; no two effects of one robot have the same."""
        return type(self).__name__

    def overrides(self, hook: str) -> bool:
        """Whether it does something there."""
        return getattr(type(self), hook) is not getattr(Effect, hook)

    def check_joints(self, dof: int) -> None:
        """Raise ValueError where it has values for another number of joints."""

    def draw(self, dof: int, generator: np.random.Generator) -> Mapping[str, Array | float]:
        """What one episode has of it, by name; how much is drawn must not depend on the effect's numbers."""
        return {}

    def believe(self, joints: FlexibleJoint, mass: float, drawn: Drawn) -> tuple[FlexibleJoint, float]:
        """What controller, nominal motor and compensator believe.

        Args:
            joints: motors and springs as they are believed without it, arrays (dof,).
            mass: factor on the true masses, likewise.
            drawn: what one episode has of it.
        """
        return joints, mass

    def pushed_at(self, time: float | None, drawn: Drawn) -> float | None:
        """When the robot is pushed in an episode that is pushed [s]; None leaves it to the randomization."""
        return time

    def begin(self, episodes: Episodes) -> Mapping[str, Array]:
        """What it remembers at the start of new episodes, (n, ...) each; `memory` is empty then, and all at rest."""
        return {}

    def measure(self, readings: Readings, episodes: Episodes) -> Readings:
        """What sensors make of their readings, once per control period; also at the start, where nothing moves."""
        return readings

    def command(self, tau_m: Array, episodes: Episodes) -> Array:
        """What the motors make of their command for the coming control period, (n, dof) [N | N m]."""
        return tau_m

    def motor_torque(self, episodes: Episodes) -> Array | float:
        """What disturbs the motors in the coming control period, (n, dof) [N | N m], positive along the joint axis."""
        return 0.0

    def link_damping(self, episodes: Episodes) -> Array | float:
        """What dampers there are between the links and the world, (n, dof) [N s/m | N m s/rad], at least 0.

        The plant's step takes a damper implicitly, so that it only takes energy. A torque held for a control period
        feeds a light link instead, whose velocity changes its sign within one.
        """
        return 0.0

    def friction(self, episodes: Episodes) -> FrictionChange:
        """How the motors' friction is changed in the coming control period."""
        return FrictionChange()
