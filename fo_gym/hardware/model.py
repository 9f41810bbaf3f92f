"""The hardware around the plants of a batch: what a controller measures, and what joints make of a command."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.binding import Binds
from fo_gym.checks import instance, mapping, real_arrays
from fo_gym.generators import Streams, check_random_states, restored
from fo_gym.hardware.draw import HardwareDraw, check_draw, draw_hardware
from fo_gym.hardware.effect import Effect, Episodes, FrictionChange, Readings, Truth
from fo_gym.hardware.hardware import Hardware
from fo_gym.hardware.noise import Noise
from fo_gym.hardware.rehearsal import begun, check_hooks
from fo_gym.parameters import FlexibleJoint
from fo_gym.plant import FlexibleJointPlant

Array = NDArray[np.float64]
Ids = NDArray[np.intp]

_HOOKS = ("measure", "command", "motor_torque", "link_damping", "friction")
"""Of every control period; an effect is asked for those that it overrides."""

_DISTURBING = ("motor_torque", "friction")
"""Those through which an effect disturbs the motors."""

__all__ = ["HardwareModel", "HardwareState"]


@dataclass(frozen=True)
class HardwareState:
    """What the hardware remembers.

    Attributes:
        readings: of the sensors, by signal, (num_envs, dof) each; empty where they give the truth.
        memory: of the effects, by effect and by name, (num_envs, ...) each.
        generators: states of the noisy effects' random generators, by effect, one for each environment.
    """

    readings: dict[str, Array]
    memory: dict[str, dict[str, Array]]
    generators: dict[str, list[Any]]


class HardwareModel(Binds):
    """A plant with its hardware; without effects it measures the truth and does as it is told.

    Args:
        plant: the joints.
        hardware: the effects, or None.
        torque_limit: of the joints, (dof,) [N | N m].
        readings: arrays (num_envs, dof) into which the sensors write.
        tachometer: whether the motors' velocity has a sensor of its own.
        disturbed: whether effects disturb the motors; what else they do, they do in any case.

    Attributes:
        readings: of the sensors at the last look.
        motor_inertia: B as controller, nominal motor and compensator know it, (num_envs, dof).

    Raises:
        ValueError: an effect has values for another number of joints, a hook of it gives something else than it is
            asked for, or the delay is no whole number of control periods.
    """

    bindings = ("_sense",)

    def __init__(
        self,
        plant: FlexibleJointPlant,
        hardware: Hardware | None,
        torque_limit: Array,
        readings: Readings,
        *,
        tachometer: bool,
        disturbed: bool = True,
    ) -> None:
        self.plant = plant
        self.motor_inertia = plant.motor_inertia.copy()
        self._like: HardwareDraw | None = None
        self._effects: list[tuple[Effect, Episodes]] = []
        truth = self._truth()
        self.readings = readings
        self._read(truth.readings)
        if hardware is not None:
            hardware.check_joints(plant.dof)
            joints = FlexibleJoint(plant.stiffness[0], plant.damping[0], plant.motor_inertia[0], torque_limit)
            self._like = draw_hardware(hardware, joints, Streams(np.random.default_rng(0)))
            alike = [self._like] * plant.num_envs
            time, silence = plant.time[:, None], Noise((), plant.dof)
            nothing = Episodes(plant.control_dt, torque_limit, tachometer, time, truth, {}, {}, silence)
            self._effects = [(effect, begun(effect, nothing, alike)) for effect in hardware.effects]
        for effect, episodes in self._effects:
            check_hooks(effect, episodes)
        self._asked = {hook: [pair for pair in self._effects if pair[0].overrides(hook)] for hook in _HOOKS}
        if not disturbed:
            self._asked |= {hook: [] for hook in _DISTURBING}
        self.bind()

    def bind(self) -> None:
        """See Binds."""
        self._sense = self.plant.sensors(*self.readings)

    def _truth(self) -> Truth:
        """How the joints are now: copies, which nobody writes into."""
        state, tau_j = self.plant.snapshot(), self.plant.tau_j
        state.flags.writeable = tau_j.flags.writeable = False
        q, q_dot, theta, theta_dot = state[:4]
        return Truth(q, q_dot, theta, theta_dot, tau_j)

    def _now(self) -> Truth:
        """How the joints are now, made known to the effects."""
        truth, time = self._truth(), self.plant.time[:, None]
        for _, episodes in self._effects:
            episodes.truth, episodes.time = truth, time
        return truth

    @property
    def friction_change(self) -> FrictionChange:
        """What the effects make of the motors' friction as the joints are at the last look, or at their start."""
        changes = [effect.friction(episodes) for effect, episodes in self._asked["friction"]]
        return reduce(FrictionChange.then, changes) if changes else FrictionChange()

    def begin(self, ids: Ids, motor_inertia: Array, draws: Sequence[HardwareDraw | None]) -> Array:
        """Start the named environments at rest; returns their true tau_j, (n, dof).

        Args:
            ids: which environments.
            motor_inertia: B as it is believed, (n, dof).
            draws: what was drawn of the effects; None where there is no hardware.
        """
        self.motor_inertia[ids] = motor_inertia
        truth = self._now().rows(ids)
        readings = truth.readings
        drawn = [draw for draw in draws if draw is not None]
        for effect, episodes in self._effects:
            new = begun(effect, replace(episodes, truth=truth, time=np.zeros((len(ids), 1))), drawn)
            readings = effect.measure(readings, new)
            episodes.put(ids, new)
        for whole, part in zip(self.readings, readings, strict=True):
            whole[ids] = part
        return truth.tau_j

    def look(self) -> None:
        """Sample the sensors, once per tick: every look takes new noise."""
        if not self._effects:
            self._sense()
            return
        readings = self._now().readings
        for effect, episodes in self._asked["measure"]:
            readings = effect.measure(readings, episodes)
        self._read(readings)

    def _read(self, readings: Readings) -> None:
        for own, read in zip(self.readings, readings, strict=True):
            own[:] = read

    def command(self, tau_m: Array) -> None:
        """Turn this tick's command, (num_envs, dof), into the torque that the motors give."""
        if self._asked["command"]:
            given = tau_m.copy()  # which an effect may keep
            for effect, episodes in self._asked["command"]:
                given = effect.command(given, episodes)
            tau_m[:] = given

    def step(self) -> None:
        """Advance one control period under the torques that the plant has, with what gears and bearings add."""
        if self._asked["friction"]:
            self.plant.vary_friction(*self.friction_change)
        if self._asked["link_damping"]:
            self.plant.link_damping[:] = sum(effect.link_damping(each) for effect, each in self._asked["link_damping"])
        if self._asked["motor_torque"]:
            self.plant.motor_torque[:] = sum(effect.motor_torque(each) for effect, each in self._asked["motor_torque"])
        self.plant.advance()

    def _imperfect(self) -> dict[str, Array]:
        """The readings, by signal, where an effect has made them: they cannot be had again from the truth."""
        return self.readings._asdict() if self._asked["measure"] else {}

    def get_state(self) -> HardwareState:
        """A copy of what sensors and effects remember."""
        return HardwareState(
            readings={name: array.copy() for name, array in self._imperfect().items()},
            memory={
                effect.name: {name: array.copy() for name, array in episodes.memory.items()}
                for effect, episodes in self._effects
            },
            generators={effect.name: episodes.noise.states for effect, episodes in self._effects},
        )

    def check_state(self, state: HardwareState, name: str, draws: Mapping[str, HardwareDraw | None]) -> None:
        """Raise ValueError where this is no state of such hardware, naming the field.

        Args:
            state: what is claimed to be one.
            name: what to call it.
            draws: those of its episodes, by what to call them.
        """
        instance(name, state, HardwareState)
        real_arrays(f"{name}.readings", state.readings, self._imperfect())
        for part in ("memory", "generators"):
            mapping(f"{name}.{part}", getattr(state, part), [effect.name for effect, _ in self._effects])
        for effect, episodes in self._effects:
            real_arrays(f"{name}.memory[{effect.name!r}]", state.memory[effect.name], episodes.memory)
            told = f"{name}.generators[{effect.name!r}]"
            check_random_states(told, state.generators[effect.name], len(episodes.noise))
        if self._like is not None:
            for told, draw in draws.items():
                check_draw(told, draw, self._like)

    def set_state(self, state: HardwareState, motor_inertia: Array, draws: Sequence[HardwareDraw | None]) -> None:
        """Continue from a copy of `state`, exactly, in the episodes of these draws; see `begin`."""
        self.begin(np.arange(self.plant.num_envs), motor_inertia, draws)
        for effect, episodes in self._effects:
            memory = state.memory[effect.name]
            episodes.memory = {name: np.array(memory[name], dtype=np.float64) for name in episodes.memory}
            episodes.noise = Noise(restored(state.generators[effect.name]), self.plant.dof)
        for name, own in self._imperfect().items():
            own[:] = state.readings[name]
