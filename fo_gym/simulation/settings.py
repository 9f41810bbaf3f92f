"""The arguments that every environment takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from fo_gym.checks import POSITIVE, choice, flag, instance, number, only, shown, whole_number
from fo_gym.friction import FRICTIONLESS, FrictionLaw
from fo_gym.hardware import Hardware, SensorModel
from fo_gym.micro_steps import PhysicsDt, is_auto, micro_steps
from fo_gym.parameters import FlexibleJoint, ImpedanceGains, PDGains
from fo_gym.robots import Robot, RobotLike, robot_of
from fo_gym.signals import TIERS
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.task import Task, TaskLike, made_for
from fo_gym.tasks.variants import VARIANTS

ACTION_MODES = ("compensation", "torque")
FEEDBACKS = ("measured", "nominal")

MAX_TICKS = 100_000_000
"""Control ticks of an episode at most: more than a day at 1 kHz."""

__all__ = ["ACTION_MODES", "FEEDBACKS", "MAX_TICKS", "Settings"]


@dataclass(frozen=True, eq=False)
class Settings:
    """How an environment is run. What is None comes from the robot or the task.

    Attributes:
        robot: a `fo_gym.Robot`, the name of a shipped one, or a file: robot.toml, MJCF (.xml) or URDF (.urdf).
        task: a `fo_gym.Task`, or a function that makes one for a robot.
        variant: "nominal" (no randomness), "randomized" (parameters drawn per episode from the seed) or "hardware"
            (randomized, and imperfect sensors, commands, joints and models, see `fo_gym.Hardware`).
        action_mode: "compensation" (action = tau_f_hat; tau_m = tau_c - tau_f_hat) or "torque" (action = tau_m).
        feedback: "measured" or "nominal", which motor signal the task's controller gets.
        control_dt: control period [s].
        physics_dt: micro-step [s]; None means min(2e-4, control_dt); it must divide control_dt; "auto" takes the
            longest that follows every joint that the variant may draw. What a step cannot follow is refused.
        decimation: control ticks per environment step, at least 1, at most those of the episode.
        duration: length of an episode [s], rounded to whole steps, at least one; at most MAX_TICKS control periods.
        joints: motors and springs.
        friction: of the motors, of any law: `fo_gym.LuGre`, or another `fo_gym.friction.FrictionLaw`.
        gains: PDGains or ImpedanceGains, as the task's controller needs.
        sensors: "joint" = motor encoder and joint torque sensor; "motor" = the encoder alone: no tau_j, no theta_n, no
            nominal feedback; "full" = a tachometer as well.
        sensor_model: what the sensors make of the truth; None means the hardware's.
        hardware: effects, in any variant; None means the task's in "hardware" and none elsewhere.
        disturbed: False takes away all that disturbs the motors (friction, gear ripple, torques of effects) and leaves
            everything else, as the reference `ideal` has it.
        randomization: ranges from which "randomized" draws.
    """

    robot: RobotLike | None = None
    task: TaskLike | None = None
    variant: str = "nominal"
    action_mode: str = "compensation"
    feedback: str = "measured"
    control_dt: float = 1e-3
    physics_dt: PhysicsDt = None
    decimation: int = 1
    duration: float | None = None
    joints: FlexibleJoint | None = None
    friction: FrictionLaw | None = None
    gains: PDGains | ImpedanceGains | None = None
    sensors: str = "joint"
    sensor_model: SensorModel | None = None
    hardware: Hardware | None = None
    disturbed: bool = True
    randomization: Randomization | None = None

    def __post_init__(self) -> None:
        for name, allowed in (
            ("variant", VARIANTS),
            ("action_mode", ACTION_MODES),
            ("feedback", FEEDBACKS),
            ("sensors", tuple(TIERS)),
        ):
            choice(name, getattr(self, name), allowed)
        for name, kind in (
            ("joints", FlexibleJoint),
            ("friction", FrictionLaw),
            ("randomization", Randomization),
            ("sensor_model", SensorModel),
            ("hardware", Hardware),
        ):
            instance(name, getattr(self, name), kind, none="the task's own")
        for name in ("control_dt", "duration"):
            value = getattr(self, name)
            if value is not None or name == "control_dt":
                number(name, value, POSITIVE, "s")
        if not is_auto(self.physics_dt):
            micro_steps(self.control_dt, self.physics_dt)
        whole_number("decimation", self.decimation, 1)
        flag("disturbed", self.disturbed)
        if self.sensors == "motor" and self.feedback == "nominal":
            raise ValueError("feedback 'nominal' needs the torque sensor that sensors='motor' lacks; use 'measured'")

    @classmethod
    def of(cls, arguments: Mapping[str, Any]) -> Settings:
        """The settings from keyword arguments. Raises TypeError for an unknown one, naming those there are."""
        only("keyword argument", arguments, [each.name for each in fields(cls)])
        return cls(**arguments)

    def applied_to(self, robot: RobotLike | None, task: TaskLike | None) -> tuple[Robot, Task]:
        """What is simulated: robot and task with these settings, the task fitted to the robot.

        The robot's hardware is then what the variant has of it. Nothing else looks at both, settings and robot or task.

        Args:
            robot: the environment's own, or None.
            task: likewise, or a function that makes one for a robot.

        Raises:
            ValueError: the robot cannot be had, or the task does not suit it.
        """
        robot, task = (robot if self.robot is None else self.robot), (task if self.task is None else self.task)
        if robot is None or task is None:
            raise ValueError("this environment has no robot or task of its own; make it with robot=... and task=...")
        own = robot_of(robot)
        friction = self.friction if self.disturbed else FRICTIONLESS
        own = replace(own, **_given(flexible=self.joints, friction=friction))
        made = made_for(own, task)
        made = replace(made, **_given(duration=self.duration, gains=self.gains, randomization=self.randomization))
        return replace(own, hardware=self._hardware_of(own, made)), made.fitted_to(own)

    def _hardware_of(self, robot: Robot, task: Task) -> Hardware | None:
        """What the variant has of the robot's hardware; None for nothing."""
        hardware = self.hardware
        if hardware is None and self.variant == "hardware":
            hardware = replace(robot.hardware or Hardware(), push_time=task.push_time)
        if self.sensor_model is not None:
            hardware = replace(hardware or Hardware(), sensors=self.sensor_model)
        return hardware

    @property
    def step_dt(self) -> float:
        """Time of one environment step [s]."""
        return self.control_dt * self.decimation

    def ticks(self, task: Task) -> int:
        """Control ticks in an episode; a multiple of `decimation`, at least one step.

        Raises:
            ValueError: there are more than MAX_TICKS, or a step is longer than the episode.
        """
        seconds = task.duration
        if seconds / self.control_dt > MAX_TICKS:
            raise ValueError(
                f"duration is {shown(seconds)} s, more than {MAX_TICKS} periods of control_dt = {self.control_dt:g} s; "
                f"give a duration of at most {MAX_TICKS * self.control_dt:g} s, or a longer control_dt"
            )
        periods = max(1, round(seconds / self.control_dt))
        if self.decimation > periods:
            raise ValueError(
                f"decimation is {shown(self.decimation)}, but an episode of {seconds:g} s has {periods} control "
                f"period(s); give a decimation of at most {periods}, or a longer duration"
            )
        steps = round(seconds / self.step_dt)
        return max(1, steps) * int(self.decimation)


def _given(**values: Any) -> dict[str, Any]:
    """Those that are not None."""
    return {name: value for name, value in values.items() if value is not None}
