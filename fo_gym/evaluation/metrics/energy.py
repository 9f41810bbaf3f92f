"""Energy: whether the observer, the compensation, or the compensated joint produces some."""

from __future__ import annotations

import math

import numpy as np

from fo_gym.evaluation.episode.record import Array, Episode
from fo_gym.evaluation.metrics.reductions import smallest
from fo_gym.evaluation.metrics.registry import Tolerance, metric

_STUCK = 1e-4
"""Motor speed below which a joint counts as stuck, m/s or rad/s."""

_NOT_COUNTED = 0.01
"""Share of what is stored and put in by which control in steps of 1 ms, delays and sums over ticks may be off."""

_NO_ENERGY = 1e-9
"""Energy, J, that is rounding."""


@metric("observer_work_in_stiction_j", unit="J", better="higher", tolerance=Tolerance(1e-6, 0.03))
def observer_work_in_stiction(episode: Episode) -> float:
    """Work that the observer takes up while its joint is stuck, smallest over joints; negative = it produced energy.

        W = - ∫ e' tau_f_hat dt,  e = theta_n - theta,  over the periods with |theta'| < 1e-4 m/s or rad/s at both ends

    In J. e' and -tau_f_hat are the pair of the paper's Theorem 2. As tau_f_hat is held over a period, the integral
    over one is exactly tau_f_hat[k] (e[k+1] - e[k]). The signs: with Le Tien, tau_f_hat = -B L e', so
    W = B L ∫ e'^2 >= 0; the PD-type adds B L L_p/2 times the growth of e^2 over each stuck interval, which may be
    negative but only gives back what was stored at its start; the integral of the PID-type adds a term without
    bound. A joint that was never stuck does not count; NaN if none was.
    """
    error = episode.theta_n - episode.motion.theta
    slow = np.abs(episode.theta_dot) < _STUCK
    stuck = slow[:-1] & slow[1:]
    work = 0.0 - np.sum(episode.tau_f_hat * np.diff(error, axis=0), axis=0, where=stuck)
    return smallest(np.where(stuck.any(axis=0), work, np.nan))


@metric("passivity_index_j", unit="J", better="higher", tolerance=Tolerance(1e-9, 1e-6))
def passivity_index(episode: Episode) -> float:
    """Lowest energy that the push had put into the arm at any time; negative = the arm gave energy out.

        min over t of ∫_0^t tau_ext' q_dot dt,  at most 0

    In J, summed over joints: trapezoidal rule, tau_ext of a period times the mean of q_dot at its ends. The
    torque is zero but for the push, so that nothing adds up before or after it. 0 if never negative; NaN without
    a push within the episode.
    """
    work = _work_of_push(episode)
    return math.nan if work is None else float(np.min(work, initial=0.0))


@metric("passivity_violation_ratio", unit="1", better="lower", tolerance=Tolerance(0.0, 1.0), share=True)
def passivity_violation(episode: Episode) -> float:
    """Passivity violated: 1 where whoever pushes got more energy out of the arm than was stored in it, else 0.

        min over t of ∫_0^t tau_ext' q_dot dt  <  -S - 0.01 (S + what the push put in at most) - 1 nJ

    S is what links, motors, springs, gravity and the controller hold when the push begins (`stored_energy`): a passive
    arm, with friction or without, gives back no more than that, so that the difference was produced. What a compensator
    stores itself does not count as stored. A row says the share of its episodes. NaN without a push within the episode,
    and where the reference moves after the push has begun: then the path does work as well.
    """
    work, push = _work_of_push(episode), episode.push
    if work is None or push is None:
        return math.nan
    if episode.moved_until > push.time:
        return math.nan
    given, taken = float(np.max(work, initial=0.0)), -float(np.min(work, initial=0.0))
    return float(taken > episode.stored + _NOT_COUNTED * (episode.stored + given) + _NO_ENERGY)


def _work_of_push(episode: Episode) -> Array | None:
    """Energy that the push has put into the arm by each tick but the first, (periods,), J; None without one."""
    if episode.push is None or episode.push.time >= episode.duration:
        return None
    velocity = (episode.q_dot[:-1] + episode.q_dot[1:]) / 2
    work: Array = np.cumsum(episode.dt * np.sum(episode.tau_ext * velocity, axis=1))
    return work


@metric("over_compensation_ratio", unit="1", better="lower", tolerance=Tolerance(1e-7, 3e-4))
def over_compensation(episode: Episode) -> float:
    """Energy that the estimate feeds into the motion beyond what the disturbance takes, as a share of that.

        sum of max(0, -tau_f_hat dtheta - taken) / sum of taken,  taken = max(0, -tau_dist dtheta)

    over all periods and joints, dtheta = theta[k+1] - theta[k]. tau_f_hat is held over a period, so that
    -tau_f_hat dtheta is exactly the work it does on the motor; tau_dist, friction and whatever else disturbs the motor,
    is the period's mean. Where it takes energy, the numerator is the work of the residual tau_dist - tau_f_hat where
    that drives the motion; where bristles spring back or a ripple drives (taken = 0), what they return is not counted,
    only what the estimate adds. 0 for no estimate and for a perfect one, 1 for one that is twice too large throughout.
    Summed over joints, as energies are: one that hardly moves does not decide. NaN where nothing is taken.
    """
    step = np.diff(episode.motion.theta, axis=0)
    taken = np.maximum(0.0, -episode.tau_dist * step)
    if not taken.any():
        return math.nan
    fed = np.maximum(0.0, -episode.tau_f_hat * step - taken)
    return float(np.sum(fed) / np.sum(taken))
