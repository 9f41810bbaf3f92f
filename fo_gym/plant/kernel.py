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

from fo_gym.compiling import jit

# Rows of the packed state (4 + states, num_envs, dof), before those of friction's states.
MOTION = ("q", "q_dot", "theta", "theta_dot")

_PASSES = 2

_BLOCK = 112
"""Joints of a block of environments, about."""


@jit
def _factorise(inertia, row_nonzeros, row_start, columns, added, lower):
    """Cholesky factor L of M + diag(added), M from MuJoCo's sparse lower triangle; False where it is not positive.

    `lower` holds L with the reciprocals of its diagonal, so that `_solve` need not divide.
    """
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
                lower[i, i] = 1.0 / math.sqrt(value)
            else:
                lower[i, j] = value * lower[j, j]
    return True


@jit
def _solve(lower, x):
    """Solve (L L^T) x = x in place, (dof, n) for n environments side by side; `lower`, (dof, dof, n), as above."""
    dof, envs = x.shape
    for i in range(dof):
        for k in range(i):
            for e in range(envs):
                x[i, e] -= lower[i, k, e] * x[k, e]
        for e in range(envs):
            x[i, e] *= lower[i, i, e]
    for i in range(dof - 1, -1, -1):
        for k in range(i + 1, dof):
            for e in range(envs):
                x[i, e] -= lower[k, i, e] * x[k, e]
        for e in range(envs):
            x[i, e] *= lower[i, i, e]


@jit
def predict(state, before, ticks, dt, q, q_dot, first, last):
    """The predicted middle of a control period of dt seconds, into q and q_dot (last - first, dof).

    q_middle = q + q' dt/2, q'_middle = q' + (q' - q'_before)/2, for the environments from `first` to `last`. The state
    a period ago, `before`, becomes the present one, and `ticks` (num_envs,) count the period.
    """
    for i in range(first, last):
        ticks[i] += 1
        for j in range(state.shape[2]):
            rate = state[1, i, j]
            q[i - first, j] = state[0, i, j] + (0.5 * dt) * rate
            q_dot[i - first, j] = 1.5 * rate - 0.5 * before[1, i, j]
            for row in range(len(state)):
                before[row, i, j] = state[row, i, j]


@jit
def sense(state, joints, theta, theta_dot, tau_j):
    """What perfect sensors give, (num_envs, dof) each: the motors' motion, and K_j (theta - q) + D_j (theta' - q')."""
    num_envs, dof = tau_j.shape
    for i in range(num_envs):
        for j in range(dof):
            theta[i, j], theta_dot[i, j] = state[2, i, j], state[3, i, j]
            spring = joints[i, j, 0] * (state[2, i, j] - state[0, i, j])
            tau_j[i, j] = spring + joints[i, j, 1] * (state[3, i, j] - state[1, i, j])


@jit
def _begin(start, end, first, h, state, torques, links, layout, joints, held, z, damped, lower):
    """What is held over a period for the environments from `start` to `end`, and the states of their friction."""
    tau_m, motor_torque, tau_ext = torques
    bias, passive, inertia, link_damping, damping = links
    load, damper, half, drive = held[0], held[1], held[2], held[3]
    dof = len(lower)
    added = np.empty(dof)
    for i in range(start, end):
        damped[i - start] = False
        for j in range(dof):
            m = (i - start) * dof + j
            drive[m] = tau_m[i, j] + motor_torque[i, j]
            load[m] = tau_ext[i, j] - (bias[i - first, j] - passive[i - first, j])
            damper[m] = link_damping[i, j] + damping[j]
            half[m] = 0.5 * h / joints[i, j, 2]
            added[j] = 0.5 * h * (joints[i, j, 1] + damper[m])
            damped[i - start] = damped[i - start] or joints[i, j, 1] > 0.0
            for k in range(z.shape[1]):
                z[m, k] = state[4 + k, i, j]
        if not _factorise(inertia[i - first], layout[0], layout[1], layout[2], added, lower[:, :, i - start]):
            # M is positive definite for every finite pose: the state is lost, and says so.
            state[:, i, :] = np.nan
            lower[:, :, i - start] = np.nan


def kernel(respond, step, states, memory):
    """The kernel of a law from its compiled functions, its number of states and what it hands on."""

    @njit(inline="always", error_model="numpy")
    def kick(q, w, theta, v, z, held, joints, friction, lower, h, damped, scratch, x, tau_f, memo):
        """Velocities and states of friction of a block over h at held positions; adds to the sum `tau_f`."""
        dof, envs = len(x), len(damped)
        load, damper, half, tau_m = held[0], held[1], held[2], held[3]
        v_mid, w_mid, spring = scratch[0], scratch[1], scratch[2]
        for j in range(envs * dof):
            v_mid[j] = v[j]
            w_mid[j] = w[j]
            spring[j] = joints[j, 0] * (theta[j] - q[j])
        for sweep in range(_PASSES):
            for j in range(envs * dof):
                drive = tau_m[j] - spring[j] + joints[j, 1] * w_mid[j]
                rest, slope = respond(v_mid[j], z[j], h, friction[j], memo[j])
                v_mid[j] = (v[j] + half[j] * (drive - rest)) / (1.0 + half[j] * (joints[j, 1] + slope))
            # The links feel the motors' velocities only through the springs' damping.
            last = sweep == _PASSES - 1
            if last or damped.any():
                for i in range(envs):
                    for k in range(dof):
                        j = i * dof + k
                        pull = spring[j] + joints[j, 1] * (v_mid[j] - w[j])
                        x[k, i] = 0.5 * h * (pull - damper[j] * w[j] + load[j])
                _solve(lower, x)
                for i in range(envs):
                    if last or damped[i]:
                        for k in range(dof):
                            w_mid[i * dof + k] = x[k, i] + w[i * dof + k]
        for j in range(envs * dof):
            tau_f[j] += step(v_mid[j], z[j], h, friction[j], memo[j])
            v[j] = 2.0 * v_mid[j] - v[j]
            w[j] = 2.0 * w_mid[j] - w[j]

    @njit(error_model="numpy", nogil=True)
    def advance(state, torques, links, layout, joints, friction, h, steps, tau_f, first, last):
        """Advance the environments from `first` to `last` by `steps` micro-steps of h seconds, in place.

        Blocks of environments go together, joint after joint, which keeps the processor's units busy.

        Args:
            state: (4 + states, num_envs, dof), rows as in MOTION, then the law's states.
            torques: (tau_m, motor_torque, tau_ext), held: of the motors, what disturbs them beside friction, and from
                outside, (num_envs, dof) each.
            links: (bias, passive, inertia, link_damping, damping), held: tau_ext - (bias - passive) acts on the links
                beside the springs; these two, (last - first, dof) each, and M as MuJoCo's sparse lower triangle, (last
                - first, nonzeros), are of the environments to be advanced alone; both dampings are of dampers between
                the links and the world, (num_envs, dof) and (dof,).
            layout: (row_nonzeros, row_start, columns) of that triangle.
            joints: motors and springs, (num_envs, dof, 3), columns as in fo_gym.parameters.JOINT.
            friction: the law's parameters, (num_envs, dof), of its dtype.
            h: micro-step [s].
            steps: micro-steps.
            tau_f: out, mean friction torque over the whole period, (num_envs, dof).
            first, last: of the environments; `last` is not among them.
        """
        num_envs, dof = tau_f.shape
        size, most = num_envs * dof, min(last - first, max(1, _BLOCK // dof))
        held, scratch = np.empty((4, most * dof)), np.empty((3, most * dof))
        z, memo = np.empty((most * dof, states)), np.empty((most * dof, memory))
        # Where the last block has fewer environments, the others' lanes go on idly.
        lower, x, damped = np.zeros((dof, dof, most)), np.zeros((dof, most)), np.empty(most, dtype=np.bool_)
        # Joint after joint, environment after environment.
        moving, sums = state.reshape((4 + states, size)), tau_f.reshape(size)
        parameters, frictions = joints.reshape((size, 3)), friction.reshape(size)
        for start in range(first, last, most):
            end = min(start + most, last)
            _begin(start, end, first, h, state, torques, links, layout, joints, held, z, damped, lower)
            a, b = start * dof, end * dof
            q, w, theta, v = moving[0, a:b], moving[1, a:b], moving[2, a:b], moving[3, a:b]
            joint, rubs, total = parameters[a:b], frictions[a:b], sums[a:b]
            damps = damped[: end - start]
            total[:] = 0.0
            for number in range(steps):
                # Two half drifts meet between micro-steps; only the first and the last are half.
                length = h if number > 0 else 0.5 * h
                for j in range(b - a):
                    q[j] += length * w[j]
                    theta[j] += length * v[j]
                kick(q, w, theta, v, z, held, joint, rubs, lower, h, damps, scratch, x, total, memo)
            for j in range(b - a):
                q[j] += 0.5 * h * w[j]
                theta[j] += 0.5 * h * v[j]
                total[j] = total[j] / steps if lower[0, 0, j // dof] > 0.0 else np.nan  # where M was lost
                for k in range(states):
                    moving[4 + k, a + j] = z[j, k]

    return advance
