"""The published observers: what holds for every one of them, what they refuse, and the robots that they know."""

from __future__ import annotations

import inspect
from dataclasses import fields, replace

import gymnasium as gym
import numpy as np
import pytest
from observers import DT, IDENTIFIED, answers, joints, on_a_motor, random_observations

import baselines
import fo_gym
from baselines.eso import eso
from baselines.feedforward import feedforward
from baselines.garofalo2019 import supertwisting
from baselines.kaneko import kaneko
from baselines.kim2019 import pd_high, pd_low, pd_measured, pid_high, pid_low, pid_measured
from baselines.kimchung2015 import kimchung
from baselines.l1_observer import l1
from baselines.letien2008 import letien_high, letien_low
from baselines.lugre1995 import MISMATCH, lugre_nominal, lugre_off
from baselines.lugre_adaptive import lugre_adaptive
from fo_gym.friction import LuGre

NEW = (
    kimchung,
    lugre_nominal,
    lugre_off,
    lugre_adaptive,
    kaneko,
    supertwisting,
    l1,
    eso,
    pid_measured,
    pd_measured,
    feedforward,
)
OLD = (pid_high, pid_low, pd_high, pd_low, letien_high, letien_low)
every_new = pytest.mark.parametrize("make", [*NEW, lambda: kimchung(tau_k=True)], ids=lambda make: make.__name__)
GAINS = [
    (kimchung, ("L", "eps", "tie")),
    (kaneko, ("L",)),
    (supertwisting, ("S1", "T1", "S2", "T2")),
    (l1, ("G", "Gp", "K")),
    (pid_measured, ("L", "Lp", "Li")),
    (pd_measured, ("L", "Lp")),
    (feedforward, ("rate", "dry", "viscous")),
    (lugre_nominal, ("dry", "viscous")),
    (lugre_adaptive, ("L", "Lp", "rate", "share")),
    (eso, ("bandwidth",)),
]


# What holds for every one of them.


@every_new
def test_one_row_of_a_batch_is_a_batch_of_one(make):
    """To the bit; and neither another episode before nor another inertia's shape changes anything."""
    observations = random_observations(20, 3)
    batch = answers(make(), observations, joints())
    observer = make()
    answers(observer, random_observations(5, 2, seed=1), joints())
    np.testing.assert_array_equal(answers(observer, observations, joints()), batch)
    for i in range(3):
        np.testing.assert_array_equal(answers(make(), observations[:, [i]], joints())[:, 0], batch[:, i])
    info = joints()
    per_row = (np.tile(values, (3, 1)) for values in (info.motor_inertia, info.stiffness, info.torque_limit))
    wide = fo_gym.JointInfo(7, *per_row, DT, IDENTIFIED[7])
    np.testing.assert_array_equal(answers(make(), observations, wide), batch)


@every_new
def test_signals_are_read_only_to_it_and_copied(make):
    """It writes nothing into what it sees, and does not rely on it staying as it was."""
    observations = random_observations(10, 2)
    expected = answers(make(), observations, joints())
    observer, buffer = make(), np.empty_like(observations[0])
    observer.reset(joints(), 2)
    for obs, estimate in zip(observations, expected, strict=True):
        buffer[:] = obs
        np.testing.assert_array_equal(observer.estimate(fo_gym.Signals.from_observation(buffer, 7)), estimate)
        np.testing.assert_array_equal(buffer, obs)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
@pytest.mark.parametrize(("make", "gains"), GAINS, ids=lambda x: getattr(x, "__name__", ""))
def test_bad_gains_are_refused_by_name(make, gains, bad):
    for gain in gains:
        with pytest.raises(ValueError, match=rf"\w+: {gain} is {bad}; it must be finite and above 0"):
            make(**{gain: bad})


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_what_k_of_lugre_must_satisfy(bad):
    with pytest.raises(ValueError, match=rf"LuGreObserver: k is {bad}; it must be finite and at least 0"):
        lugre_nominal(k=bad)
    assert lugre_nominal(k=0.0).k == 0.0


@pytest.mark.parametrize(
    ("make", "gain"),
    [
        *((make, name) for make in (feedforward, lugre_nominal) for name in ("dry", "viscous")),
        (lugre_adaptive, "share"),
    ],
)
def test_nobody_cancels_more_than_all_of_a_model(make, gain):
    with pytest.raises(
        ValueError, match=rf"\w+: {gain} is 1\.01; above 1 it over-compensates, so it must be at most 1"
    ):
        make(**{gain: 1.01})


@pytest.mark.parametrize("make", [kimchung, kaneko, pid_measured, pd_measured, lugre_adaptive])
def test_bandwidth_beyond_the_sampling_is_refused(make):
    with pytest.raises(ValueError, match=r"L = 100.0 1/s is too fast .* keep L below 100 1/s"):
        make().reset(joints(1, control_dt=0.01), 1)


def test_a_rate_of_learning_beyond_the_sampling_is_refused():
    with pytest.raises(ValueError, match=r"rate = 20.0 1/s is too fast .* keep rate below 16.6667 1/s"):
        lugre_adaptive(L=10.0).reset(joints(1, control_dt=0.06), 1)


def test_position_weight_of_l1_beyond_the_sampling_is_refused():
    with pytest.raises(ValueError, match=r"Gp = 100.0 1/s is too fast .* keep Gp at most 50 1/s"):
        l1().reset(joints(1, control_dt=0.01), 1)
    for gains in ({"G": 1e9, "Gp": 500.0}, {"G": 10.0, "Gp": 500.0}):
        friction = np.ones(3000)
        assert on_a_motor(l1(**gains), friction, 0 * friction, 0 * friction)[-1] == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("make", [*NEW, *OLD])
def test_search_space_names_gains_of_the_constructor(make):
    """Ranges are positive, so that they can be searched in their logarithm, and the published gains lie inside."""
    observer = make()
    assert type(observer).__name__ in baselines.__all__
    assert observer.search_space
    for gain, (low, high) in observer.search_space.items():
        assert 0.0 < low <= getattr(observer, gain) <= high
        assert gain in inspect.signature(type(observer)).parameters
        assert gain in vars(make(**{gain: high if gain != "Li" else low}))


# The robots that the model-based ones know.


@pytest.mark.parametrize(("env_id", "dof"), [("FJRStiction-v0", 1), ("FJRSquare-v0", 7)])
def test_every_robot_is_identified_by_its_own_friction_or_not_at_all(env_id, dof, tmp_path):
    """By its nominal friction, whatever the episode's; an arm of one's own by its own."""
    env = gym.make(env_id, friction=LuGre(1e4, 1.0, 1.0, 2.0, 3.0, 0.02)).unwrapped
    env.reset(seed=0)
    for name, value in vars(IDENTIFIED[dof]).items():
        np.testing.assert_array_equal(getattr(env.joint_info.identified, name), value)
    robot = env.simulation.robot
    own = tmp_path / "own.xml"
    own.write_bytes(robot.link_side.file.read_bytes())
    if dof > 1:
        theirs = gym.make("FJRRegulation-v0", robot=str(own)).unwrapped
        np.testing.assert_array_equal(theirs.joint_info.identified.f_c, theirs.simulation.robot.friction.f_c)
        assert (theirs.joint_info.identified.f_c != IDENTIFIED[dof].f_c).any()
    unknown = replace(robot, identified=None)
    assert gym.make(env_id, robot=unknown).unwrapped.joint_info.identified is None


def test_parameters_may_be_off_by_factors():
    for field, factor in zip(fields(LuGre), MISMATCH, strict=True):
        observer = lugre_off()
        observer.reset(joints(7), 1)
        np.testing.assert_array_equal(
            getattr(observer._model, field.name), factor * np.asarray(getattr(IDENTIFIED[7], field.name))
        )


def test_mismatch_is_what_its_docstring_says():
    np.testing.assert_array_equal(np.sign(MISMATCH - 1.0), [1, -1, 1, -1, 1, -1])
    assert np.all((np.abs(MISMATCH - 1.0) >= 0.2) & (np.abs(MISMATCH - 1.0) <= 0.3))


@pytest.mark.parametrize("make", [lugre_nominal, lugre_off, lugre_adaptive, feedforward])
def test_an_unknown_robot_asks_for_its_parameters(make):
    with pytest.raises(ValueError, match=r"no identified friction for this robot of 3 joint\(s\); give its parameters"):
        make().reset(joints(3), 1)
    make(friction=IDENTIFIED[1]).reset(joints(3), 1)
    with pytest.raises(ValueError, match=r"friction\.sigma_0 has shape \(7,\); .* one for each of the 3"):
        make(friction=IDENTIFIED[7]).reset(joints(3), 1)
