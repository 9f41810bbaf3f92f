"""What every control tick does for every environment, compiled: a step of one environment is no dearer than it must be.

Environment by environment and joint by joint, so that neighbours do not matter.
"""

from __future__ import annotations

import math

from fo_gym.compiling import jit
from fo_gym.control.nominal_motor import move_nominal
from fo_gym.tasks.stroke import stroke_at

INSIDE, OUTSIDE, LOST = 0, 1, 2
"""Where a joint's link is: in its range, out of it, or no longer a finite number."""

TAU_M, TAU_EXT, TAU_F, TAU_DIST, TAU_F_HAT = range(5)
"""Rows of what acted in the past step, as in PastStep."""

ROUGHNESS_WEIGHT = 0.1
"""Share of the reward that a rough motor torque costs at most."""

__all__ = ["INSIDE", "LOST", "OUTSIDE", "close", "pull", "record", "settle", "torques"]


@jit
def torques(ticks, dt, push_time, push_duration, push_torque, tau_c, limit, compensates, acting, action):
    """Torques that are held over the coming control period.

    Args:
        ticks: control ticks since reset, (num_envs,); a push is sampled in the middle of the period.
        dt: control period [s].
        push_time, push_duration: start and length of each environment's sin^2 push [s], (num_envs,); 0 long = none.
        push_torque: its peak, (num_envs, dof).
        tau_c: control torque, (num_envs, dof).
        limit: of the motors' torque, (dof,).
        compensates: whether the action is tau_f_hat.
        acting: out, rows TAU_M, TAU_EXT and TAU_F_HAT, zeros where the action is tau_m; (5, num_envs, dof), N or N m.
        action: tau_f_hat or tau_m, (num_envs, dof), clipped to +-limit.
    """
    num_envs, dof = tau_c.shape
    for i in range(num_envs):
        since = (ticks[i] + 0.5) * dt - push_time[i]
        share = 0.0
        if 0.0 < since < push_duration[i]:
            share = math.sin(math.pi * (since / push_duration[i])) ** 2
        for j in range(dof):
            acting[TAU_EXT, i, j] = push_torque[i, j] * share if share > 0.0 else 0.0
            value = min(max(action[i, j], -limit[j]), limit[j])
            acting[TAU_M, i, j] = tau_c[i, j] - value if compensates else value
            acting[TAU_F_HAT, i, j] = value if compensates else 0.0


@jit
def _add_acted(acting, tau_f, motor_torque, tick, ticks, where, past, first, last):
    """Add what acted in a control period to the means over a step, all (5, num_envs, dof) [N | N m].

    Args:
        acting: rows TAU_M, TAU_EXT and TAU_F_HAT, which is held over the step; the others are out.
        tau_f: friction, (num_envs, dof).
        motor_torque: what else disturbed the motors, (num_envs, dof).
        tick, ticks: number of the period in its step, and how many there are.
        where: of whoever is LOST friction is not known, and counts as 0, (num_envs,).
        past: out.
        first, last: of the environments; `last` is not among them.
    """
    for i in range(first, last):
        for j in range(tau_f.shape[1]):
            acting[TAU_F, i, j] = tau_f[i, j] if where[i] != LOST else 0.0
            acting[TAU_DIST, i, j] = acting[TAU_F, i, j] + motor_torque[i, j]
            past[TAU_F_HAT, i, j] = acting[TAU_F_HAT, i, j]
            for row in range(TAU_F_HAT):
                before = past[row, i, j] if tick > 0 else 0.0
                past[row, i, j] = before + acting[row, i, j]
                if ticks > 1 and tick == ticks - 1:
                    past[row, i, j] /= ticks


@jit
def pull(after, gone, position, jacobian, q_dot, numbers, direction, gripped_at, point, held, force, tau_ext):
    """Forces of hands, environment by environment, so that neighbours do not matter.

    Args:
        after, gone: since a hand gripped, and since it began to let go, (num_envs,) [s].
        position, jacobian: of the tool, (num_envs, 3) and (num_envs, 6, dof).
        q_dot: links, (num_envs, dof).
        numbers: columns stroke, speed, turn, strokes, stiffness, damping, release, as of Hand; (num_envs, 7).
        direction: of the strokes, (num_envs, 3).
        gripped_at: set at the tick of the grip, (num_envs, 3).
        point, held, force: out, see Hands.
        tau_ext: J^T f is added, (num_envs, dof).
    """
    num_envs, dof = q_dot.shape
    for i in range(num_envs):
        stroke, speed, turn, strokes, stiffness, damping, release = numbers[i]
        if after[i] == 0.0:
            gripped_at[i] = position[i]
        # s falls as 1 - 3 x^2 + 2 x^3 while the hand lets go.
        x = min(max(gone[i] / release, 0.0), 1.0)
        held[i] = 1.0 - x * x * (3.0 - 2.0 * x) if after[i] >= 0.0 else 0.0
        if held[i] == 0.0:
            continue
        distance, rate = stroke_at(after[i], stroke, speed, turn, strokes)
        for axis in range(3):
            velocity = 0.0
            for j in range(dof):
                velocity += jacobian[i, axis, j] * q_dot[i, j]
            point[i, axis] = gripped_at[i, axis] + distance * direction[i, axis]
            spring = stiffness * (point[i, axis] - position[i, axis])
            force[i, axis] = held[i] * (spring + damping * (rate * direction[i, axis] - velocity))
            for j in range(dof):
                tau_ext[i, j] += jacobian[i, axis, j] * force[i, axis]


@jit
def _whereabouts(state, low, high, where, first, last):
    """Where the environments are, into `where` (num_envs,): INSIDE, OUTSIDE or LOST; returns how many are not inside.

    Args:
        state: the plant's (rows, num_envs, dof); row 0 is q.
        low, high: joint range, (dof,).
        where: out.
        first, last: of the environments; `last` is not among them.
    """
    rows, _, dof = state.shape
    others = 0
    for i in range(first, last):
        where[i] = INSIDE
        for j in range(dof):
            if not low[j] <= state[0, i, j] <= high[j]:
                where[i] = OUTSIDE
        for row in range(rows):
            for j in range(dof):
                if not math.isfinite(state[row, i, j]):
                    where[i] = LOST
        others += where[i] != INSIDE
    return others


@jit
def settle(clock, nominal, tau_c, tau_j, acting, disturbances, period, decimation, past, state, box, ends, first, last):
    """What is left to do when the joints have moved: nominal motors, means, the clocks, and who is out of range.

    Args:
        clock: (ticks, dt, time): control ticks of each environment, (num_envs,), of which one more is over; the control
            period [s]; time, out, (num_envs, 1) [s].
        nominal: (theta_n, theta_n_dot, motor_inertia), see `move_nominal`.
        tau_c, tau_j: control torque and measured torque at the start of the period, (num_envs, dof).
        acting, past: see `_add_acted`.
        disturbances: (tau_f, motor_torque), likewise.
        period: number of the period in its step, (1,).
        decimation: control periods of a step.
        state, box: see `_whereabouts`; the box is (low, high).
        ends: (where, others), out: see `_whereabouts`, whose answer is written into `others`, (1,).
        first, last: of the environments; `last` is not among them.
    """
    ticks, dt, time = clock
    where, others = ends
    others[0] = _whereabouts(state, box[0], box[1], where, first, last)
    move_nominal(nominal, tau_c, tau_j, dt, first, last)
    _add_acted(acting, disturbances[0], disturbances[1], period[0], decimation, where, past, first, last)
    for i in range(first, last):
        ticks[i] += 1
        time[i, 0] = ticks[i] * dt


@jit
def record(motion, past, whole):
    """Write what moves, (rows, num_envs, dof), and below it what acted in the past step into `whole`."""
    rows, num_envs, dof = motion.shape
    for row in range(len(whole)):
        for i in range(num_envs):
            for j in range(dof):
                whole[row, i, j] = motion[row, i, j] if row < rows else past[row - rows, i, j]


@jit
def close(tau_m, previous, limit, ticks, last_tick, distance, terminated, reward, truncated):
    """The end of a step, (num_envs,) each: reward = closeness (1 - ROUGHNESS_WEIGHT roughness), and whose time is over.

    closeness = 1 / (1 + distance); roughness is the mean change of tau_m over joints as a share of the
    torque limit, at most 1.

    Args:
        tau_m, previous: motor torque of this and of the last step, (num_envs, dof); the second becomes the first.
        limit: torque limits, (dof,).
        ticks, last_tick: where each environment is, and where its episode ends.
        distance: from the reference, in units of the one of half closeness.
        terminated: whose episode has ended before.
        reward, truncated: out.
    """
    num_envs, dof = tau_m.shape
    for i in range(num_envs):
        change = 0.0
        for j in range(dof):
            change += abs(tau_m[i, j] - previous[i, j]) / limit[j]
            previous[i, j] = tau_m[i, j]
        reward[i] = (1.0 - ROUGHNESS_WEIGHT * min(change / dof, 1.0)) / (1.0 + distance[i])
        truncated[i] = ticks[i] >= last_tick and not terminated[i]
