"""Feed-forward of Coulomb and viscous friction, what most industrial controllers ship.

    tau_f_hat = -(f_c tanh(v_r / v_s) + sigma_2 theta')
    v_r = theta_d' + rate (theta_d - theta)

B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, "A Survey of Models, Analysis Tools and Compensation Methods for
the Control of Machines with Friction", Automatica 1994; this form is ours. The sign of the measured velocity says
nothing at rest, which is where Coulomb friction matters, so practice takes the controller's reference velocity v_r:
along a path that of the path, after a step of theta_d the way to go. tanh smooths the sign over the Stribeck velocity,
hence at rest over v_s / rate of position error. Viscous friction is that of the measured velocity. There is no feedback
of what friction truly is: too large an f_c drives the joint, too small a one leaves it short of the target.

Discrete time: theta_d' is the difference quotient over the past period, 0 at the first tick. A jump of theta_d makes it
huge for one tick, which tanh makes the right sign.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_gain, check_share
from baselines.lugre1995 import checked_friction, model_of
from fo_gym import JointInfo, LuGre, Signals

Array = NDArray[np.float64]

__all__ = ["FrictionFeedForward", "feedforward"]


class FrictionFeedForward:
    """tau_f_hat = -(f_c tanh(v_r / v_s) + sigma_2 theta') with measured feedback.

    Args:
        friction: f_c, sigma_2 and v_s of the joints, the rest is not used; None takes what was identified for the robot
            (`JointInfo.identified`).
        rate: how fast the reference velocity closes the position error [1/s], above 0.
        dry, viscous: shares of Coulomb and viscous friction that are cancelled, in (0, 1].
    """

    feedback = "measured"
    search_space: ClassVar[dict[str, tuple[float, float]]] = {
        "rate": (1.0, 100.0),
        "dry": (0.3, 1.0),
        "viscous": (0.03, 1.0),
    }

    def __init__(
        self, friction: LuGre | None = None, rate: float = 10.0, dry: float = 1.0, viscous: float = 1.0
    ) -> None:
        self.friction = checked_friction(self, friction)
        self.rate = check_gain(self, "rate", rate)
        self.dry, self.viscous = check_share(self, "dry", dry), check_share(self, "viscous", viscous)

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes. Raises ValueError where no friction model fits the robot."""
        self._model = model_of(self, self.friction, joints)
        self._dt = joints.control_dt
        self._theta_d: Array | None = None

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat, (num_envs, dof), N or N m."""
        theta_d = signals.theta_d.copy()
        theta_d_dot = (theta_d - self._theta_d) / self._dt if self._theta_d is not None else 0.0
        self._theta_d = theta_d
        v_r = theta_d_dot + self.rate * (theta_d - signals.theta)
        p = self._model
        return -(self.dry * p.f_c * np.tanh(v_r / p.v_s) + self.viscous * p.sigma_2 * signals.theta_dot)


def feedforward(
    friction: LuGre | None = None, rate: float = 10.0, dry: float = 1.0, viscous: float = 1.0
) -> FrictionFeedForward:
    """The feed-forward with the identified friction of the robot."""
    return FrictionFeedForward(friction, rate, dry, viscous)
