"""Twenty seconds of the single link under nearly continuous control: what every case is known for."""

from __future__ import annotations

import numpy as np
import pytest
from single_link import CASES, TARGET, link_of

from fo_gym.certificate.cases import FRICTION, JOINT, LINK
from fo_gym.certificate.oracle import Control, continuous
from fo_gym.friction import FRICTIONLESS
from fo_gym.plant import FlexibleJointPlant

pytestmark = pytest.mark.slow
SAMPLE = 1e-3
TIMES = np.arange(20_001) * SAMPLE
LATE = TIMES >= 10.0


@pytest.fixture(scope="module")
def long_run() -> dict[str, np.ndarray]:
    """Motor angle less target at TIMES for every case, control at 10 kHz; the cases are one batch."""
    plant = FlexibleJointPlant(LINK, len(CASES), joints=JOINT, friction=FRICTION, control_dt=1e-4)
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
