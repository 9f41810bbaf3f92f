"""A robot of one's own: a two-joint arm from an MJCF file, motors and friction added, as an environment.

python examples/own_robot.py
"""

import tempfile
from pathlib import Path

import gymnasium as gym
import numpy as np

import fo_gym
from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv
from fo_gym.plant import Robot
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.scenario import Push
from fo_gym.tasks.task import Task

MJCF = """
<mujoco model="two_links">
  <worldbody>
    <light name="lamp" pos="0 -1 2"/>
    <body name="upper">
      <joint name="shoulder" type="hinge" axis="0 1 0" range="-180 180"/>
      <geom name="upper" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.04" mass="2"/>
      <body name="lower" pos="0 0 -0.4">
        <joint name="elbow" type="hinge" axis="0 1 0" range="-150 150"/>
        <geom name="lower" type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03" mass="1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def two_link_task(folder: Path) -> Task:
    """Both joints step by 0.2 rad at once; the robot file is written into `folder`."""
    path = folder / "two_links.xml"
    path.write_text(MJCF, encoding="utf-8")
    return Task(
        robot=Robot(path, joints=("shoulder", "elbow")),
        joint_unit="rad",
        joints=fo_gym.FlexibleJoint(stiffness=4000.0, damping=0.0, motor_inertia=0.5, torque_limit=60.0),
        friction=fo_gym.LuGre(sigma_0=2e4, sigma_1=100.0, sigma_2=2.0, f_c=2.0, f_s=3.0, v_s=0.01),
        gains=fo_gym.PDGains(kp=60.0, kd=6.0),
        duration=5.0,
        accuracy=1e-3,
        q_start=np.zeros(2),
        step=np.full(2, 0.2),
        step_time=0.0,
        path=None,
        push=None,
        random_push=Push(time=0.0, duration=0.5, torque=np.array([5.0, 0.0])),
        limit_cycle_window=None,
        randomization=Randomization(push_time=(2.0, 3.0)),
    )


def register(folder: Path) -> None:
    """Register the environment TwoLinks-v0."""
    the_task = two_link_task(folder)

    class TwoLinksEnv(JointEnv):
        task = the_task

    class TwoLinksVectorEnv(JointVectorEnv):
        task = the_task

    gym.register("TwoLinks-v0", entry_point=TwoLinksEnv, vector_entry_point=TwoLinksVectorEnv)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        register(Path(name))
        for compensator in ("none", "pd-high", "pid-high"):
            rows = fo_gym.evaluate(compensator, "TwoLinks-v0")
            error = 1e3 * rows.steady_state_error_ju[0]
            print(f"{compensator:9s} FRR {rows.frr[0]:7.4f}   steady-state error {error:7.3f} mrad")
