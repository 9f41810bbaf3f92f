"""The hand: its path, its force, its passivity, how it is fitted and drawn."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arms import SIX, arm, miro
from scipy.integrate import solve_ivp

from fo_gym.plant.links import ToolPose
from fo_gym.robots.poses import Poses
from fo_gym.simulation.hands import Hands
from fo_gym.tasks.draw import draw_scenario
from fo_gym.tasks.hand import Hand
from fo_gym.tasks.hand_fit import FORCE_SHARE, STIFFNESS, STROKE_TIME, TOOL_RATE, fitted_hand
from fo_gym.tasks.interaction import interaction
from fo_gym.tasks.square_fit import fitted_square

X, Y, Z = "1 0 0", "0 1 0", "0 0 1"
HAND = Hand(0.1, 3, 0.2, 0.3, 0.1, 0.12, 0.2, 800.0, 25.0, (0.6, 0.0, 0.8), (0.0, 1.0, 0.0))
"""Three strokes of 0.8 s from 0.1 s on; it lets go at 2.8 s."""


# The path


def test_the_path_is_smooth_and_to_and_fro() -> None:
    h = 1e-4
    time = np.arange(-1000, 35_000) * h
    distance, speed = HAND.at(time)
    assert HAND.let_go == pytest.approx(2.8)
    assert np.all(distance[time <= 0.1] == 0.0)
    assert np.all(distance[time >= 2.5 + h] == 0.12)
    assert np.all(speed[(time <= 0.1) | (time >= 2.5 + h)] == 0.0)
    # The speed swells as 3 x^2 - 2 x^3: acceleration is at most 1.5 v / turn, its slope at most 6 v / turn^2.
    jerk = 6.0 * 0.2 / 0.2**2
    np.testing.assert_allclose((distance[2:] - distance[:-2]) / (2.0 * h), speed[1:-1], atol=h**2 * jerk)
    acceleration = np.diff(speed) / h
    assert np.abs(acceleration).max() == pytest.approx(1.5 * 0.2 / 0.2, rel=1e-3)
    assert np.abs(np.diff(acceleration)).max() < 1.01 * h * jerk
    for i, (start, end) in enumerate(HAND.steady):
        inside = (time > start + h) & (time < end - h)
        np.testing.assert_allclose(speed[inside], 0.2 * (-1.0) ** i, rtol=1e-12)
    even = replace(HAND, strokes=2)
    assert even.at(np.array([9.0]))[0] == 0.0


def test_what_is_wrong_is_named() -> None:
    for wrong, message in (
        ({"strokes": 0}, r"Hand\.strokes is 0"),
        ({"stiffness": -1.0}, r"Hand\.stiffness is -1"),
        ({"release": 0.0}, r"Hand\.release is 0"),
        ({"speed": 0.7}, r"Hand\.speed is 0\.7 m/s; a stroke of 0\.12 m that takes 0\.2 s .* at most 0\.6 m/s"),
        ({"direction": (1.0, 1.0, 0.0)}, r"give unit vectors, at a right angle"),
        ({"across": (0.6, 0.0, 0.8)}, r"Hand\.across is .*; give unit vectors, at a right angle"),
    ):
        with pytest.raises(ValueError, match=message):
            replace(HAND, **wrong)
    with pytest.raises(ValueError, match=r"has no stroke, speed, stiffness, damping, direction, across yet"):
        _ = Hand().let_go
    with pytest.raises(ValueError, match=r"Task\.hand is 3; give a Hand, or None for none"):
        replace(interaction(miro()), hand=3)  # type: ignore[arg-type]


# The force


@dataclass
class Mass:
    """A point mass of 5 kg as a plant whose tool it is; it steps exactly under a force that is held."""

    control_dt: float
    num_envs = 1
    mass = 5.0

    def __post_init__(self) -> None:
        self.q, self.q_dot = np.array([[0.01, -0.02, 0.03]]), np.array([[0.1, 0.0, -0.05]])
        self.body = self.links = self

    def tool_pose(self, q: np.ndarray) -> ToolPose:
        jacobian = np.concatenate([np.eye(3), np.zeros((3, 3))])
        return ToolPose(q.copy(), np.eye(3)[None], jacobian[None])

    def step(self, force: np.ndarray) -> None:
        dt = self.control_dt
        self.q = self.q + dt * self.q_dot + 0.5 * dt**2 / self.mass * force
        self.q_dot = self.q_dot + dt / self.mass * force


def guided(dt: float, end: float = 3.2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, places and forces of the mass under HAND, sampled every dt seconds."""
    plant = Mass(dt)
    hands = Hands(plant)  # type: ignore[arg-type]
    hands.set(0, HAND)
    places, forces = [plant.q[0]], []
    for tick in range(round(end / dt)):
        tau_ext = np.zeros((1, 3))
        hands.act(np.array([tick]), tau_ext)  # of a point, J is the identity
        plant.step(tau_ext)
        places.append(plant.q[0])
        forces.append(tau_ext[0])
    return dt * np.arange(len(places)), np.array(places), np.array(forces)


def solved(end: float = 3.2) -> Any:
    """The same by SciPy, in continuous time, on the equations of Hand's docstring."""
    start = np.array([0.01, -0.02, 0.03])
    velocity = np.array([0.1, 0.0, -0.05])
    gripped, direction = start + 0.1 * velocity, np.array(HAND.direction)

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        distance, speed = HAND.at(np.array([time]))
        x = np.clip((time - 2.8) / 0.1, 0.0, 1.0)
        firmness = 1.0 - 3.0 * x**2 + 2.0 * x**3
        spring = 800.0 * (gripped + distance[0] * direction - state[:3])
        force = firmness * (spring + 25.0 * (speed[0] * direction - state[3:]))
        return np.concatenate([state[3:], force / 5.0])

    options: dict[str, Any] = {"rtol": 1e-10, "atol": 1e-12, "max_step": 0.01, "dense_output": True}
    return solve_ivp(rate, (0.1, end), np.concatenate([gripped, velocity]), method="DOP853", **options).sol


def test_a_mass_in_its_hand_moves_as_the_equations_say() -> None:
    """Sampled at h the hand is late by h / 2: the difference falls with h: at 1 kHz a hundredth of the stroke."""
    exact, errors = solved(), []
    for dt in (1e-3, 5e-4, 2.5e-4):
        time, places, _ = guided(dt)
        inside = time >= 0.1
        errors.append(np.abs(places[inside] - exact(time[inside])[:3].T).max())
    assert errors[0] < 1.2e-3
    assert 1.8 < errors[0] / errors[1] < 2.2
    assert 1.8 < errors[1] / errors[2] < 2.2


def test_before_the_grip_and_after_it_let_go_there_is_no_force() -> None:
    time, places, forces = guided(1e-3)
    gone = (time[:-1] < 0.0999) | (time[:-1] >= 2.8999)
    assert np.all(forces[gone] == 0.0)
    assert np.all(np.linalg.norm(forces[~gone], axis=1) > 0.0)
    assert np.linalg.norm(forces[100]) == pytest.approx(25.0 * np.hypot(0.1, 0.05))  # the damper alone: at zero stretch
    assert np.linalg.norm(np.diff(places, axis=0)[-1]) == pytest.approx(np.linalg.norm(np.diff(places, axis=0)[-200]))


def shaken(seed: int, dt: float = 1e-3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Energy that the hand has given, that its point has put in, and that its spring holds, while the tool is shaken.

    It also goes along, or against, a share of the way of the hand's own point.
    """
    rng = np.random.default_rng(seed)
    amplitude, rate, phase = rng.normal(0, 0.005, (3, 6)), rng.uniform(0.5, 30.0, 6), rng.uniform(0, 6.28, 6)
    share = rng.uniform(-0.5, 1.5) * np.array(HAND.direction)
    plant = Mass(dt)
    hands = Hands(plant)  # type: ignore[arg-type]
    hands.set(0, HAND)
    gives, puts_in, holds, gripped = [], [], [], np.zeros(3)
    for tick in range(round(3.2 / dt)):
        now, then = tick * dt, (tick + 1) * dt
        (way, way_then), (speed, _) = HAND.at(np.array([now, then]))
        q, q_then = (amplitude @ np.sin(rate * t + phase) + share * s for t, s in ((now, way), (then, way_then)))
        plant.q, plant.q_dot = q[None], (amplitude @ (rate * np.cos(rate * now + phase)) + share * speed)[None]
        hands.act(np.array([tick]), tau_ext := np.zeros((1, 3)))
        force = tau_ext[0]
        point = (way_then - way) * np.array(HAND.direction)
        gives.append(force @ (q_then - q))
        puts_in.append(force @ point)
        gripped = q if tick <= 100 else gripped
        stretch = gripped + way_then * np.array(HAND.direction) - q_then
        x = np.clip((then - 2.8) / 0.1, 0.0, 1.0)
        holds.append(0.5 * 800.0 * (1.0 - 3.0 * x**2 + 2.0 * x**3) * stretch @ stretch * (tick >= 100))
    return np.cumsum(gives), np.cumsum(puts_in), np.array(holds)


@pytest.mark.parametrize("seed", range(5))
def test_the_hand_is_passive(seed: int) -> None:
    """Whatever the tool does: what its own point puts in is given, held by the spring, or lost; nothing is gained."""
    given, put_in, held = shaken(seed)
    turned_over = np.abs(np.diff(given)).sum()
    lost = put_in - given - held
    assert np.max(np.maximum.accumulate(lost) - lost) < 1e-3 * turned_over
    assert np.all(given <= put_in + 1e-12)
    assert held[2799] > 0.0  # there is something to lose when it lets go
    assert held[2900] == 0.0


# The fit and the draw


def test_hands_fit_arms_of_all_kinds(tmp_path: Path) -> None:
    arms = {
        "three": arm(tmp_path / "3.xml", (Z, Y, Y)),
        "gantry": arm(tmp_path / "g.xml", (X, Y, Z), slides=(0, 1, 2)),
        "six": arm(tmp_path / "6.xml"),
        "small": arm(tmp_path / "s.xml", scale=0.2),
        "eight": arm(tmp_path / "8.xml", (*SIX, Z, Y)),
        "miro": miro(),
    }
    for name, robot in arms.items():
        hand = Hand().fitted_to(robot)
        side, (first, second) = fitted_square(robot)
        assert (hand.stroke, hand.direction, hand.across) == (side, first, second), name
        assert hand.speed == side / STROKE_TIME
        jacobian = Poses(robot.link_side.model, robot.tool).jacobian(robot.home)[:3]
        assert hand.stiffness is not None
        assert 0.0 < hand.stiffness <= STIFFNESS, name
        for direction in (first, second):
            torque = np.abs(hand.stiffness * side * np.array(direction) @ jacobian)
            assert np.all(torque <= 1.001 * FORCE_SHARE * robot.flexible.torque_limit), name
        inertia = Poses(robot.link_side.model).inertia(robot.home)
        mobility = np.linalg.eigvalsh(jacobian @ np.linalg.inv(inertia) @ jacobian.T)[-1]
        assert hand.stiffness * mobility <= 1.001 * TOOL_RATE**2, name
        assert hand.damping is not None
        assert hand.damping * mobility <= 1.001 * TOOL_RATE, name
        assert hand.damping > 0.5e-3 * hand.stiffness, name  # passive though it is sampled at 1 kHz


def test_what_is_given_is_kept_and_where_there_is_no_room_it_says_so(tmp_path: Path) -> None:
    whole = HAND.fitted_to(miro())
    assert whole is HAND
    partly = Hand(stroke=0.1, stiffness=200.0).fitted_to(miro())
    assert (partly.stroke, partly.stiffness, partly.damping) == (0.1, 200.0, pytest.approx(6.0))
    assert fitted_hand(miro(), direction=(1.0, 0.0, 0.0), across=(0.0, 0.0, -1.0)).direction == (1.0, 0.0, 0.0)
    two = arm(tmp_path / "2.xml", (Z, Y))
    with pytest.raises(ValueError, match=r"a hand guides the tool where it could draw a square: .* at least 3 joints"):
        interaction(two).fitted_to(two)


def test_the_hand_is_drawn_within_its_ranges_and_leaves_other_draws_alone() -> None:
    robot = miro()
    task = interaction(robot).fitted_to(robot)
    nominal, spread = task.hand, task.randomization
    assert nominal is not None
    rng = np.random.default_rng(0)
    drawn = [draw_scenario(robot, task, "randomized", rng).hand for _ in range(200)]
    found = [{name: getattr(each, name) for name in ("stroke", "speed", "stiffness", "damping")} for each in drawn]
    stroke, speed, stiffness, damping = np.array([[*each.values()] for each in found]).T
    for values, (low, high) in (
        (stroke / nominal.stroke, spread.hand_stroke),  # type: ignore[operator]
        (speed / stroke * STROKE_TIME, spread.hand_speed),
        (stiffness / nominal.stiffness, spread.hand_stiffness),  # type: ignore[operator]
    ):
        margin = 0.05 * (high - low)
        assert low <= values.min() < low + margin
        assert high - margin < values.max() <= high
    np.testing.assert_allclose(damping / stiffness, nominal.damping / nominal.stiffness, rtol=1e-12)  # type: ignore[operator]
    directions = np.array([each.direction for each in drawn if each is not None])
    shares = directions @ np.array([nominal.direction, nominal.across]).T
    np.testing.assert_allclose(np.linalg.norm(shares, axis=1), 1.0, rtol=1e-12)
    assert np.all(shares > -1e-12)
    assert shares.min(axis=0).max() < 0.05
    assert max(each.let_go for each in drawn if each is not None) < 9.0
    with_it, without = (
        draw_scenario(robot, replace(task, hand=hand), "randomized", np.random.default_rng(1))
        for hand in (nominal, None)
    )
    np.testing.assert_array_equal(with_it.q_start, without.q_start)
    np.testing.assert_array_equal(with_it.friction.v_s, without.friction.v_s)
    assert draw_scenario(robot, task, "nominal", rng).hand is nominal
