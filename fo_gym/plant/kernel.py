"""The joint kernel: motors, springs and bristles in micro-steps between two rigid-body evaluations.

One micro-step of length h is a symmetric splitting of second order: half a drift of the positions, a kick of the
velocities, half a drift. In the kick, motor velocity and bristle move together by the midpoint rule with
a = sigma_0 |v| / g(v) frozen at the middle velocity, which makes the LuGre sub-system linear; two fixed-point
passes settle the middle velocity. The bristle itself, z' = v - a z, decays over the step by
1 / (1 + x + x^2/2), x = a h, the (0,2) Pade form of exp(-x): second order, no oscillation at any x, so that
neither stiction creeps nor fast sliding rings.

No `fastmath` and no reduction over environments: an environment's result does not depend on its neighbours.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

# Layout of the packed state (5, num_envs, dof); that of the parameters is fo_gym.parameters.PARAMETERS.
STATE = ("q", "q_dot", "theta", "theta_dot", "z")

_PASSES = 2


@njit(cache=True, error_model="numpy", inline="always")
def bristle_rate(v, sigma_0, f_c, f_s, v_s):
    """A = sigma_0 |v| / g(v) [1/s], the rate at which a bristle forgets its deflection at velocity v."""
    if sigma_0 == 0.0:
        return 0.0
    s = v / v_s
    return sigma_0 * abs(v) / (f_c + (f_s - f_c) * math.exp(-s * s))


@njit(cache=True, error_model="numpy", inline="always")
def bristle_mean(a, h):
    """Weights (w_z, w_v) of the mean deflection over a step, z_mean = w_z z + w_v v, for z' = v - a z."""
    x = a * h
    scale = 1.0 / (1.0 + x + 0.5 * x * x)
    return (1.0 + 0.5 * x) * scale, 0.5 * h * (1.0 + x) * scale


@njit(cache=True, error_model="numpy")
def bristle_step(z, v, a, h, sigma_0, sigma_1, sigma_2):
    """One bristle over h seconds at velocity v, with a = bristle_rate(v, ...).

    Returns:
        (z, tau_f): deflection at the end of the step [m | rad]; mean friction torque over it [N | N m], opposing v.
    """
    w_z, w_v = bristle_mean(a, h)
    z_mean = w_z * z + w_v * v
    z_rate = v - a * z_mean if sigma_0 > 0.0 else 0.0
    return z + h * z_rate, -(sigma_0 * z_mean + sigma_1 * z_rate + sigma_2 * v)


@njit(cache=True, error_model="numpy", inline="always")
def _middle_velocity(a, v, z, drive, h, p):
    """Motor velocity at the middle of the kick, with the bristle eliminated from the midpoint equations.

    `drive` [N | N m] is everything on the motor but friction and -D_j v_middle; p are the PARAMETERS.
    """
    w_z, w_v = bristle_mean(a, h)
    elastic = p[3] - p[4] * a
    viscous = p[1] + p[5] + (p[4] if p[3] > 0.0 else 0.0)
    half = 0.5 * h / p[2]
    return (v + half * (drive - elastic * w_z * z)) / (1.0 + half * (viscous + elastic * w_v))


@njit(cache=True, error_model="numpy")
def _factorise(inertia, row_nonzeros, row_start, columns, added, lower):
    """Cholesky factor of M + diag(added) into `lower`, M from MuJoCo's sparse lower triangle. False if not positive."""
    dof = lower.shape[0]
    for i in range(dof):
        for j in range(dof):
            lower[i, j] = 0.0
        for k in range(row_nonzeros[i]):
            lower[i, columns[row_start[i] + k]] = inertia[row_start[i] + k]
        lower[i, i] += added[i]
    for i in range(dof):
        for j in range(i + 1):
            value = lower[i, j]
            for k in range(j):
                value -= lower[i, k] * lower[j, k]
            if i == j:
                if not value > 0.0:
                    return False
                lower[i, i] = math.sqrt(value)
            else:
                lower[i, j] = value / lower[j, j]
    return True


@njit(cache=True, error_model="numpy")
def _solve(lower, x):
    """Solve (L L^T) x = x in place."""
    dof = x.shape[0]
    for i in range(dof):
        for k in range(i):
            x[i] -= lower[i, k] * x[k]
        x[i] /= lower[i, i]
    for i in range(dof - 1, -1, -1):
        for k in range(i + 1, dof):
            x[i] -= lower[k, i] * x[k]
        x[i] /= lower[i, i]


@njit(cache=True, error_model="numpy")
def _kick(q, w, theta, v, z, load, damping, tau_m, p, lower, h, damped, a, v_mid, w_mid, tau_f_sum):
    """Velocities and bristles of one environment over h at held positions; adds tau_f to `tau_f_sum`."""
    dof = q.shape[0]
    for j in range(dof):
        v_mid[j] = v[j]
        w_mid[j] = w[j]
    for sweep in range(_PASSES):
        for j in range(dof):
            a[j] = bristle_rate(v_mid[j], p[j, 3], p[j, 6], p[j, 7], p[j, 8])
            drive = tau_m[j] - p[j, 0] * (theta[j] - q[j]) + p[j, 1] * w_mid[j]
            v_mid[j] = _middle_velocity(a[j], v[j], z[j], drive, h, p[j])
        # The links feel the motors' velocities only through the springs' damping.
        if damped or sweep == _PASSES - 1:
            for j in range(dof):
                spring = p[j, 0] * (theta[j] - q[j]) + p[j, 1] * (v_mid[j] - w[j])
                w_mid[j] = 0.5 * h * (spring - damping[j] * w[j] + load[j])
            _solve(lower, w_mid)
            for j in range(dof):
                w_mid[j] += w[j]
    for j in range(dof):
        z[j], tau_f = bristle_step(z[j], v_mid[j], a[j], h, p[j, 3], p[j, 4], p[j, 5])
        tau_f_sum[j] += tau_f
        v[j] = 2.0 * v_mid[j] - v[j]
        w[j] = 2.0 * w_mid[j] - w[j]


@njit(cache=True, error_model="numpy")
def predict(state, q_dot_before, dt, q, q_dot):
    """The predicted middle of a control period of dt seconds, into q and q_dot (num_envs, dof).

    q_middle = q + q' dt/2, q'_middle = q' + (q' - q'_before)/2; q_dot_before becomes the present q'.
    """
    num_envs, dof = q.shape
    for i in range(num_envs):
        for j in range(dof):
            rate = state[1, i, j]
            q[i, j] = state[0, i, j] + (0.5 * dt) * rate
            q_dot[i, j] = 1.5 * rate - 0.5 * q_dot_before[i, j]
            q_dot_before[i, j] = rate


@njit(cache=True, error_model="numpy")
def spring_torque(state, parameters, tau_j):
    """What the torque sensors measure, K_j (theta - q) + D_j (theta' - q'), into tau_j (num_envs, dof)."""
    num_envs, dof = tau_j.shape
    for i in range(num_envs):
        for j in range(dof):
            spring = parameters[i, j, 0] * (state[2, i, j] - state[0, i, j])
            tau_j[i, j] = spring + parameters[i, j, 1] * (state[3, i, j] - state[1, i, j])


@njit(cache=True, error_model="numpy", nogil=True)
def advance(state, tau_m, load, damping, inertia, row_nonzeros, row_start, columns, parameters, h, steps, tau_f):
    """Advance every environment by `steps` micro-steps of h seconds, in place.

    Args:
        state: (5, num_envs, dof), rows as in STATE.
        tau_m: motor torque, held, (num_envs, dof).
        load: tau_ext - bias on the links, held, (num_envs, dof).
        damping: of dampers between the links and the world, held, (num_envs, dof).
        inertia: M of each environment as MuJoCo's sparse lower triangle, held, (num_envs, nonzeros).
        row_nonzeros, row_start, columns: that triangle's layout.
        parameters: (num_envs, dof, 9), columns as in PARAMETERS.
        h: micro-step [s].
        steps: micro-steps.
        tau_f: out, mean friction torque over the whole period, (num_envs, dof).
    """
    num_envs, dof = tau_m.shape
    lower = np.empty((dof, dof))
    added = np.empty(dof)
    a = np.empty(dof)
    v_mid = np.empty(dof)
    w_mid = np.empty(dof)
    for i in range(num_envs):
        q, w, theta, v, z = state[0, i], state[1, i], state[2, i], state[3, i], state[4, i]
        p = parameters[i]
        damped = False
        for j in range(dof):
            added[j] = 0.5 * h * (p[j, 1] + damping[i, j])
            damped = damped or p[j, 1] > 0.0
            tau_f[i, j] = 0.0
        if not _factorise(inertia[i], row_nonzeros, row_start, columns, added, lower):
            # M is positive definite for every finite pose: the state is lost, and says so.
            state[:, i, :] = np.nan
            tau_f[i, :] = np.nan
            continue
        for step in range(steps):
            # Two half drifts meet between micro-steps; only the first and the last are half.
            drift = h if step > 0 else 0.5 * h
            for j in range(dof):
                q[j] += drift * w[j]
                theta[j] += drift * v[j]
            _kick(q, w, theta, v, z, load[i], damping[i], tau_m[i], p, lower, h, damped, a, v_mid, w_mid, tau_f[i])
        for j in range(dof):
            q[j] += 0.5 * h * w[j]
            theta[j] += 0.5 * h * v[j]
            tau_f[i, j] /= steps
