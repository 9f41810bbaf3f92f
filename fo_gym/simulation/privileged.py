"""What a privileged compensator is told of the joints."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from fo_gym.friction import LuGre
from fo_gym.parameters import JointInfo, with_fields
from fo_gym.simulation.simulation import Simulation

__all__ = ["privileged_info"]


def privileged_info(simulation: Simulation) -> JointInfo:
    """Its `joint_info`, right after a reset, with the true friction of the episodes as load and temperature have it.

    Where that is of another law than LuGre, nothing else is told than to everybody.
    """
    drawn = [each.friction for each in simulation.scenarios if isinstance(each.friction, LuGre)]
    if len(drawn) < simulation.num_envs:
        return simulation.joint_info
    own = np.stack([friction.packed(simulation.dof) for friction in drawn])
    now = own.copy()
    LuGre.vary(own, now, *simulation.hardware_model.friction_change)
    identified = with_fields(drawn[0], {name: now[name] for name in (each.name for each in fields(LuGre))})
    return replace(simulation.joint_info, identified=identified)
