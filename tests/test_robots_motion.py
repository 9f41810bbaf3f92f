"""A robot is the file's: inertia, gravity and tool as MuJoCo has them, and its motion where springs are stiff.

The reference is the file itself, compiled by MuJoCo as it stands; joints that the robot welds are held by leaving out
their rows and columns, which is what welding does.
"""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from robot_files import CRANE, PUSHER, URDF, ur5e

from fo_gym.friction import FRICTIONLESS
from fo_gym.parameters import FlexibleJoint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.plant.rigid_body import RigidBody
from fo_gym.robots import Robot
from fo_gym.robots.editing import compile_whole
from fo_gym.robots.file import read_spec
from fo_gym.robots.report import Notes
from fo_gym.robots.survey import Survey, survey

Array = np.ndarray


class Original:
    """What MuJoCo makes of a file, seen at the joints of a robot; nothing acts but gravity, springs and dampers."""

    def __init__(self, robot: Robot) -> None:
        file = robot.link_side.file
        if file.suffix == ".urdf":
            spec = mujoco.MjSpec.from_string(
                file.read_text().replace('<mesh filename="package://nowhere/upper.stl"/>', "")
            )
            spec.compiler.fusestatic = False
        else:
            spec = mujoco.MjSpec.from_file(str(file))
        self.model = spec.compile()
        off = mujoco.mjtDisableBit
        self.model.opt.disableflags |= int(off.mjDSBL_CONSTRAINT | off.mjDSBL_CONTACT | off.mjDSBL_ACTUATION)
        self.data = mujoco.MjData(self.model)
        for name, value in robot.link_side.frozen:
            self.data.qpos[self.model.joint(name).qposadr[0]] = value
        self.qpos = [int(self.model.joint(name).qposadr[0]) for name in robot.joints]
        self.dofs = [int(self.model.joint(name).dofadr[0]) for name in robot.joints]

    def at(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        """Inertia, armature included, and what holds the joints still, bias less passive forces."""
        self.data.qpos[self.qpos] = q
        self.data.qvel[self.dofs] = q_dot
        mujoco.mj_forward(self.model, self.data)
        dense = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, dense)
        return dense[np.ix_(self.dofs, self.dofs)], (self.data.qfrc_bias - self.data.qfrc_passive)[self.dofs]

    def tool(self, name: str) -> Array:
        """Where the tool is, at the pose of the last query."""
        site = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, name)
        return self.data.site_xpos[site] if site >= 0 else self.data.body(name).xpos


def facts(robot: Robot) -> Survey:
    notes, file = Notes(), robot.link_side.file
    return survey(compile_whole(read_spec(file, notes), file, notes)).of(robot.joints)


def crane(folder: Path, **options: object) -> Robot:
    (folder / "crane.xml").write_text(CRANE)
    return Robot.from_file(folder / "crane.xml", **options)


def two_links(folder: Path) -> Robot:
    """The URDF of two links, without what MuJoCo refuses of it."""
    text = URDF.replace('type="floating"', 'type="fixed"')
    (folder / "two.urdf").write_text(text)
    return Robot.from_file(folder / "two.urdf", tool="flange")


def robots(folder: Path) -> list[Robot]:
    return [
        Robot.from_file(PUSHER),
        Robot.from_file(ur5e()),
        two_links(folder),
        crane(folder),
        crane(folder, joints=("rail", "bend"), home="parked"),
        crane(folder, joints=("turn", "twist"), home="parked", tool="tip"),
        crane(folder, joints=("grip", "grip2"), home="parked", tool="finger2"),
    ]


def test_inertia_gravity_and_tool_are_those_of_the_file(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    for robot in robots(tmp_path):
        original, body, own = Original(robot), RigidBody(robot.link_side, 1), facts(robot)
        for _ in range(5):
            q, q_dot = robot.home + rng.normal(0.0, 0.5, robot.dof), rng.normal(0.0, 1.0, robot.dof)
            inertia, bias = original.at(q, q_dot)
            ours = body.dense_inertia(q[None])[0] + np.diag(own.armature)
            np.testing.assert_allclose(ours, inertia, rtol=1e-10, atol=1e-12, err_msg=robot.name)
            ours = body.dynamics(q[None], q_dot[None])[1][0] + body.damping * q_dot
            np.testing.assert_allclose(ours, bias, rtol=1e-9, atol=1e-10, err_msg=robot.name)
            original.at(q, np.zeros(robot.dof))
            np.testing.assert_allclose(body.gravity(q[None])[0], original.at(q, 0.0 * q)[1], rtol=1e-9, atol=1e-10)
            assert robot.tool is not None
            np.testing.assert_allclose(
                body.links.tool_position(q[None])[0], original.tool(robot.tool), rtol=0, atol=1e-12
            )


STIFF, MOTOR = 2e6, 0.05
"""K_j [N m/rad | N/m], and B [kg m^2 | kg] where the file has no armature."""


@pytest.mark.parametrize("name", ["pusher", "ur5e", "urdf", "crane"])
def test_stiff_springs_without_friction_move_as_the_file_does(name: str, tmp_path: Path) -> None:
    """Half a second under torques that grow from 0 and turn: within 1e-4 of how far each joint moves.

    MuJoCo's own Runge-Kutta integration of the file, in steps of 0.1 ms, with the file's armature and dampers. What is
    left is the spring's yield, torque / K_j, and the inertia that a control period of 0.2 ms holds.
    """
    make = {
        "pusher": lambda: Robot.from_file(PUSHER),
        "ur5e": lambda: Robot.from_file(ur5e()),
        "urdf": lambda: two_links(tmp_path),
        "crane": lambda: crane(tmp_path, joints=("rail", "turn", "bend", "twist")),
    }
    robot = make[name]()
    original, own = Original(robot), facts(robot)
    motors = np.where(own.armature > 0.0, own.armature, MOTOR)
    original.model.dof_armature[original.dofs] += motors - own.armature
    held = np.setdiff1d(np.arange(original.model.nv), original.dofs)
    original.model.dof_armature[held] = 1e12  # as good as welded
    original.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    original.model.opt.timestep = 1e-4
    joints = FlexibleJoint(stiffness=STIFF, damping=0.0, motor_inertia=motors, torque_limit=1e6)
    plant = FlexibleJointPlant(
        robot.link_side, 1, joints=joints, friction=FRICTIONLESS, control_dt=2e-4, physics_dt="auto"
    )
    plant.reset(np.array([0]), robot.home)
    gravity = original.at(robot.home, np.zeros(robot.dof))[1]
    size = 3.0 * np.diag(original.at(robot.home, np.zeros(robot.dof))[0])
    moved, apart = np.zeros(robot.dof), np.zeros(robot.dof)
    for _ in range(2500):
        torque = gravity + size * np.sin(20.0 * plant.time[0] + np.arange(robot.dof)) * min(1.0, plant.time[0] / 0.1)
        original.data.qfrc_applied[original.dofs] = torque
        mujoco.mj_step(original.model, original.data, nstep=2)
        plant.step(torque[None], np.zeros((1, robot.dof)))
        moved = np.maximum(moved, np.abs(plant.q[0] - robot.home))
        apart = np.maximum(apart, np.abs(plant.q[0] - original.data.qpos[original.qpos]))
    assert np.all(moved > 0.01)
    assert np.all(apart < 1e-4 * moved), (apart / moved).tolist()
