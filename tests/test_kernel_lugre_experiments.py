"""The LuGre experiments of Canudas de Wit et al. (1995) on the joint kernel: unit mass, parameters PAPER, 2 %."""

from __future__ import annotations

import numpy as np
import pytest
from joint import PAPER, H, Joint
from scipy.integrate import odeint

from fo_gym.parameters import LuGre
from fo_gym.plant.kernel import bristle_rate, bristle_step
from fo_gym.reproduction.reference import lugre


def presliding_force(t: float) -> float:
    """Up to 1.425 N at 0.1425 N/s, 5 s held, down to the opposite, 5 s held."""
    return float(np.interp(t, [0.0, 10.0, 15.0, 35.0, 40.0], [0.0, 1.425, 1.425, -1.425, -1.425]))


@pytest.fixture(scope="module")
def presliding() -> np.ndarray:
    """Displacement every millisecond of the kernel's unit mass, (40001,)."""
    motor, history = Joint(), [0.0]
    for k in range(40_000):
        motor.advance(presliding_force((k + 0.5) * 1e-3), steps=5)
        history.append(motor.theta)
    return np.array(history)


def test_presliding_follows_the_solver(presliding: np.ndarray) -> None:
    """0.02 % of the largest displacement, over the whole hysteresis loop."""

    def rates(t: float, x: np.ndarray) -> list[float]:
        z_rate, tau_f = lugre(x[1].item(), x[2].item(), LuGre(**PAPER))
        return [x[1], presliding_force(t) + tau_f, z_rate]

    times = np.arange(40_001) * 1e-3
    options = {"rtol": 1e-9, "atol": 1e-13, "tcrit": [10.0, 15.0, 35.0, 40.0], "mxstep": 10_000}
    theirs = odeint(rates, np.zeros(3), times, tfirst=True, **options)[:, 0]
    assert np.abs(presliding - theirs).max() < 2e-4 * np.abs(theirs).max()


def test_experiment_presliding(presliding: np.ndarray) -> None:
    assert presliding[15_000] == pytest.approx(45.3e-6, rel=0.02)
    assert presliding[40_000] == pytest.approx(-10.0e-6, rel=0.02)


def lag_loop(omega: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and friction force over the last of four periods of v = 1e-3 (1.5 + cos(omega t))."""
    per_period = round(2 * np.pi / omega / H)
    velocity = 1e-3 * (1.5 + np.cos(2 * np.pi * (np.arange(4 * per_period) + 0.5) / per_period))
    z, force = 0.0, np.zeros_like(velocity)
    for k, v in enumerate(velocity):
        a = bristle_rate(v, PAPER["sigma_0"], PAPER["f_c"], PAPER["f_s"], PAPER["v_s"])
        z, tau_f = bristle_step(z, v, a, H, PAPER["sigma_0"], PAPER["sigma_1"], PAPER["sigma_2"])
        force[k] = -tau_f
    return velocity[-per_period:], force[-per_period:]


@pytest.mark.parametrize(("omega", "largest"), [(1.0, 1.389), (10.0, 1.378), (25.0, 1.344)])
def test_experiment_frictional_lag(omega: float, largest: float) -> None:
    assert lag_loop(omega)[1].max() == pytest.approx(largest, rel=0.02)


def test_experiment_frictional_lag_widens_with_frequency() -> None:
    """Friction is larger while the velocity rises; the area between the branches grows with the frequency."""
    loops = [lag_loop(omega) for omega in (1.0, 10.0, 25.0)]
    areas = [float(np.sum(force * np.gradient(velocity))) for velocity, force in loops]
    assert 0 < areas[0] < areas[1] < areas[2]


@pytest.mark.parametrize(
    ("rate", "force"),
    [(1, 1.432), (2, 1.394), (5, 1.313), (10, 1.220), (20, 1.099), (30, 1.024), (40, 0.989), (50, 0.968)],
)
def test_experiment_break_away(rate: float, force: float) -> None:
    """Largest friction before |v| passes 2 v_s, under a force ramp in N/s: the faster, the lower."""
    motor, largest, k = Joint(), 0.0, 0
    while abs(motor.theta_dot) < 2e-3:
        largest = max(largest, -motor.advance(rate * (k + 0.5) * H))
        k += 1
    assert largest == pytest.approx(force, rel=0.02)


def test_experiment_stick_slip() -> None:
    """A mass pulled over a spring of 2 N/m whose end, here a link too heavy to notice, moves at 0.1 m/s."""
    motor = Joint(stiffness=2.0, mass=1e15).put(q_dot=0.1)
    position, velocity = np.zeros(34_000), np.zeros(34_000)
    for k in range(len(position)):
        motor.advance(steps=5)
        position[k], velocity[k] = motor.theta, motor.theta_dot
    onsets = np.flatnonzero((velocity[1:] > 1e-2) & (velocity[:-1] <= 1e-2))
    assert 1e-3 * onsets[0] == pytest.approx(7.46, rel=0.02)
    assert 1e-3 * np.diff(onsets) == pytest.approx([6.36] * 4, rel=0.02)
    assert np.diff(position[onsets - 1000]) == pytest.approx([0.636] * 4, rel=0.02)
    assert velocity.max() == pytest.approx(0.37, rel=0.02)


def test_experiment_hunting() -> None:
    """PID position control of the mass, K_v = 6, K_p = 3, K_i = 4, to x = 1 m."""
    motor, integral, position = Joint(), 0.0, np.zeros(120_000)
    for k in range(len(position)):
        error = motor.theta - 1.0
        motor.advance(-6.0 * motor.theta_dot - 3.0 * error - 4.0 * integral, steps=5)
        integral += 1e-3 * error
        position[k] = motor.theta
    error, late = position - 1.0, position[60_000:] - 1.0
    rises = np.flatnonzero((error[1:] > 0) & (error[:-1] <= 0)) * 1e-3
    assert position.max() == pytest.approx(1.50, rel=0.02)
    assert (late.max(), late.min()) == pytest.approx((0.0645, -0.0645), rel=0.02)
    assert rises[-1] - rises[-2] == pytest.approx(24.4, rel=0.02)
