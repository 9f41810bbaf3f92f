"""The plant on the single link against SciPy on the equations: trajectories, order of convergence, verdicts."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from envs_assets import asset_path
from fo_gym.parameters import FRICTIONLESS, FlexibleJoint, LuGre
from fo_gym.plant import FlexibleJointPlant, Robot
from fo_gym.reproduction.cases import link_case
from fo_gym.reproduction.reference import Control, SingleLink, continuous, sampled

JOINT = FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=100.0)
PAPER = LuGre(sigma_0=1e5, sigma_1=1e5**0.5, sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=1e-3)
# The equations divide by g(v): for them, no friction is a bristle without force.
NO_FRICTION = LuGre(sigma_0=0.0, sigma_1=0.0, sigma_2=0.0, f_c=1.0, f_s=1.0, v_s=1.0)

CASES: dict[str, dict[str, float]] = {
    "none": {},
    "pid-low": {"nominal": True, "L": 50.0, "L_p": 10.0, "L_i": 25.0},
    "pid-high": {"nominal": True, "L": 100.0, "L_p": 20.0, "L_i": 100.0},
    "pd-low": {"nominal": True, "L": 50.0, "L_p": 10.0},
    "pd-high": {"nominal": True, "L": 100.0, "L_p": 20.0},
    "letien-low": {"L": 50.0},
    "letien-high": {"L": 100.0},
    "no-friction": {},
}
STICKING = [name for name in CASES if name != "no-friction"]
TARGET = 0.01
TICKS = 2000
DRAWS = 10
STILL = np.zeros((TICKS, 1))


@pytest.fixture(scope="module")
def slider() -> Robot:
    """The single link: 1 kg on a slide, without gravity along it."""
    return Robot(asset_path("single_link"), ("joint",))


def link_of(name: str, damping: float = 0.0) -> SingleLink:
    return SingleLink(replace(JOINT, damping=damping), NO_FRICTION if name == "no-friction" else PAPER)


@cache
def solved(name: str, damping: float = 0.0) -> np.ndarray:
    """The solver's states over two seconds of 1 kHz control from rest, (2001, 5); read only."""
    states = sampled(link_of(name, damping), Control(1e-3, **CASES[name]), np.zeros((5, 1)), STILL)[..., 0]
    states.flags.writeable = False
    return states


def run(plant: FlexibleJointPlant, control: Control, tau_ext: np.ndarray) -> np.ndarray:
    """Motor angles at the ticks, (ticks + 1, num_envs); `tau_ext` (ticks, num_envs)."""
    history = [plant.theta[:, 0].copy()]
    for push in tau_ext:
        plant.step(control(plant.theta, plant.theta_dot, plant.tau_j), push[:, None])
        history.append(plant.theta[:, 0].copy())
    return np.array(history)


def run_case(slider: Robot, name: str, physics_dt: float | None = None, damping: float = 0.0) -> np.ndarray:
    """Two seconds of one case under 1 kHz control, (2001,)."""
    link = link_of(name, damping)
    plant = FlexibleJointPlant(slider, 1, joints=link.joint, friction=link.friction, physics_dt=physics_dt)
    return run(plant, Control(plant.control_dt, **CASES[name]), STILL)[:, 0]


# --- Trajectories: two seconds of 1 kHz control ----------------------------------------------------------------------


def test_reference_is_converged() -> None:
    """Tighter tolerances and two solvers of other families move the reference by a hundredth of the bounds below."""
    link, start, gains = link_of("pid-low"), np.zeros((5, 1)), CASES["pid-low"]
    motion = solved("pid-low")[:, 2]
    tight = sampled(link, Control(1e-3, **gains), start, STILL, rtol=1e-12, atol=1e-15)[:, 2, 0]
    explicit = sampled(link, Control(1e-3, **gains), start, STILL, method="DOP853", rtol=1e-11, atol=1e-14)[:, 2, 0]
    # Radau is the slow one: the first 0.9 s hold a break-away, a slip and a stop.
    implicit = sampled(link, Control(1e-3, **gains), start, STILL[:900], method="Radau", rtol=1e-9)[:, 2, 0]
    assert np.abs(motion - tight).max() < 2e-8
    assert np.abs(motion - explicit).max() < 2e-8
    assert np.abs(motion[:901] - implicit).max() < 2e-8


@pytest.mark.parametrize("name", CASES)
def test_first_two_seconds_follow_the_solver(slider: Robot, name: str) -> None:
    """2e-6 is three times the method's error at the default micro-step; hunting is five hundred times larger."""
    assert np.abs(run_case(slider, name) - solved(name)[:, 2]).max() < 2e-6


def test_no_friction_is_the_same_whichever_way_it_is_said(slider: Robot) -> None:
    plant = FlexibleJointPlant(slider, 1, joints=JOINT, friction=FRICTIONLESS)
    np.testing.assert_array_equal(run(plant, Control(1e-3), STILL)[:, 0], run_case(slider, "no-friction"))


@pytest.mark.parametrize("damping", [5.0, 200.0])
@pytest.mark.parametrize("name", ["pid-low", "no-friction"])
def test_joint_damping_follows_the_solver(slider: Robot, name: str, damping: float) -> None:
    """A damped spring (77 is critical), up to one that is nearly rigid, within the bound of the undamped cases."""
    theirs = solved(name, damping)[:, 2]
    assert np.abs(run_case(slider, name, damping=damping) - theirs).max() < 2e-6
    assert np.abs(theirs - solved(name)[:, 2]).max() > 1e-5, "this damping moves nothing, and so tests nothing"


def test_tau_f_is_the_mean_over_the_control_period(slider: Robot) -> None:
    """The solver's mean friction follows from momentum: M dw + B dv = dt (tau_m + mean tau_f), both masses 1 kg."""
    plant = FlexibleJointPlant(slider, 1, joints=JOINT, friction=PAPER)
    ours, theirs = Control(1e-3, **CASES["pd-high"]), Control(1e-3, **CASES["pd-high"])
    states, measured, expected = solved("pd-high"), [], []
    for before, after in pairwise(states):
        tau_m = theirs(before[2], before[3], JOINT.stiffness * (before[2] - before[0]))
        expected.append((after[1] + after[3] - before[1] - before[3]) / 1e-3 - tau_m)
        plant.step(ours(plant.theta, plant.theta_dot, plant.tau_j), np.zeros((1, 1)))
        measured.append(plant.tau_f.item())
    error = np.array(measured) - expected
    # Friction is 1 to 1.5 N here. At break-away it changes by 0.5 N in 10 ms: a slip that starts 0.2 ms off costs 1e-2.
    assert np.ptp(expected) > 2.0
    assert np.abs(error).max() < 2e-2
    assert np.median(np.abs(error)) < 1e-4


def test_random_joints_follow_the_solver(slider: Robot) -> None:
    """Every parameter away from the paper's, link mass and a push included, in one batch: 1e-5 on moves of 1e-2."""
    generator = np.random.default_rng(20240611)
    cases = [link_case(generator, i) for i in range(DRAWS)]
    plant = FlexibleJointPlant(slider, DRAWS, joints=JOINT, friction=PAPER)
    for i, case in enumerate(cases):
        link = case.equations
        plant.configure(np.array([i]), joints=link.joint, friction=link.friction, mass_scale=link.mass)
    names = ("motor_inertia", "k_p", "k_d", "theta_d", "L", "L_p", "L_i", "nominal")
    columns = {name: np.array([[case.gains.get(name, 0.0)] for case in cases]) for name in names}
    ours = run(plant, Control(1e-3, **columns), np.hstack([case.tau_ext for case in cases]))
    for i, case in enumerate(cases):
        theirs = sampled(case.equations, Control(1e-3, **case.gains), np.zeros((5, 1)), case.tau_ext)[:, 2, 0]
        assert np.ptp(theirs) > 5e-3, f"draw {i} does not move, and so tests nothing"
        assert np.abs(ours[:, i] - theirs).max() < 1e-5, (i, case)


# --- Order of convergence --------------------------------------------------------------------------------------------


def observed_order(slider: Robot, name: str, micro_steps: list[float], damping: float = 0.0) -> float:
    """Slope of log(largest error) over log(micro-step)."""
    theirs = solved(name, damping)[:, 2]
    errors = [np.abs(run_case(slider, name, h, damping) - theirs).max() for h in micro_steps]
    return float(np.polyfit(np.log(micro_steps), np.log(errors), 1)[0])


@pytest.mark.parametrize("damping", [0.0, 20.0])
def test_order_two_in_smooth_motion(slider: Robot, damping: float) -> None:
    assert 1.8 < observed_order(slider, "no-friction", [1e-3, 5e-4, 2.5e-4, 1.25e-4], damping) < 2.2


@pytest.mark.parametrize("name", STICKING)
def test_order_two_through_stick_and_slip(slider: Robot, name: str) -> None:
    """From 2.5e-4 down: the stuck motor on its bristle (316 rad/s, damped at 316/s) asks for less than 4e-4."""
    assert 1.8 < observed_order(slider, name, [2.5e-4, 1.25e-4, 6.25e-5, 3.125e-5]) < 2.2


# --- Twenty seconds of nearly continuous control: what every case is known for ---------------------------------------

SAMPLE = 1e-3
TIMES = np.arange(20_001) * SAMPLE
LATE = TIMES >= 10.0


@pytest.fixture(scope="module")
def long_run(slider: Robot) -> dict[str, np.ndarray]:
    """Motor angle less target at TIMES for every case, control at 10 kHz; the cases are one batch."""
    plant = FlexibleJointPlant(slider, len(CASES), joints=JOINT, friction=PAPER, control_dt=1e-4)
    plant.configure(np.array([list(CASES).index("no-friction")]), joints=JOINT, friction=FRICTIONLESS)
    names = ("nominal", "L", "L_p", "L_i")
    gains = {name: np.array([[case.get(name, 0.0)] for case in CASES.values()], dtype=float) for name in names}
    control, still = Control(1e-4, **gains), np.zeros((len(CASES), 1))
    history = np.zeros((len(TIMES), len(CASES)))
    for sample in history[1:]:
        for _ in range(10):
            plant.step(control(plant.theta, plant.theta_dot, plant.tau_j), still)
        sample[:] = plant.theta[:, 0]
    return dict(zip(CASES, history.T - TARGET, strict=True))


def bursts(motion: np.ndarray) -> list[np.ndarray]:
    """Slips after 10 s, as bursts: times at which the speed peaks above 1e-3 m/s, less than 1 s apart."""
    speed = np.abs(np.gradient(motion, SAMPLE))
    before, here, after = speed[:-2], speed[1:-1], speed[2:]
    peaks = TIMES[1:-1][(here > before) & (here >= after) & (here > 1e-3) & (TIMES[1:-1] > 10.0)]
    return np.split(peaks, np.flatnonzero(np.diff(peaks) > 1.0) + 1)


def hops(motion: np.ndarray) -> np.ndarray:
    """Signed distance covered by each burst, from 0.5 s before its first slip to 0.5 s after its last."""
    ends = [np.searchsorted(TIMES, (burst[0] - 0.5, burst[-1] + 0.5)) for burst in bursts(motion)]
    return np.array([motion[min(last, len(TIMES) - 1)] - motion[first] for first, last in ends])


def alternates(sizes: np.ndarray) -> bool:
    return len(sizes) >= 3 and bool(np.all(sizes[1:] * sizes[:-1] < 0))


def test_none_sticks_at_once(long_run: dict[str, np.ndarray]) -> None:
    motion = long_run["none"]
    assert motion[-1] == pytest.approx(-9.977e-3, abs=1e-6)
    # Presliding creep is all that is left: two thousandths of the distance that was asked for.
    assert np.abs(motion[TIMES > 0.5] - motion[-1]).max() < 2e-5


def test_pid_low_hunts(long_run: dict[str, np.ndarray]) -> None:
    """1.07e-3 there and back; the first and last slip of a burst lie 0.33 s apart; a burst every 4.0 to 4.3 s.

    The cycle is still shrinking: the last hop is the one that is 1.07e-3, and the whole window spans 1.10e-3.
    """
    motion = long_run["pid-low"]
    groups = bursts(motion)
    settled = groups[-2][-1] + 0.25
    last = motion[settled < TIMES]
    assert alternates(hops(motion))
    assert np.ptp(last) == pytest.approx(1.07e-3, rel=0.02)
    assert [group[-1] - group[0] for group in groups] == pytest.approx([0.33] * len(groups), rel=0.02)
    gaps = np.diff([group[0] for group in groups])
    assert gaps.min() > 4.0 * 0.98
    assert gaps.max() < 4.3 * 1.02


def test_pid_high_creeps_to_the_target(long_run: dict[str, np.ndarray]) -> None:
    motion = long_run["pid-high"]
    assert np.abs(motion[-1]) < 6e-6
    assert np.ptp(motion[LATE]) < 1e-5


def test_pd_low_rests_off_the_target(long_run: dict[str, np.ndarray]) -> None:
    motion = long_run["pd-low"]
    assert motion[-1] == pytest.approx(1.04e-3, rel=0.02)
    # What moves after 1.2 s is presliding creep, not a slip: hunting would be 1e-3.
    assert np.ptp(motion[TIMES > 1.25]) < 5e-5


def test_pd_high_rests_closer(long_run: dict[str, np.ndarray]) -> None:
    motion = long_run["pd-high"]
    assert motion[-1] == pytest.approx(3.8e-5, abs=1e-5)
    assert np.ptp(motion[LATE]) < 1e-7


@pytest.mark.parametrize(("name", "size", "every"), [("letien-low", 1.25e-3, 2.1), ("letien-high", 7.7e-4, 1.8)])
def test_letien_hunts(long_run: dict[str, np.ndarray], name: str, size: float, every: float) -> None:
    """Peak to peak of the last 10 s, and the mean time from burst to burst."""
    motion = long_run[name]
    assert alternates(hops(motion))
    assert np.ptp(motion[LATE]) == pytest.approx(size, rel=0.02)
    assert np.diff([group[0] for group in bursts(motion)]).mean() == pytest.approx(every, rel=0.02)


def test_no_friction_settles(long_run: dict[str, np.ndarray]) -> None:
    """The closed loop decays with exp(-1.25 t): nothing is left after 20 s but exp(-25)."""
    assert np.abs(long_run["no-friction"][-1]) < 1e-12


@pytest.mark.parametrize("name", CASES)
def test_long_run_follows_continuous_control(long_run: dict[str, np.ndarray], name: str) -> None:
    """Span of the last 10 s within 2 % of the solver's on the continuous loop: what sampling at 10 kHz may move.

    1e-6 stands for the spans of the cases that rest, and 5e-6 is half a percent of the hunting for the mean.
    """
    theirs = continuous(link_of(name), Control(0.0, **CASES[name]), TIMES)[LATE] - TARGET
    ours = long_run[name][LATE]
    assert np.ptp(ours) == pytest.approx(np.ptp(theirs), rel=0.02, abs=1e-6)
    assert ours.mean() == pytest.approx(theirs.mean(), abs=5e-6)
