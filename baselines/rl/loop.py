"""A policy's view of every joint and its hand on it; the observer that it is added to runs underneath."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.gains import check_bandwidth
from baselines.rl.design import Design
from fo_gym import JointInfo, Signals
from fo_gym.scaling import torque_ratios

Array = NDArray[np.float64]

FEATURES = (
    "rate",
    "lag",
    "integral",
    "imbalance",
    "velocity",
    "distance",
    "drive",
    "estimate",
    "action",
)
"""Inputs of the policy, in order; see `PolicyLoop`."""

__all__ = ["FEATURES", "PolicyLoop"]


class PolicyLoop:
    """The observer, the policy's inputs and its held action, for a batch of joints; who chooses the action is open.

    With e = theta_n - theta, the PID-type observer's parts and the friction scale are

        tau_pd  = -B L (e' + L_p e)
        s       = largest |tau_pd| since reset, at least `floor` times the torque limit     what friction can be here
        tau_f_hat = tau_pd - B L L_i int e + bound s action      (`residual`; else bound s action alone)

    so that nothing has to be known about the joint's friction: measured signals and B alone. Inputs are odd functions
    of measured signals, each the arsinh of a ratio of torques, `fo_gym.scaling.torque_ratios` and others:

        rate       B L e' / s                          lag       B L L_p e / s
        integral   B L L_i int e / s                   imbalance B de'/s over the past action's time
        velocity   B L theta' / s                      distance  B L L_p (theta - theta_d) / s
        drive      (tau_c - tau_j) / s                 estimate  tau_f_hat / s as last applied
        action     as last chosen (no arsinh: it is in [-1, 1])

    `imbalance` is what friction the last estimates left uncompensated: B e'' = tau_f_hat - tau_f.

    Attributes:
        feedback: "nominal".
        hold: control ticks between two actions.
        action: the held action, (num_envs, dof), in [-1, 1].
    """

    feedback = "nominal"

    def __init__(self, design: Design) -> None:
        self.design = design

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        """Start new episodes everywhere.

        Raises:
            ValueError: the observer, or the policy's rate, does not fit control_dt.
        """
        check_bandwidth(self, self.design.L, joints)
        self.hold = joints.ticks("the policy acts", self.design.period)
        self._dt = joints.control_dt
        shape = (num_envs, joints.dof)
        self._inertia, self._scale, self._integral = np.empty(shape), np.empty(shape), np.empty(shape)
        self._rate_before, self._residual, self._estimate = np.empty(shape), np.empty(shape), np.empty(shape)
        self.action = np.empty(shape)
        self.restart(np.arange(num_envs), joints)

    def restart(self, ids: NDArray[np.intp], joints: JointInfo) -> None:
        """Start new episodes in the named environments alone."""
        shape = self.action.shape
        self._inertia[ids] = np.broadcast_to(joints.motor_inertia, shape)[ids]
        self._scale[ids] = self.design.floor * np.broadcast_to(joints.torque_limit, shape)[ids]
        for memory in (self._integral, self._rate_before, self._residual, self._estimate, self.action):
            memory[ids] = 0.0

    def features(self, signals: Signals) -> Array:
        """The policy's inputs at this tick, (num_envs, dof, len(FEATURES)); asking changes nothing."""
        design, scale = self.design, self._scale
        unit = (design.L / scale) * self._inertia
        ratios = torque_ratios(signals, unit, design.Lp, scale)
        e_dot = signals.theta_n_dot - signals.theta_dot
        features = np.empty((*scale.shape, len(FEATURES)))
        features[..., 0] = ratios.rate
        features[..., 1] = ratios.lag
        features[..., 2] = (unit * design.Li) * self._integral
        features[..., 3] = self._inertia * (e_dot - self._rate_before) / (scale * design.period)
        features[..., 4] = ratios.velocity
        features[..., 5] = ratios.distance
        features[..., 6] = ratios.drive
        features[..., 7] = self._estimate / scale
        np.arcsinh(features[..., :8], out=features[..., :8])
        features[..., 8] = self.action
        return features

    def act(self, action: Array, signals: Signals) -> None:
        """Hold this action from now on, (num_envs, dof), clipped to [-1, 1]."""
        self.action = np.clip(action, -1.0, 1.0)
        self._residual = (self.design.bound * self._scale) * self.action
        self._rate_before = signals.theta_n_dot - signals.theta_dot

    def estimate(self, signals: Signals) -> Array:
        """tau_f_hat with the held action, (num_envs, dof), N or N m; call it once per control tick."""
        design, inertia = self.design, self._inertia
        e = signals.theta_n - signals.theta
        e_dot = signals.theta_n_dot - signals.theta_dot
        proportional = -(inertia * design.L) * (e_dot + design.Lp * e)
        self._scale = np.maximum(self._scale, np.abs(proportional))
        self._estimate = self._residual
        if design.residual:
            self._estimate = proportional - (inertia * design.L * design.Li) * self._integral + self._residual
        self._integral += self._dt * e
        return self._estimate
