"""The full state of a simulation, and what it belongs to."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import instance, real_array, shown, whole_array
from fo_gym.hardware.model import HardwareState
from fo_gym.plant import PlantState
from fo_gym.robots import Robot
from fo_gym.simulation.hands import HandState
from fo_gym.simulation.past_step import PastStep
from fo_gym.simulation.settings import Settings
from fo_gym.tasks.options import Limits
from fo_gym.tasks.scenario import Scenario
from fo_gym.tasks.task import Task

Array = NDArray[np.float64]

_SAME = "make the environment with the same arguments as the one that gave the state"

__all__ = ["Origin", "SimulationState", "parts_of"]


@dataclass(frozen=True)
class Origin:
    """What gives a state's numbers their meaning; how it goes on from there is the new environment's business.

    Attributes:
        robot: its name.
        task: what it does there: the reference.
        num_envs: size of the batch.
        variant, control_dt, decimation: see `Settings`.
        hardware: names of its effects; None where there is no hardware.
    """

    robot: str
    task: str
    num_envs: int
    variant: str
    control_dt: float
    decimation: int
    hardware: tuple[str, ...] | None

    @classmethod
    def of(cls, robot: Robot, task: Task, num_envs: int, settings: Settings) -> Origin:
        """That of a simulation."""
        return cls(
            robot=robot.name,
            task=shown(task.reference),
            num_envs=num_envs,
            variant=settings.variant,
            control_dt=float(settings.control_dt),
            decimation=int(settings.decimation),
            hardware=None if robot.hardware is None else tuple(each.name for each in robot.hardware.effects),
        )

    def check(self, other: Origin) -> None:
        """Raise ValueError where a state of `other` does not belong here."""
        for name in (each.name for each in fields(self)):
            theirs, own = getattr(other, name), getattr(self, name)
            if theirs != own:
                raise ValueError(
                    f"the state is of an environment whose {name} is {shown(theirs)}; here it is {shown(own)}: {_SAME}"
                )


@dataclass(frozen=True)
class SimulationState:
    """The full state of a Simulation; arrays are (num_envs, dof), `ticks` (num_envs,)."""

    origin: Origin
    plant: PlantState
    scenarios: tuple[Scenario, ...]
    theta_n: Array
    theta_n_dot: Array
    ticks: NDArray[np.int64]
    past: PastStep
    hardware: HardwareState
    hands: HandState | None

    def check(self, origin: Origin, limits: Limits, last_tick: int, *, hand: bool) -> None:
        """Whether this is a state of a simulation, but for plant and hardware, which check their own parts.

        Args:
            origin: that of the simulation.
            limits: its options'; they know joints and task.
            last_tick: where its episodes end.
            hand: whether hands guide its tools.

        Raises:
            ValueError: it is of another one, or a field has another shape or kind of value; the message names it.
        """
        instance("SimulationState.origin", self.origin, Origin)
        origin.check(self.origin)
        num_envs, dof = origin.num_envs, len(limits.joints)
        if not isinstance(self.scenarios, tuple) or len(self.scenarios) != num_envs:
            raise ValueError(
                f"SimulationState.scenarios is {shown(self.scenarios)}; give a tuple of {num_envs} Scenario"
            )
        for i, scenario in enumerate(self.scenarios):
            name = f"SimulationState.scenarios[{i}]"
            instance(name, scenario, Scenario)
            scenario.check(name, dof)
            parts = {"target": limits.takes_target, "hardware": origin.hardware is not None, "hand": hand}
            for part, wanted in parts.items():
                if (getattr(scenario, part) is not None) != wanted:
                    told = "missing" if wanted else "given"
                    raise ValueError(f"{name}.{part} is {told}; {_SAME}")
        for field in ("theta_n", "theta_n_dot"):
            real_array(f"SimulationState.{field}", getattr(self, field), (num_envs, dof))
        instance("SimulationState.past", self.past, PastStep)
        self.past.check((num_envs, dof))
        if hand:
            instance("SimulationState.hands", self.hands, HandState)
            cast("HandState", self.hands).check(num_envs)
        elif self.hands is not None:
            raise ValueError(f"SimulationState.hands is given; {_SAME}")
        whole_array("SimulationState.ticks", self.ticks, (num_envs,), 0, last_tick)


def parts_of(state: Any, count: int) -> tuple[Any, ...]:
    """The parts of what an environment's `get_state` gives. Raises ValueError for anything else."""
    if not isinstance(state, tuple) or len(state) != count:
        raise ValueError(f"state is {shown(state)}; give what get_state() of such an environment returned")
    return state
