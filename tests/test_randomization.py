"""The "randomized" variant draws what it says, within the ranges that it says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from environments import every_env, make

from fo_gym.micro_steps import DEFAULT_PHYSICS_DT
from fo_gym.tasks.draw import draw_scenario
from fo_gym.tasks.randomization import Randomization
from fo_gym.tasks.step import Step

DRAWS = 400


@pytest.fixture(scope="module")
def scenarios():
    """Draws of an environment's scenarios, by its id."""
    made = {}

    def of(env_id):
        if env_id not in made:
            simulation, rng = make(env_id).simulation, np.random.default_rng(0)
            robot, task = simulation.robot, simulation.task
            made[env_id] = [draw_scenario(robot, task, "randomized", rng) for _ in range(DRAWS)]
        return made[env_id]

    return of


def fill(values, low, high):
    """Whether the values stay within [low, high] and come close to both ends."""
    margin = 0.05 * (high - low)
    return low <= values.min() <= low + margin and high - margin <= values.max() <= high


@every_env
def test_parameters_fill_their_ranges(env_id, scenarios):
    simulation, drawn = make(env_id).simulation, scenarios(env_id)
    spread, friction, joints = simulation.task.randomization, simulation.robot.friction, simulation.robot.flexible

    def factors(part, name, nominal):
        return np.array([getattr(getattr(scenario, part), name) for scenario in drawn]) / getattr(nominal, name)

    for name, field in (("f_c", "friction"), ("v_s", "stribeck"), ("sigma_0", "bristle"), ("sigma_2", "viscous")):
        assert fill(factors("friction", name, friction), *getattr(spread, field)), name
    for name in ("motor_inertia", "stiffness"):
        assert fill(factors("joints", name, joints), *getattr(spread, name)), name
    np.testing.assert_allclose(
        factors("friction", "sigma_1", friction), np.sqrt(factors("friction", "sigma_0", friction)), rtol=1e-12
    )
    excess = (factors("friction", "f_s", friction) * friction.f_s) / (
        factors("friction", "f_c", friction) * friction.f_c
    ) - 1.0
    assert fill(excess / (friction.f_s / friction.f_c - 1.0), *spread.stiction)
    assert fill(np.array([scenario.mass_scale for scenario in drawn]), *spread.mass)


@every_env
def test_start_target_and_push_fill_their_ranges(env_id, scenarios):
    simulation, drawn = make(env_id).simulation, scenarios(env_id)
    task, home, spread = simulation.task, simulation.robot.home, simulation.task.randomization
    largest = np.max(spread.start)
    assert fill(np.array([scenario.q_start for scenario in drawn]) - home, -largest, largest)
    if task.random_push is None:
        assert all(scenario.push is None for scenario in drawn)
        return
    assert fill(np.array([scenario.push.time for scenario in drawn]), *spread.push_time)
    peak = np.abs(task.random_push.torque).max()
    sizes = np.array([np.abs(scenario.push.torque).max() for scenario in drawn]) / peak
    assert fill(sizes, *spread.push)
    signs = {float(np.sign(scenario.push.torque @ task.random_push.torque)) for scenario in drawn}
    assert signs == {-1.0, 1.0}
    if not isinstance(task.reference, Step):
        assert all(scenario.target is None for scenario in drawn)
        return
    steps = (np.array([scenario.target for scenario in drawn]) - home) / task.reference.size
    assert fill(np.abs(steps), *spread.step)
    # Every joint has a sign of its own, about as often one as the other (four standard deviations).
    share = (steps > 0.0).mean(axis=0)
    assert np.all(np.abs(share - 0.5) < 4.0 * 0.5 / np.sqrt(DRAWS))
    if len(home) > 1:
        assert np.any(np.sign(steps[:, 0]) != np.sign(steps[:, 1]))


@every_env
def test_other_ranges_are_drawn_from(env_id):
    """`randomization` replaces the task's own ranges, in this environment alone."""
    wide = replace(make(env_id).simulation.task.randomization, friction=(5.0, 5.0), mass=(0.9, 0.9))
    env, own = make(env_id, variant="randomized", randomization=wide), make(env_id, variant="randomized")
    nominal = env.simulation.robot.friction.f_c
    (scenario,), (usual,) = env.simulation.scenarios, own.simulation.scenarios
    np.testing.assert_allclose(scenario.friction.f_c, 5.0 * nominal, rtol=1e-12)
    assert scenario.mass_scale == pytest.approx(0.9)
    assert (usual.friction.f_c < 2.0 * nominal).all()
    np.testing.assert_array_equal(scenario.joints.stiffness, usual.joints.stiffness)


@every_env
def test_the_default_micro_step_follows_whatever_is_drawn(env_id):
    """Also the hardest bristles on the lightest motors, which one episode in some hundreds comes close to."""
    simulation = make(env_id).simulation
    robot, task, only = simulation.robot, simulation.task, np.zeros(1, dtype=np.intp)
    ends = replace(task, randomization=task.randomization.fastest)
    drawn = draw_scenario(robot, ends, "randomized", np.random.default_rng(0))
    plant = make(env_id).simulation.plant
    plant.configure(only, joints=drawn.joints, friction=drawn.friction, mass_scale=drawn.mass_scale)
    assert plant.advise(only, robot.home[None]).physics_dt.min() > DEFAULT_PHYSICS_DT


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("friction", (0.0, 1.0)),
        ("mass", (2.0, 1.0)),
        ("push_time", (-1.0, 1.0)),
        ("step", (0.0, np.inf)),
        ("start", -1.0),
    ],
)
def test_ranges_that_make_no_sense(name, value):
    with pytest.raises(ValueError, match=f"Randomization.{name} is"):
        Randomization(**{name: value})
