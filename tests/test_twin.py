"""The MuJoCo twin of a plant: what it is made of, the state it starts in, and that it moves like the plant."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from pendulum import FRICTION, JOINTS, POSE, MakeRobot, drive, plant_of, varied

from fo_gym.friction import FRICTIONLESS
from fo_gym.parameters import per_joint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import LinkSide

DEFAULTS = """
  <default><joint damping="0.5" armature="0.2" limited="true" range="-0.1 0.1" frictionloss="0"/></default>
  <keyframe><key name="home" qpos="0.3 -0.8"/></keyframe>
"""
ELBOWS = {"hinge": 'axis="0 1 0"', "slide": 'axis="0 0 1"'}


def elbowed(pendulum: MakeRobot, kind: str, **parts: str) -> LinkSide:
    """A hinged upper arm with a hinged fore arm, or with one that slides up and down."""
    return pendulum(elbow=ELBOWS[kind], elbow_type=kind, **parts)


def inertia_of(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    dense = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, dense)
    return dense


def step_twin(model: mujoco.MjModel, data: mujoco.MjData, tau_m: np.ndarray, tau_ext: np.ndarray, steps: int) -> None:
    data.ctrl[:] = tau_m
    data.qfrc_applied[: len(tau_ext)] = tau_ext
    mujoco.mj_step(model, data, steps)


# --- What it is made of ----------------------------------------------------------------------------------------------


def test_names_and_sizes(pendulum: MakeRobot) -> None:
    model, data = plant_of(pendulum()).to_mujoco(timestep=5e-5, integrator="rk4")
    assert [model.joint(i).name for i in range(model.njnt)] == ["shoulder", "elbow", "shoulder_motor", "elbow_motor"]
    assert [model.tendon(i).name for i in range(model.ntendon)] == ["shoulder_spring", "elbow_spring"]
    actuators = {model.actuator(i).name for i in range(model.nactuator)}
    assert actuators == {"shoulder_motor", "elbow_motor", "shoulder_friction", "elbow_friction"}
    assert (model.nq, model.nv, model.nu, model.na) == (4, 4, 2, 2)
    assert [model.actuator(f"{name}_motor").id for name in ("shoulder", "elbow")] == sorted(
        model.actuator(f"{name}_motor").id for name in ("shoulder", "elbow")
    )
    assert (model.opt.timestep, model.opt.integrator) == (5e-5, mujoco.mjtIntegrator.mjINT_RK4)
    assert data.ctrl.shape == (2,)


@pytest.mark.parametrize("kind", ELBOWS)
def test_inertia_is_the_links_and_the_motors_apart(pendulum: MakeRobot, kind: str) -> None:
    """Links as in the plant, motors B, and nothing between them; the motors stand beside the robot."""
    plant = FlexibleJointPlant(
        elbowed(pendulum, kind), 1, joints=replace(JOINTS, motor_inertia=np.array([0.7, 1.3])), friction=FRICTION
    )
    plant.reset(np.array([0]), POSE)
    expected = np.zeros((4, 4))
    expected[:2, :2] = plant.body.dense_inertia(plant.q)[0]
    expected[2:, 2:] = np.diag([0.7, 1.3])
    np.testing.assert_allclose(inertia_of(*plant.to_mujoco()), expected, atol=1e-12)


@pytest.mark.parametrize("kind", ELBOWS)
def test_without_a_scene_it_is_the_same_dynamics(pendulum: MakeRobot, kind: str) -> None:
    """Masses that are the geoms' too; what is seen is gone."""
    plant = FlexibleJointPlant(elbowed(pendulum, kind), 1, joints=JOINTS, friction=FRICTION)
    plant.reset(np.array([0]), POSE)
    (whole, its), (lean, own) = plant.to_mujoco(), plant.to_mujoco(scene=False)
    assert whole.ngeom > 0
    assert (lean.ngeom, lean.ncam, lean.nlight) == (0, 0, 0)
    np.testing.assert_allclose(inertia_of(lean, own), inertia_of(whole, its), rtol=0.0, atol=1e-12)
    for model, data in ((whole, its), (lean, own)):
        step_twin(model, data, np.array([3.0, -2.0]), np.zeros(2), 200)
    assert np.abs(its.qpos - plant.to_mujoco()[1].qpos).max() > 1e-4
    np.testing.assert_allclose(own.qpos, its.qpos, rtol=0.0, atol=1e-9)


def test_mass_scale_is_the_links(pendulum: MakeRobot) -> None:
    plant = varied(pendulum())
    heavy, light = (inertia_of(*plant.to_mujoco(env)) for env in (1, 0))
    assert plant.body.mass_scale.tolist() == [1.0, 1.7, 1.0]
    np.testing.assert_allclose(heavy[:2, :2], plant.body.dense_inertia(plant.q)[1], rtol=1e-9)
    np.testing.assert_array_equal(heavy[2:, 2:], light[2:, 2:])


def test_joints_without_bristles_have_no_bristle(pendulum: MakeRobot) -> None:
    """sigma_0 = 0 is no friction, or viscous friction alone."""
    friction = replace(per_joint(FRICTION, 2), sigma_0=np.array([0.0, 1e4]), sigma_2=np.array([0.3, 0.4]))
    model, data = plant_of(pendulum(), friction=friction).to_mujoco()
    assert {model.actuator(i).name for i in range(model.nactuator)} == {
        "shoulder_motor",
        "elbow_motor",
        "elbow_friction",
    }
    assert (model.nu, model.na, data.act.shape) == (2, 1, (1,))
    np.testing.assert_array_equal(model.dof_damping, [0.0, 0.0, 0.3, 0.4])
    model, data = plant_of(pendulum(), friction=FRICTIONLESS).to_mujoco()
    assert (model.nu, model.na, model.nactuator) == (2, 0, 2)


def test_motors_inherit_nothing_from_the_file(pendulum: MakeRobot) -> None:
    """Damping and range of the file's defaults stay with the links; armature and keyframes of the links go."""
    plant = plant_of(pendulum(rest=DEFAULTS))
    model, data = plant.to_mujoco()
    assert model.nkey == 0
    np.testing.assert_array_equal(model.dof_damping, [0.5, 0.5, 0.4, 0.4])
    np.testing.assert_allclose(model.dof_armature, [0.0, 0.0, 1.0, 1.0], rtol=1e-8)  # the motors' B
    np.testing.assert_array_equal(model.jnt_limited[2:], 0)
    step_twin(model, data, plant.tau_j[0], np.zeros(2), 100)
    assert data.nefc == 0, "the links' range acts"


@pytest.mark.parametrize("timestep", [0.0, -1e-4, np.nan, np.inf])
def test_bad_time_step_is_refused(pendulum: MakeRobot, timestep: float) -> None:
    with pytest.raises(ValueError, match=r"timestep is .* above 0"):
        plant_of(pendulum()).to_mujoco(timestep=timestep)


def test_unknown_integrator_is_refused(pendulum: MakeRobot) -> None:
    with pytest.raises(ValueError, match=r"integrator is 'RK4'; allowed are .*'rk4'"):
        plant_of(pendulum()).to_mujoco(integrator="RK4")


# --- The state it starts in ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("env", [0, 1, 2])
def test_it_starts_where_the_plant_is(pendulum: MakeRobot, env: int) -> None:
    """In mid-motion; environment 1 has no friction, and so no bristles to carry over."""
    plant = varied(pendulum())
    drive(plant, 3)
    _, data = plant.to_mujoco(env)
    np.testing.assert_array_equal(data.qpos, np.concatenate([plant.q[env], plant.theta[env]]))
    np.testing.assert_array_equal(data.qvel, np.concatenate([plant.q_dot[env], plant.theta_dot[env]]))
    np.testing.assert_array_equal(data.act, [] if env == 1 else plant.z[env])
    assert data.time == plant.time[env] > 0.0
    assert env == 1 or np.abs(data.act).min() > 0.0


def test_asking_changes_nothing_in_the_plant(pendulum: MakeRobot) -> None:
    plant, other = varied(pendulum()), varied(pendulum())
    model, data = plant.to_mujoco(2)
    step_twin(model, data, np.ones(2), np.ones(2), 100)
    np.testing.assert_array_equal(drive(plant, 20), drive(other, 20))


# --- How it moves ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("friction", [FRICTION, FRICTIONLESS], ids=["friction", "frictionless"])
@pytest.mark.parametrize("kind", ELBOWS)
def test_gravity_does_not_act_on_motors(pendulum: MakeRobot, kind: str, friction) -> None:
    """At rest with tau_m = g(q) nothing accelerates, not even motors that slide up and down."""
    plant = FlexibleJointPlant(elbowed(pendulum, kind), 1, joints=JOINTS, friction=friction)
    plant.reset(np.array([0]), POSE)
    assert np.abs(plant.tau_j).min() > 1.0
    model, data = plant.to_mujoco()
    data.ctrl[:] = plant.tau_j[0]
    mujoco.mj_forward(model, data)
    assert np.abs(data.qacc).max() < 1e-9


@pytest.mark.parametrize("integrator", ["euler", "implicit", "implicitfast", "rk4"])
@pytest.mark.parametrize("kind", ELBOWS)
def test_first_steps_agree_with_the_plant(pendulum: MakeRobot, kind: str, integrator: str) -> None:
    """20 ms under torques on motors and links: 1 % of the way; MuJoCo's integrators are of first order here."""
    joints = replace(JOINTS, damping=2.0, motor_inertia=np.array([0.7, 1.3]))
    plant = FlexibleJointPlant(elbowed(pendulum, kind), 1, joints=joints, friction=FRICTION, physics_dt=2.5e-5)
    plant.configure(np.array([0]), joints=joints, friction=FRICTION, mass_scale=1.4)
    plant.reset(np.array([0]), POSE)
    model, data = plant.to_mujoco(timestep=1e-5, integrator=integrator)
    start, tau_m, tau_ext = data.qpos.copy(), plant.tau_j[0] + [6.0, -5.0], np.array([3.0, -2.0])
    for _ in range(20):
        plant.step(tau_m[None], tau_ext[None])
        step_twin(model, data, tau_m, tau_ext, 100)
    ours = np.concatenate([plant.q[0], plant.theta[0]])
    assert np.abs(ours - start).min() > 1e-5
    np.testing.assert_allclose(data.qpos - start, ours - start, rtol=1e-2)
    bristles = [data.actuator(f"{name}_friction").force[0] for name in plant.link_side.joints]
    np.testing.assert_allclose(bristles - 0.4 * data.qvel[2:], plant.tau_f[0], rtol=1e-2)
    assert data.time == pytest.approx(plant.time[0])


@pytest.mark.parametrize(
    "rest",
    [
        '<default><joint actuatorfrcrange="-1 1"/></default>',
        '<default><motor ctrlrange="-1 1"/></default>',
        '<default><general ctrlrange="-1 1" forcerange="-1 1"/></default>',
        '<default><tendon armature="2" damping="50"/></default>',
        '<option density="1.2" viscosity="2e-5"/>',
    ],
)
def test_defaults_and_air_of_the_file_do_not_reach_the_motors(pendulum: MakeRobot, rest: str) -> None:
    """Under 20 N m at both motors for 0.2 s the twin does what the plant does, up to its own error at 1e-4 s."""
    plant = plant_of(pendulum(rest=rest))
    model, data = plant.to_mujoco()
    start = plant.q[0].copy()
    for _ in range(200):
        plant.step(np.full((1, 2), 20.0), np.zeros((1, 2)))
    step_twin(model, data, np.full(2, 20.0), np.zeros(2), 2000)
    assert np.abs(plant.q[0] - start).max() > 0.1
    np.testing.assert_allclose(data.qpos, np.concatenate([plant.q[0], plant.theta[0]]), atol=5e-3)
