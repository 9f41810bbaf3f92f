"""What the plant promises its users: refusals that name the cause, exact continuation, rest, masses."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from reference import Arm, Control, sampled

from fo_gym.parameters import FRICTIONLESS, FlexibleJoint, ImpedanceGains, LuGre, PDGains, per_joint
from fo_gym.plant import FlexibleJointPlant, Robot
from fo_gym.plant.plant import micro_steps
from fo_gym.plant.robot import load_model

JOINTS = FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=100.0)
FRICTION = LuGre(sigma_0=1e4, sigma_1=1e2, sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=5e-3)
POSE = np.array([0.3, -0.8])

PENDULUM = """
<mujoco model="pendulum">
  <compiler angle="radian"/>
  <worldbody>
    {world}
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" {shoulder}/>
      <inertial pos="0.2 0 0" mass="2" diaginertia="0.01 0.03 0.03"/>
      <geom name="upper_shell" type="capsule" fromto="0 0 0 0.4 0 0" size="0.05" mass="0"/>
      <body name="fore" pos="0.4 0 0">
        <joint name="elbow" type="{elbow_type}" {elbow}/>
        <inertial pos="0.15 0 0" mass="1" diaginertia="0.005 0.01 0.01"/>
        <geom name="fore_shell" type="capsule" fromto="0.1 0 0 0.3 0 0" size="0.05" mass="0"/>
        <site name="tip" pos="0.3 0 0"/>
      </body>
    </body>
  </worldbody>
  {rest}
</mujoco>
"""
MakeRobot = Callable[..., Robot]


@pytest.fixture
def pendulum(tmp_path: Path) -> MakeRobot:
    """Writes a two-link pendulum in the vertical plane, with the given attributes, and names its joints."""

    def make(shoulder: str = "", elbow: str = 'axis="0 1 0"', elbow_type: str = "hinge", **parts: str) -> Robot:
        values = {"world": "", "rest": "", **parts}
        path = tmp_path / "pendulum.xml"
        path.write_text(PENDULUM.format(shoulder=shoulder, elbow=elbow, elbow_type=elbow_type, **values))
        return Robot(path, ("shoulder", "elbow"))

    return make


def plant_of(robot: Robot, num_envs: int = 1, friction: LuGre = FRICTION, **options: Any) -> FlexibleJointPlant:
    plant = FlexibleJointPlant(robot, num_envs, joints=JOINTS, friction=friction, **options)
    plant.reset(np.arange(num_envs), POSE)
    return plant


def drive(plant: FlexibleJointPlant, ticks: int, start: int = 0) -> np.ndarray:
    """Motion under torques that depend on tick and environment, (ticks, 5, num_envs, dof)."""
    history = []
    phase = np.arange(plant.q.size).reshape(plant.q.shape)
    for k in range(start, start + ticks):
        plant.step(8.0 * np.sin(0.05 * k + phase), 2.0 * np.cos(0.03 * k + phase))
        history.append(np.stack([plant.q, plant.q_dot, plant.theta, plant.theta_dot, plant.z]))
    return np.array(history)


# --- Micro-steps -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("control_dt", "physics_dt", "steps"),
    [(1e-3, None, 5), (1e-4, None, 1), (2e-4, None, 1), (1e-3, 1e-3, 1), (1e-3, 1e-4, 10), (1 / 3000, 1 / 9000, 3)],
)
def test_micro_steps(control_dt: float, physics_dt: float | None, steps: int) -> None:
    assert micro_steps(control_dt, physics_dt) == steps


@pytest.mark.parametrize("control_dt", [1e-3, 3e-4, 1 / 3000, 2.5e-3, 1e-5])
def test_default_micro_step_divides_and_is_short(control_dt: float) -> None:
    steps = micro_steps(control_dt, None)
    assert control_dt / steps <= 2e-4 * (1 + 1e-9)
    assert steps == 1 or control_dt / (steps - 1) > 2e-4


@pytest.mark.parametrize(("control_dt", "physics_dt"), [(1e-3, 3e-4), (1e-3, 6e-4), (1e-3, 1e-2), (1 / 3000, 1e-4)])
def test_non_divisor_is_refused_with_a_value_that_works(control_dt: float, physics_dt: float) -> None:
    with pytest.raises(ValueError, match="does not divide") as refusal:
        micro_steps(control_dt, physics_dt)
    assert str(physics_dt) in str(refusal.value)
    advice = float(str(refusal.value).split(";")[1].split()[0])
    assert micro_steps(control_dt, advice) >= 1


@pytest.mark.parametrize("bad", [0.0, -1e-3, np.nan, np.inf])
def test_periods_must_be_positive(bad: float) -> None:
    with pytest.raises(ValueError, match="control_dt"):
        micro_steps(bad, None)
    with pytest.raises(ValueError, match="physics_dt"):
        micro_steps(1e-3, bad)


def test_too_long_micro_step_is_refused_with_numbers(pendulum: MakeRobot) -> None:
    """The fastest mode, K_j (1/B + (M^-1)_jj), from the link's own inertia matrix; the advised step is accepted."""
    robot, stiff = pendulum(), replace(JOINTS, stiffness=np.array([3e3, 3e5]))
    arm = Arm(robot.path, stiff, FRICTION)
    inverse = np.linalg.inv(dense_inertia(arm, np.zeros(2)))
    omega = np.sqrt(3e5 * (1.0 + inverse[1, 1]))
    with pytest.raises(ValueError, match=r"0\.0005 s.*'elbow'") as refusal:
        FlexibleJointPlant(robot, 1, joints=stiff, friction=FRICTION, physics_dt=5e-4)
    assert f"omega = {omega:.4g} rad/s" in str(refusal.value)
    advice = float(str(refusal.value).split("at most ")[1].split()[0])
    assert advice == pytest.approx(1.0 / omega, rel=1e-2)
    steps = int(np.ceil(1e-3 / advice))
    FlexibleJointPlant(robot, 1, joints=stiff, friction=FRICTION, physics_dt=1e-3 / steps)


def test_reset_checks_the_micro_step_of_new_parameters(pendulum: MakeRobot) -> None:
    plant = plant_of(pendulum(), num_envs=2)
    plant.configure(np.array([1]), joints=replace(JOINTS, stiffness=3e6), friction=FRICTION)
    with pytest.raises(ValueError, match="too long"):
        plant.reset(np.array([1]), POSE)
    plant.reset(np.array([0]), POSE)


# --- Continuation to the bit -----------------------------------------------------------------------------------------


def varied(robot: Robot) -> FlexibleJointPlant:
    """Three environments with masses, friction and poses of their own, in mid-motion."""
    plant = plant_of(robot, num_envs=3)
    plant.configure(np.array([1]), joints=replace(JOINTS, damping=3.0), friction=FRICTIONLESS, mass_scale=1.7)
    plant.reset(np.array([1, 2]), np.array([[0.1, 0.2], [-0.4, 1.0]]))
    drive(plant, 200)
    return plant


def test_set_state_continues_exactly(pendulum: MakeRobot) -> None:
    """In the same plant, after it has moved on and been reset."""
    plant = varied(pendulum())
    kept = plant.get_state()
    expected = drive(plant, 200, start=200)
    assert plant.time == pytest.approx([0.4] * 3)
    plant.reset(np.arange(3), -POSE)
    plant.set_state(kept)
    assert plant.time == pytest.approx([0.2] * 3)
    np.testing.assert_array_equal(drive(plant, 200, start=200), expected)


def test_state_is_a_copy(pendulum: MakeRobot) -> None:
    plant = varied(pendulum())
    kept = plant.get_state()
    before = copy.deepcopy(kept)
    drive(plant, 5)
    plant.set_state(kept)
    drive(plant, 5)
    for name in ("q", "q_dot", "theta", "theta_dot", "z", "time"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(before, name))


@pytest.mark.parametrize("duplicate", [lambda plant: pickle.loads(pickle.dumps(plant)), copy.deepcopy])
def test_copies_continue_exactly(pendulum: MakeRobot, duplicate: Callable[[Any], Any]) -> None:
    """Parameters, masses and time included; original and copy share nothing."""
    plant = varied(pendulum())
    twin = duplicate(plant)
    expected = drive(plant, 200, start=200)
    assert twin.time == pytest.approx([0.2] * 3)
    np.testing.assert_array_equal(drive(twin, 200, start=200), expected)
    np.testing.assert_array_equal(twin.tau_f, plant.tau_f)
    twin.configure(np.arange(3), joints=JOINTS, friction=FRICTION, mass_scale=2.0)
    twin.reset(np.arange(3), POSE)
    again = duplicate(plant)
    np.testing.assert_array_equal(drive(again, 5, start=400), drive(plant, 5, start=400))


@pytest.mark.parametrize("name", ["q", "q_dot", "theta", "theta_dot", "z"])
def test_state_of_another_shape_is_refused(pendulum: MakeRobot, name: str) -> None:
    plant = plant_of(pendulum(), num_envs=2)
    with pytest.raises(ValueError, match=rf"PlantState\.{name} .*\(3, 2\)"):
        plant.set_state(replace(plant.get_state(), **{name: np.zeros((3, 2))}))


def test_environments_stand_alone(pendulum: MakeRobot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Environment 1 of three, alone: the same to the bit, whatever becomes of its neighbours, lost ones included."""
    monkeypatch.chdir(tmp_path)  # MuJoCo logs lost states to the working directory
    alone, plant = plant_of(pendulum()), plant_of(pendulum(), num_envs=3)
    plant.configure(np.array([0]), joints=JOINTS, friction=FRICTIONLESS, mass_scale=0.6)
    plant.q[2] = np.nan
    for k in range(200):
        push = np.array([[2.0 * np.cos(0.03 * k), -1.0]])
        torque = np.array([[8.0 * np.sin(0.05 * k), 1.0]])
        alone.step(torque, push)
        plant.step(np.repeat(torque, 3, axis=0), np.repeat(push, 3, axis=0))
    np.testing.assert_array_equal(plant.get_state().theta[1], alone.get_state().theta[0])
    np.testing.assert_array_equal(plant.get_state().z[1], alone.get_state().z[0])
    assert np.isnan(plant.theta[2]).all()
    assert np.abs(plant.theta[0] - plant.theta[1]).max() > 1e-3


# --- Parameters ------------------------------------------------------------------------------------------------------

GOOD = {
    LuGre: {"sigma_0": 1e5, "sigma_1": 300.0, "sigma_2": 0.4, "f_c": 1.0, "f_s": 1.5, "v_s": 1e-3},
    FlexibleJoint: {"stiffness": 3e3, "damping": 0.0, "motor_inertia": 1.0, "torque_limit": 10.0},
    PDGains: {"kp": 50.0, "kd": 5.0},
    ImpedanceGains: {field.name: 10.0 for field in fields(ImpedanceGains)},
}
MAY_BE_ZERO = {"sigma_0", "sigma_1", "sigma_2", "damping", "kd", "kd_position", "kd_orientation", "kd_elbow"}
FIELDS = [(kind, name) for kind, values in GOOD.items() for name in values]


@pytest.mark.parametrize(("kind", "name"), FIELDS)
@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_bad_parameters_are_refused_by_name(kind: type, name: str, bad: float) -> None:
    kind(**GOOD[kind])
    with pytest.raises(ValueError, match=rf"{kind.__name__}\.{name}\b"):
        kind(**{**GOOD[kind], name: bad})


@pytest.mark.parametrize(("kind", "name"), [pair for pair in FIELDS if pair[0] is not ImpedanceGains])
def test_one_bad_joint_is_enough(kind: type, name: str) -> None:
    values = np.full(3, GOOD[kind][name])
    kind(**{**GOOD[kind], name: values.copy()})
    values[1] = -1.0
    with pytest.raises(ValueError, match=rf"{kind.__name__}\.{name}\b"):
        kind(**{**GOOD[kind], name: values})


@pytest.mark.parametrize(("kind", "name"), FIELDS)
def test_zero_is_accepted_where_it_means_something(kind: type, name: str) -> None:
    zero = {**GOOD[kind], name: 0.0}
    if name in MAY_BE_ZERO:
        kind(**zero)
    else:
        with pytest.raises(ValueError, match=rf"{kind.__name__}\.{name}\b"):
            kind(**zero)


def test_stiction_below_coulomb_friction_is_refused() -> None:
    with pytest.raises(ValueError, match=r"LuGre\.f_s is 0\.9.*f_c = 1"):
        LuGre(**{**GOOD[LuGre], "f_s": 0.9})


@pytest.mark.parametrize("name", ["stiffness", "motor_inertia"])
def test_values_for_another_number_of_joints_are_refused(pendulum: MakeRobot, name: str) -> None:
    joints = replace(JOINTS, **{name: np.full(3, 1e3)})
    with pytest.raises(ValueError, match=rf"FlexibleJoint\.{name} .*\(3,\).*2"):
        FlexibleJointPlant(pendulum(), 1, joints=joints, friction=FRICTION)


def test_scalars_stand_for_all_joints() -> None:
    spread = per_joint(replace(JOINTS, stiffness=np.array([1e3, 2e3])), 2)
    np.testing.assert_array_equal(spread.stiffness, [1e3, 2e3])
    np.testing.assert_array_equal(spread.motor_inertia, [1.0, 1.0])


# --- Robot files -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parts", "complaint"),
    [
        ({"elbow_type": "ball", "elbow": ""}, "hinge or a slide"),
        ({"rest": '<actuator><motor joint="elbow"/></actuator>'}, "actuators"),
        ({"rest": '<equality><joint joint1="shoulder" joint2="elbow"/></equality>'}, "equalities"),
        ({"rest": '<tendon><fixed><joint joint="elbow" coef="1"/></fixed></tendon>'}, "tendons"),
        ({"shoulder": 'frictionloss="0.1"'}, "frictionloss"),
    ],
)
def test_files_with_more_than_links_are_refused(pendulum: MakeRobot, parts: dict[str, str], complaint: str) -> None:
    robot = pendulum(**parts)
    with pytest.raises(ValueError, match=complaint) as refusal:
        load_model(robot)
    assert str(robot.path) in str(refusal.value)


@pytest.mark.parametrize("joints", [("shoulder",), ("elbow", "shoulder"), ("shoulder", "wrist"), ()])
def test_other_joints_than_the_files_are_refused(pendulum: MakeRobot, joints: tuple[str, ...]) -> None:
    with pytest.raises(ValueError, match=r"\('shoulder', 'elbow'\)"):
        load_model(replace(pendulum(), joints=joints))


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere\.xml"):
        load_model(Robot(tmp_path / "nowhere.xml", ("joint",)))


def test_missing_tool_is_named(pendulum: MakeRobot) -> None:
    with pytest.raises(KeyError, match=r"grip.*tip"):
        load_model(replace(pendulum(), tool="grip"))


def test_urdf_is_a_robot_too(tmp_path: Path) -> None:
    """One hinge with 2 kg at 0.5 m: the plant's gravity and inertia are those of the pencil."""
    path = tmp_path / "pendulum.urdf"
    path.write_text(
        """<robot name="pendulum">
          <link name="base"/>
          <link name="rod"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
            <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
          <joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
        </robot>"""
    )
    plant = FlexibleJointPlant(Robot(path, ("pivot",)), 1, joints=JOINTS, friction=FRICTION)
    assert plant.body.dense_inertia(np.zeros((1, 1))).item() == pytest.approx(0.1 + 2 * 0.25)
    assert abs(plant.body.gravity(np.zeros((1, 1))).item()) == pytest.approx(2 * 9.81 * 0.5)


# --- Rest, masses, springs -------------------------------------------------------------------------------------------


def dense_inertia(arm: Arm, q: np.ndarray) -> np.ndarray:
    """M(q) column by column: a unit torque's acceleration less none's is a column of its inverse."""
    still = np.zeros_like(q)
    free = arm.acceleration(q, still, still).copy()
    return np.linalg.inv(np.array([arm.acceleration(q, still, unit) - free for unit in np.eye(len(q))]).T)


def free_arm(robot: Robot) -> Arm:
    return Arm(robot.path, JOINTS, LuGre(0.0, 0.0, 0.0, 1.0, 1.0, 1.0))


@pytest.mark.parametrize("friction", [FRICTION, FRICTIONLESS], ids=["friction", "frictionless"])
def test_reset_is_static_equilibrium(pendulum: MakeRobot, friction: LuGre) -> None:
    """With tau_m = g(q), from the file by way of MuJoCo alone, nothing moves for a second: rounding, 1e-12 rad."""
    plant = plant_of(pendulum(), friction=friction)
    gravity = free_arm(pendulum()).gravity(POSE)
    assert np.abs(gravity).min() > 1.0
    np.testing.assert_array_equal(plant.q[0], POSE)
    assert plant.tau_j[0] == pytest.approx(gravity, rel=1e-9)
    start = plant.theta.copy()
    for _ in range(1000):
        plant.step(gravity[None], np.zeros((1, 2)))
    assert np.abs(plant.q - POSE).max() < 1e-12
    assert np.abs(plant.theta - start).max() < 1e-12
    assert np.abs(plant.tau_f).max() < 1e-9


def test_reset_touches_only_the_named_environments(pendulum: MakeRobot) -> None:
    plant = varied(pendulum())
    before, friction = plant.get_state(), plant.tau_f.copy()
    plant.reset(np.array([1]), POSE)
    after = plant.get_state()
    for name in ("q", "q_dot", "theta", "theta_dot", "z", "time"):
        np.testing.assert_array_equal(getattr(after, name)[[0, 2]], getattr(before, name)[[0, 2]])
    np.testing.assert_array_equal(plant.tau_f[[0, 2]], friction[[0, 2]])
    for moving in (after.q_dot[1], after.theta_dot[1], after.z[1], after.time[1], plant.tau_f[1]):
        np.testing.assert_array_equal(moving, 0.0)


def test_mass_scale_scales_inertia_and_gravity_per_environment(pendulum: MakeRobot) -> None:
    plant, arm = plant_of(pendulum(), num_envs=3), free_arm(pendulum())
    plant.configure(np.array([2]), joints=JOINTS, friction=FRICTION, mass_scale=0.5)
    plant.configure(np.array([0]), joints=JOINTS, friction=FRICTION, mass_scale=3.0)
    pose = np.tile(POSE, (3, 1))
    for i, scale in enumerate([3.0, 1.0, 0.5]):
        np.testing.assert_allclose(plant.body.dense_inertia(pose)[i], scale * dense_inertia(arm, POSE), rtol=1e-10)
        np.testing.assert_allclose(plant.body.gravity(pose)[i], scale * arm.gravity(POSE), rtol=1e-10)
    plant.configure(np.array([0]), joints=JOINTS, friction=FRICTION)
    np.testing.assert_allclose(plant.body.gravity(pose)[0], arm.gravity(POSE), rtol=1e-10)


def test_configure_and_read_back(pendulum: MakeRobot) -> None:
    plant = plant_of(pendulum(), num_envs=2)
    soft = replace(JOINTS, stiffness=np.array([1e3, 2e3]), motor_inertia=0.5)
    plant.configure(np.array([1]), joints=soft, friction=FRICTION)
    np.testing.assert_array_equal(plant.stiffness, [[3e3, 3e3], [1e3, 2e3]])
    np.testing.assert_array_equal(plant.motor_inertia, [[1.0, 1.0], [0.5, 0.5]])


class Free(Control):
    """No torque at all."""

    def __call__(self, theta: Any, v: Any, tau_j: Any) -> Any:
        return np.zeros_like(theta)


def error_of_free_motion(robot: Robot, control_dt: float = 1e-3) -> tuple[float, np.ndarray]:
    """Largest error of the links against the solver over 0.4 s without torques; the solver's links at the end."""
    plant = FlexibleJointPlant(robot, 1, joints=JOINTS, friction=FRICTIONLESS, control_dt=control_dt)
    plant.reset(np.array([0]), POSE)
    ticks = round(0.4 / control_dt)
    states = np.stack([plant.q[0], plant.q_dot[0], plant.theta[0], plant.theta_dot[0], plant.z[0]])
    theirs = sampled(free_arm(robot), Free(control_dt), states, np.zeros((ticks, 2)))[:, 0]
    worst = 0.0
    for q in theirs[1:]:
        plant.step(np.zeros((1, 2)), np.zeros((1, 2)))
        worst = max(worst, np.abs(plant.q[0] - q).max())
    return worst, theirs[-1]


@pytest.mark.parametrize(
    "attributes",
    ["", 'stiffness="40" springref="0.8"', 'damping="2"', 'armature="0.3"', 'stiffness="40" damping="2"'],
)
def test_passive_joints_of_the_file_are_honoured(pendulum: MakeRobot, attributes: str) -> None:
    """A falling double pendulum whose shoulder has the file's spring, damper or armature, against the solver.

    5e-4 rad on a fall of 0.5 rad: dampers, like all that depends on velocity, are held over the control period.
    """
    worst, end = error_of_free_motion(pendulum(shoulder=attributes))
    assert worst < 5e-4
    if attributes:
        assert np.abs(end - error_of_free_motion(pendulum())[1]).max() > 0.05


def test_limits_and_contacts_stay_out_of_the_loop(pendulum: MakeRobot) -> None:
    """A range that the fall leaves at once, and a floor in its way: neither changes the motion by a bit."""
    expected = drive(plant_of(pendulum()), 300)
    limited = pendulum(
        shoulder='limited="true" range="-0.1 0.31"',
        world='<geom name="floor" type="plane" pos="0 0 -0.2" size="1 1 0.1"/>',
    )
    np.testing.assert_array_equal(drive(plant_of(limited), 300), expected)
    # MuJoCo itself, asked about the last pose, sees both.
    model = mujoco.MjModel.from_xml_path(str(limited.path))
    data = mujoco.MjData(model)
    data.qpos[:] = expected[-1, 0, 0]
    mujoco.mj_forward(model, data)
    assert data.ncon > 0
    assert data.nefc > data.ncon
    assert mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT in data.efc_type
