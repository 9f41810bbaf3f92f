"""What an episode draws of the hardware's effects."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, instance, number, real_array, whole_number
from fo_gym.hardware.effects import Hardware, ModelError, PushTime, Temperature, TorqueSensor
from fo_gym.parameters import FlexibleJoint, check_joints

Array = NDArray[np.float64]

__all__ = ["HardwareDraw", "draw_hardware"]


@dataclass(frozen=True, eq=False)
class HardwareDraw:
    """The drawn part of the effects. Arrays are (dof,).

    Attributes:
        believed: motors and springs as controller, nominal motor and compensator know them.
        believed_mass: factor on the true masses in what they know.
        torque_offset: of the torque sensors [N | N m].
        ripple_phase: of the gear ripple [rad].
        temperature: at the start [K].
        push_time: when the joints are pushed [s]; None leaves it to the randomization.
        noise_seed: of the sensors' noise.
    """

    believed: FlexibleJoint
    believed_mass: float
    torque_offset: Array
    ripple_phase: Array
    temperature: Array
    push_time: float | None
    noise_seed: int

    def check(self, name: str, dof: int) -> None:
        """Raise ValueError where it is none of a robot with `dof` joints; `name` is what to call it."""
        instance(f"{name}.believed", self.believed, FlexibleJoint)
        check_joints(self.believed, dof)
        number(f"{name}.believed_mass", self.believed_mass, POSITIVE)
        for part in ("torque_offset", "ripple_phase", "temperature"):
            real_array(f"{name}.{part}", getattr(self, part), (dof,))
        whole_number(f"{name}.noise_seed", self.noise_seed, 0)


def draw_hardware(hardware: Hardware, joints: FlexibleJoint, rng: np.random.Generator) -> HardwareDraw:
    """One episode's draws; always all of them, so that switching one effect leaves the others' draws alone.

    Args:
        hardware: which effects there are; those that are None are drawn as if they had their defaults, and dropped.
        joints: the true motors and springs, arrays (dof,).
        rng: the environment's generator.
    """
    dof = len(np.atleast_1d(joints.motor_inertia))
    error = hardware.model_error or ModelError()
    inertia, stiffness = rng.uniform(*error.motor_inertia, dof), rng.uniform(*error.stiffness, dof)
    mass = float(rng.uniform(*error.mass))
    offset = rng.uniform(-1.0, 1.0, dof)
    phase = rng.uniform(0.0, 2.0 * np.pi, dof)
    temperature = rng.uniform(*(hardware.temperature or Temperature()).start, dof)
    start = float(rng.uniform(*(hardware.push_time or PushTime((0.0, 0.0))).start))
    seed = int(rng.integers(np.iinfo(np.int64).max))
    believed = replace(joints, motor_inertia=joints.motor_inertia * inertia, stiffness=joints.stiffness * stiffness)
    known = hardware.model_error is not None
    sensor = hardware.sensors.torque or TorqueSensor(noise=0.0, offset=0.0)
    return HardwareDraw(
        believed=believed if known else joints,
        believed_mass=mass if known else 1.0,
        torque_offset=offset * sensor.offset,
        ripple_phase=phase,
        temperature=temperature,
        push_time=None if hardware.push_time is None else start,
        noise_seed=seed,
    )
