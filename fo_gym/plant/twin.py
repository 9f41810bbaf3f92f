"""The twin: the same flexible joints wholly in MuJoCo, to check the plant against and to open in MuJoCo's viewer."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import POSITIVE, choice, number
from fo_gym.friction import FrictionLaw, LuGre
from fo_gym.parameters import JOINT
from fo_gym.robots import LinkSide

Array = NDArray[np.float64]

INTEGRATORS = {
    "euler": mujoco.mjtIntegrator.mjINT_EULER,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "rk4": mujoco.mjtIntegrator.mjINT_RK4,
}

_MASS, _INERTIA = 1e-6, 1e-12
"""Of a motor's body [kg, kg m^2]: MuJoCo does not take zero, and makes the body's size in air from their ratio."""

__all__ = ["INTEGRATORS", "twin_data", "twin_model"]


def twin_model(
    link_side: LinkSide,
    joints: Array,
    law: FrictionLaw,
    friction: NDArray[Any],
    mass_scale: float,
    timestep: float,
    integrator: str,
    *,
    scene: bool,
) -> mujoco.MjModel:
    """The robot with a motor, a spring and LuGre friction at every joint, as one MuJoCo model.

    Every motor is a joint "<joint>_motor" of inertia B on a body of its own in the world, so that the links do not
    carry it; a fixed tendon "<joint>_spring" is K_j and D_j; the passive DC motor "<joint>_friction" is the bristle,
    whose deflection z is its activation; the actuator "<joint>_motor" takes tau_m as its control.

    Args:
        link_side: the links.
        joints: motors and springs, (dof, 3), columns as in fo_gym.parameters.JOINT.
        law: of friction; MuJoCo has LuGre alone.
        friction: its parameters, (dof,), of its dtype.
        mass_scale: factor on the masses of the file.
        timestep: MuJoCo's step [s]. Its bristles hold a stuck joint only for steps below sigma_1 / sigma_0.
        integrator: one of INTEGRATORS.
        scene: whether with geoms, cameras and lights.

    Raises:
        ValueError: the time step is not above 0, there is no such integrator, or the friction is not LuGre.
    """
    number("timestep", timestep, POSITIVE, "s")
    choice("integrator", integrator, INTEGRATORS)
    if not isinstance(law, LuGre):
        raise ValueError(f"friction is {type(law).__name__}; MuJoCo has LuGre alone: give a plant with that for a twin")
    names = friction.dtype.names or ()
    values = dict(zip(JOINT, joints.T, strict=True)) | {name: friction[name] for name in names}
    spec = link_side.scene_spec
    for j, name in enumerate(link_side.joints):
        _add_motor(spec, name, j, {field: float(value[j]) for field, value in values.items()})
    if not scene:
        for seen in (*spec.geoms, *spec.cameras, *spec.lights):
            spec.delete(seen)  # masses do not hang on them: every inertia of a link side is explicit
    model = spec.compile()
    model.body_mass[: model.nbody - link_side.dof] *= mass_scale
    model.body_inertia[: model.nbody - link_side.dof] *= mass_scale
    model.opt.timestep = timestep
    model.opt.integrator = INTEGRATORS[integrator]
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def twin_data(model: mujoco.MjModel, motion: Array, friction: NDArray[Any], time: float) -> mujoco.MjData:
    """A twin's data in a state of the plant, (5, dof) as in its `motion`, at `time` [s]; `friction` as there."""
    q, q_dot, theta, theta_dot, z = motion
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], data.time = np.concatenate([q, theta]), np.concatenate([q_dot, theta_dot]), time
    data.act[:] = z[friction["sigma_0"] > 0.0]
    mujoco.mj_forward(model, data)
    return data


def _add_motor(spec: mujoco.MjSpec, name: str, place: int, p: dict[str, float]) -> None:
    """Motor, spring and friction of one joint; p holds their parameters by name."""
    link = spec.joint(name)
    hinge = link.type == mujoco.mjtJoint.mjJNT_HINGE
    # What is made here inherits the file's defaults: all that matters to the dynamics is set. The inertia is the
    # joint's armature, so that air drag and a prescribed total mass, which go by bodies, find next to nothing.
    body = spec.worldbody.add_body(
        name=f"{name}_motor",
        pos=[-0.4, 0.2 * place, 0.1],
        gravcomp=1.0,
        ipos=[0.0, 0.0, 0.0],
        mass=_MASS,
        inertia=[_INERTIA] * 3,
        explicitinertial=True,
    )
    body.add_joint(
        name=f"{name}_motor",
        type=link.type,
        axis=[0.0, 1.0, 0.0] if hinge else link.axis,
        limited=mujoco.mjtLimited.mjLIMITED_FALSE,
        damping=[p["sigma_2"], 0.0, 0.0],
        stiffness=[0.0, 0.0, 0.0],
        armature=p["motor_inertia"] - (_INERTIA if hinge else _MASS),
        frictionloss=0.0,
        actfrclimited=mujoco.mjtLimited.mjLIMITED_FALSE,
    )
    looks = {"contype": 0, "conaffinity": 0, "mass": 0.0, "rgba": [0.17, 0.25, 0.35, 1.0]}
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.05, 0.02, 0.05], **looks)
    spring = spec.add_tendon(name=f"{name}_spring", stiffness=[p["stiffness"], 0.0, 0.0], springlength=[0.0, 0.0])
    spring.armature, spring.frictionloss = 0.0, 0.0
    spring.limited = spring.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE
    spring.damping = [p["damping"], 0.0, 0.0]
    spring.wrap_joint(f"{name}_motor", 1.0)
    spring.wrap_joint(name, -1.0)
    motor = spec.add_actuator(
        name=f"{name}_motor", target=f"{name}_motor", trntype=mujoco.mjtTrn.mjTRN_JOINT, gear=[1.0] + [0.0] * 5
    )
    motor.set_to_motor()
    _unlimited(motor)
    if p["sigma_0"] > 0.0:
        bristle = spec.add_actuator(
            name=f"{name}_friction", target=f"{name}_motor", trntype=mujoco.mjtTrn.mjTRN_JOINT, gear=[1.0] + [0.0] * 5
        )
        lugre = [p[field] for field in ("sigma_0", "sigma_1", "f_c", "f_s", "v_s")]
        none = mujoco.mjtCtrlInput.mjINPUT_NONE  # passive: no input, no electrical branch
        bristle.set_to_dcmotor(motorconst=[0.0, 0.0], resistance=1.0, lugre=lugre, ctrlspec=none)
        _unlimited(bristle)


def _unlimited(actuator: Any) -> None:
    never = mujoco.mjtLimited.mjLIMITED_FALSE
    actuator.ctrllimited = actuator.forcelimited = actuator.actlimited = never
    actuator.damping, actuator.armature = [0.0, 0.0, 0.0], 0.0
