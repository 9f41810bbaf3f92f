"""Arguments of environments, plants and views: refused at once, by name, with the remedy."""

from __future__ import annotations

import math
from functools import partial

import gymnasium as gym
import numpy as np
import pytest
from hostile import NO_NUMBERS, Attack, check_refused
from pendulum import FRICTION, JOINTS, MakeRobot

import fo_gym
from fo_gym.envs.stiction import StictionEnv, StictionVectorEnv
from fo_gym.hardware import CommandDelay, GearRipple, Hardware, MotorEncoder, SensorModel
from fo_gym.plant import FlexibleJointPlant
from fo_gym.simulation.settings import Settings

STICTION, REGULATION, SQUARE = "FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0"
TIMES = (*NO_NUMBERS, math.nan, math.inf, -1.0, 0.0, 10**400, [1.0], np.ones(1))
WORDS = (True, 1, 1.5, b"nominal", ["nominal"], np.array(["nominal", "hardware"]), {"nominal"}, "", "Nominal", object())
COUNTS = (*NO_NUMBERS, None, 2.0, 2.5, "3", 0, -1, math.nan, [2], np.array(2))


def test_settings() -> None:
    cases: list[Attack] = []
    for name, values in (
        ("control_dt", (*TIMES, None)),
        ("duration", TIMES),
        ("decimation", COUNTS),
        *((word, (*WORDS, None)) for word in ("variant", "action_mode", "feedback", "sensors")),
        *(
            (part, (1.0, "stiff", [], Settings))
            for part in ("joints", "friction", "sensor_model", "hardware", "randomization")
        ),
    ):
        cases += [(name, value, lambda value, name=name: Settings.of({name: value})) for value in values]
    cases += [("physics_dt", value, lambda value: Settings(physics_dt=value)) for value in TIMES if value != "1.5"]
    cases += [(name, name, lambda name: Settings.of({name: 1})) for name in ("fricton", "seed", "dt", "")]
    check_refused(cases)


def test_what_only_the_task_can_tell() -> None:
    """More ticks than can be counted, steps longer than the episode, gains and joints of another robot."""

    arm = partial(gym.make, REGULATION)

    def of(env_id: str, name: str) -> object:
        return lambda value: gym.make(env_id, **{name: value})

    def spread(env_id: str, name: str, value: object) -> object:
        return gym.make(env_id, variant="randomized", randomization=fo_gym.Randomization(**{name: value}))  # type: ignore[arg-type]

    cases: list[Attack] = [
        ("duration", 1e300, of(STICTION, "duration")),
        ("duration", 1e6, of(STICTION, "duration")),
        ("control_dt", 1e-12, of(STICTION, "control_dt")),
        ("control_dt", 1e-5, of(SQUARE, "control_dt")),
        ("decimation", 20001, of(STICTION, "decimation")),
        ("decimation", 10**400, of(STICTION, "decimation")),
        ("gains", "stiff", of(STICTION, "gains")),
        ("gains", 1.0, of(SQUARE, "gains")),
        ("gains", fo_gym.PDGains(1.0, 1.0), of(SQUARE, "gains")),
        ("FlexibleJoint.stiffness", np.ones(3), lambda value: arm(joints=fo_gym.FlexibleJoint(value, 0.0, 1.0, 1.0))),
        ("PDGains.kp", np.ones(3), lambda value: arm(gains=fo_gym.PDGains(value, 1.0))),
        ("GearRipple.period", np.ones(3), lambda value: arm(hardware=Hardware(ripple=GearRipple(1.0, value)))),
        ("MotorEncoder.resolution", np.ones(2), lambda value: arm(sensor_model=SensorModel(MotorEncoder(value)))),
        *(
            (f"Randomization.{name}", value, lambda value, name=name, env_id=env_id: spread(env_id, name, value))
            for env_id in (STICTION, REGULATION)
            for name, value in (("start", 1e9), ("step", (0.0, 1e9)), ("start", 100.0))
        ),
        ("CommandDelay.seconds", 1e9, lambda value: arm(hardware=Hardware(delay=CommandDelay(value)))),
        ("CommandDelay.seconds", 1.5e-3, lambda value: arm(hardware=Hardware(delay=CommandDelay(value)))),
        ("render_mode", "video", of(STICTION, "render_mode")),
    ]
    with pytest.warns(UserWarning, match="render_mode"):  # gym.make says it first
        check_refused(cases)


def test_size_and_modes_of_a_vector_environment() -> None:
    cases: list[Attack] = [
        ("num_envs", value, lambda value: gym.make_vec(STICTION, num_envs=value)) for value in (*COUNTS, 10**9, 10**400)
    ]
    cases += [
        (name, value, lambda value, name=name: gym.make_vec(STICTION, num_envs=2, **{name: value}))
        for name, value in (
            ("autoreset_mode", "next_step"),
            ("autoreset_mode", 0),
            ("autoreset_mode", gym.vector.AutoresetMode.SAME_STEP),
            ("autoreset_mode", np.arange(2)),
        )
    ]
    kinds = (StictionEnv, StictionVectorEnv)
    modes = (1, True, ["human"], np.array(["human", "rgb_array"]), b"human", "")
    cases += [("render_mode", each, lambda each, kind=kind: kind(render_mode=each)) for kind in kinds for each in modes]
    cases += [("fricton", "fricton", lambda name, kind=kind: kind(**{name: 1.0})) for kind in kinds]
    check_refused(cases)


def test_views_of_an_observation() -> None:
    obs = np.zeros(9)
    view = fo_gym.Signals.from_observation
    cases: list[Attack] = [("dof", value, lambda value: view(obs, value)) for value in (*COUNTS, 2, 10**9)]
    cases += [
        ("observation", value, lambda value: view(value, 1))
        for value in (None, "obs", 1.0, np.zeros(6), np.zeros((3, 0)), np.zeros(9, complex), np.zeros(9, bool), [[]])
    ]
    check_refused(cases)


def test_plants(pendulum: MakeRobot) -> None:
    robot = pendulum()
    plant = FlexibleJointPlant(robot, 2, joints=JOINTS, friction=FRICTION)
    zero = np.zeros((2, 2))
    cases: list[Attack] = [
        ("num_envs", value, lambda value: FlexibleJointPlant(robot, value, joints=JOINTS, friction=FRICTION))
        for value in (True, 0, -1, 2.5, "2", None, 10**9)
    ]
    cases += [
        ("link_side", "arm.xml", lambda value: FlexibleJointPlant(value, 1, joints=JOINTS, friction=FRICTION)),
        ("joints", FRICTION, lambda value: FlexibleJointPlant(robot, 1, joints=value, friction=FRICTION)),
        ("friction", None, lambda value: FlexibleJointPlant(robot, 1, joints=JOINTS, friction=value)),
    ]
    for value in (None, "torque", [1.0, 2.0], np.zeros((2, 2), complex), np.zeros((2, 2), bool), np.zeros((1, 2))):
        cases += [("tau_m", value, lambda value: plant.step(value, zero))]
        cases += [("tau_ext", value, lambda value: plant.step(zero, value))]
    cases += [("env", value, plant.to_mujoco) for value in (*COUNTS[:-5], -1, 2, 10**9, 0.5)]
    cases += [("timestep", value, lambda value: plant.to_mujoco(timestep=value)) for value in (*TIMES, None)]
    cases += [
        ("integrator", value, lambda value: plant.to_mujoco(integrator=value))
        for value in ("RK45", None, 1, ["euler"], {"euler"})
    ]
    check_refused(cases)
    everyone, home = np.arange(2), np.zeros((2, 2))
    for value in (None, "home", [1.0, 2.0, 3.0], np.full((2, 2), math.nan), np.zeros((2, 2), complex)):
        cases += [("q", value, lambda value: plant.reset(everyone, value))]
    for value in (*TIMES, None):
        cases += [
            (
                "mass scale",
                value,
                lambda value: plant.configure(everyone, joints=JOINTS, friction=FRICTION, mass_scale=value),
            )
        ]
    check_refused(cases)
    np.testing.assert_array_equal(plant.q, home)
    np.testing.assert_array_equal(plant.time, 0.0)
