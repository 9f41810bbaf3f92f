"""What a privileged compensator is told of the joints."""

from __future__ import annotations

from dataclasses import replace

from fo_gym.parameters import JointInfo, LuGre, per_joint, stacked
from fo_gym.simulation.simulation import Simulation

__all__ = ["privileged_info"]


def privileged_info(simulation: Simulation) -> JointInfo:
    """Its `joint_info`, right after a reset, with the true friction of the episodes as load and temperature have it.

    Where that is of another law than LuGre, nothing else is told than to everybody.
    """
    drawn = [per_joint(scenario.friction, simulation.dof) for scenario in simulation.scenarios]
    if not all(isinstance(friction, LuGre) for friction in drawn):
        return simulation.joint_info
    change, own = simulation.hardware_model.friction_change, stacked(drawn)
    f_c = change.dry * own.f_c + change.added
    f_s = change.dry * own.f_s + change.added + change.stiction
    return replace(
        simulation.joint_info, identified=stacked(drawn, f_c=f_c, f_s=f_s, sigma_2=change.viscous * own.sigma_2)
    )
