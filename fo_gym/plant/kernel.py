"""The joint kernel: motors, springs and friction in micro-steps between two rigid-body evaluations.

One micro-step of length h is a symmetric splitting of second order: half a drift of the positions, a kick of the
velocities, half a drift. In the kick, motor velocity and the states of friction move together by the midpoint rule,
with friction linear in the middle velocity, as its law gives it; two fixed-point passes settle the middle velocity.

There is one kernel for each friction law, made of the law's own two functions, see fo_gym.plant.kernels.

No `fastmath` and no reduction over environments: an environment's result does not depend on its neighbours.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

# Rows of the packed state (4 + states, num_envs, dof), before those of friction's states.
MOTION = ("q", "q_dot", "theta", "theta_dot")

_PASSES = 2


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
def spring_torque(state, joints, tau_j):
    """What the torque sensors measure, K_j (theta - q) + D_j (theta' - q'), into tau_j (num_envs, dof)."""
    num_envs, dof = tau_j.shape
    for i in range(num_envs):
        for j in range(dof):
            spring = joints[i, j, 0] * (state[2, i, j] - state[0, i, j])
            tau_j[i, j] = spring + joints[i, j, 1] * (state[3, i, j] - state[1, i, j])


def kernel(respond, step, states, memory):
    """The kernel of a law from its compiled functions, its number of states and what it hands on."""

    @njit(error_model="numpy")
    def kick(q, w, theta, v, z, load, damping, tau_m, joints, friction, lower, h, damped, v_mid, w_mid, tau_f, memo):
        """Velocities and states of friction of one environment over h at held positions; adds to the sum `tau_f`."""
        dof = q.shape[0]
        for j in range(dof):
            v_mid[j] = v[j]
            w_mid[j] = w[j]
        for sweep in range(_PASSES):
            for j in range(dof):
                drive = tau_m[j] - joints[j, 0] * (theta[j] - q[j]) + joints[j, 1] * w_mid[j]
                held, slope = respond(v_mid[j], z[j], h, friction[j], memo[j])
                half = 0.5 * h / joints[j, 2]
                v_mid[j] = (v[j] + half * (drive - held)) / (1.0 + half * (joints[j, 1] + slope))
            # The links feel the motors' velocities only through the springs' damping.
            if damped or sweep == _PASSES - 1:
                for j in range(dof):
                    spring = joints[j, 0] * (theta[j] - q[j]) + joints[j, 1] * (v_mid[j] - w[j])
                    w_mid[j] = 0.5 * h * (spring - damping[j] * w[j] + load[j])
                _solve(lower, w_mid)
                for j in range(dof):
                    w_mid[j] += w[j]
        for j in range(dof):
            tau_f[j] += step(v_mid[j], z[j], h, friction[j], memo[j])
            v[j] = 2.0 * v_mid[j] - v[j]
            w[j] = 2.0 * w_mid[j] - w[j]

    @njit(error_model="numpy", nogil=True)
    def advance(
        state, tau_m, load, damping, inertia, row_nonzeros, row_start, columns, joints, friction, h, steps, tau_f
    ):
        """Advance every environment by `steps` micro-steps of h seconds, in place.

        Args:
            state: (4 + states, num_envs, dof), rows as in MOTION, then the law's states.
            tau_m: motor torque, held, (num_envs, dof).
            load: tau_ext - bias on the links, held, (num_envs, dof).
            damping: of dampers between the links and the world, held, (num_envs, dof).
            inertia: M of each environment as MuJoCo's sparse lower triangle, held, (num_envs, nonzeros).
            row_nonzeros, row_start, columns: that triangle's layout.
            joints: motors and springs, (num_envs, dof, 3), columns as in fo_gym.parameters.JOINT.
            friction: the law's parameters, (num_envs, dof), of its dtype.
            h: micro-step [s].
            steps: micro-steps.
            tau_f: out, mean friction torque over the whole period, (num_envs, dof).
        """
        num_envs, dof = tau_m.shape
        lower, vectors = np.empty((dof, dof)), np.empty((3, dof))
        added, v_mid, w_mid = vectors[0], vectors[1], vectors[2]
        z, memo = np.empty((dof, states)), np.empty((dof, memory))
        for i in range(num_envs):
            q, w, theta, v = state[0, i], state[1, i], state[2, i], state[3, i]
            damped = False
            for j in range(dof):
                added[j] = 0.5 * h * (joints[i, j, 1] + damping[i, j])
                damped = damped or joints[i, j, 1] > 0.0
                tau_f[i, j] = 0.0
                for k in range(states):
                    z[j, k] = state[4 + k, i, j]
            if not _factorise(inertia[i], row_nonzeros, row_start, columns, added, lower):
                # M is positive definite for every finite pose: the state is lost, and says so.
                state[:, i, :] = np.nan
                tau_f[i, :] = np.nan
                continue
            pull, damper, drive, joint, rubs, sums = load[i], damping[i], tau_m[i], joints[i], friction[i], tau_f[i]
            for number in range(steps):
                # Two half drifts meet between micro-steps; only the first and the last are half.
                drift = h if number > 0 else 0.5 * h
                for j in range(dof):
                    q[j] += drift * w[j]
                    theta[j] += drift * v[j]
                kick(q, w, theta, v, z, pull, damper, drive, joint, rubs, lower, h, damped, v_mid, w_mid, sums, memo)
            for j in range(dof):
                q[j] += 0.5 * h * w[j]
                theta[j] += 0.5 * h * v[j]
                tau_f[i, j] /= steps
                for k in range(states):
                    state[4 + k, i, j] = z[j, k]

    return advance
