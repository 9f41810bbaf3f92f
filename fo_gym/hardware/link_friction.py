"""Friction of the links' bearings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, Value, check_values
from fo_gym.hardware.effect import Effect, Episodes
from fo_gym.parameters import check_joints

__all__ = ["LinkFriction"]


@dataclass(frozen=True, eq=False)
class LinkFriction(Effect):
    """Friction of the link's bearings, -(coulomb tanh(q'/width) + viscous q'), which no motor-side observer can see.

    Origin: dry friction of a bearing that carries the link is little beside the gear's: about 0.5 mu P d, mu = 0.0024
    for four-point contact (SKF's estimate). Where it sticks, the spring holds a torque that depends on how the link
    came there. The viscous share is ours.

    Attributes:
        coulomb: [N | N m], at least 0.
        viscous: [N s/m | N m s/rad], at least 0.
        width: velocity at which it has nearly reached `coulomb` [m/s | rad/s], above 0.
    """

    coulomb: Value
    viscous: Value
    width: Value

    def __post_init__(self) -> None:
        check_values(self, coulomb=NOT_NEGATIVE, viscous=NOT_NEGATIVE, width=POSITIVE)

    def check_joints(self, dof: int) -> None:
        """See Effect."""
        check_joints(self, dof)

    def link_damping(self, episodes: Episodes) -> NDArray[np.float64]:
        """See Effect: the friction over q' itself."""
        speed = episodes.truth.q_dot / self.width
        share = np.divide(np.tanh(speed), speed, out=np.ones_like(speed), where=speed != 0.0)
        return np.asarray(self.coulomb / self.width * share + self.viscous)
