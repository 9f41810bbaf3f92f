"""Observers beside a motor that is written out here, for the tests of the published ones."""

from __future__ import annotations

import numpy as np

import fo_gym
from fo_gym.certificate.cases import FRICTION
from fo_gym.robots import robot_of

DT = 1e-3


IDENTIFIED = {1: FRICTION, 7: robot_of("miro_like").friction}
"""Of the two shipped robots, by their number of joints."""


def joints(dof=7, control_dt=DT, inertia=1.3, limit=1e9):
    arrays = np.full(dof, inertia), np.full(dof, 3e3), np.full(dof, limit)
    return fo_gym.JointInfo(dof, *arrays, control_dt, IDENTIFIED.get(dof))


def random_observations(ticks, num_envs, dof=7, seed=0):
    return np.random.default_rng(seed).normal(size=(ticks, num_envs, 8 * dof + 1))


def answers(observer, observations, info):
    """Estimates (ticks, num_envs, dof) over observations (ticks, num_envs, 8 dof + 1)."""
    observer.reset(info, observations.shape[1])
    return np.array([observer.estimate(fo_gym.Signals.from_observation(obs.copy(), info.dof)) for obs in observations])


def on_a_motor(observer, friction, tau_j, tau_c, dt=DT, inertia=1.3, limit=1e9):
    """Estimates while `observer` compensates a motor under these torques, each (ticks,) and held over its period."""
    observer.reset(joints(1, dt, inertia, limit), 1)
    theta = theta_dot = theta_n = theta_n_dot = tau_m = 0.0
    estimates = np.empty(len(friction))
    for k in range(len(friction)):
        row = np.array([[theta, theta_dot, tau_j[k], theta_n, theta_n_dot, 0.0, tau_c[k], tau_m, k * dt]])
        estimates[k] = observer.estimate(fo_gym.Signals.from_observation(row, 1))[0, 0]
        tau_m = tau_c[k] - np.clip(estimates[k], -limit, limit)
        a = (tau_m - tau_j[k] + friction[k]) / inertia
        a_n = (tau_c[k] - tau_j[k]) / inertia
        theta, theta_dot = theta + dt * theta_dot + 0.5 * dt**2 * a, theta_dot + dt * a
        theta_n, theta_n_dot = theta_n + dt * theta_n_dot + 0.5 * dt**2 * a_n, theta_n_dot + dt * a_n
    return estimates
