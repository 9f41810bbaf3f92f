"""Images: what they show, and that nothing else notices them."""

from __future__ import annotations

import copy
import gc
import os
import pickle
from dataclasses import replace

os.environ.setdefault("MUJOCO_GL", "egl")

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.passive_env_checker import env_render_passive_checker
from gymnasium.wrappers import RenderCollection

import fo_gym
from fo_gym.envs.rendering import SceneRenderer
from fo_gym.robots import LinkSide, robot_of
from fo_gym.simulation.settings import Settings
from fo_gym.simulation.simulation import Simulation
from fo_gym.tasks.interaction import interaction
from fo_gym.tasks.stiction import stiction

pytestmark = pytest.mark.looks

IDS = ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0")
STICTION_ID, REGULATION_ID, SQUARE_ID = IDS
some_slow = pytest.mark.parametrize(
    "env_id", [STICTION_ID, SQUARE_ID, pytest.param(REGULATION_ID, marks=pytest.mark.slow)]
)


@pytest.fixture(autouse=True)
def no_leftovers():
    """Renderers that other tests left behind give back their OpenGL contexts now, not while one of these draws."""
    gc.collect()


@pytest.fixture
def make():
    """gym.make, and close at the end."""
    made = []

    def make(env_id, **arguments):
        env = gym.make(env_id, **{"render_mode": "rgb_array", **arguments})
        env.reset(seed=0)
        made.append(env)
        return env

    yield make
    for env in made:
        env.close()


def hold(env, steps, share=0.0):
    """Step with `share` of the largest action."""
    for _ in range(steps):
        env.step(share * env.action_space.high)


def count_red(image):
    """Pixels in the colour of the tool's trace."""
    red, green, blue = image.astype(int).transpose(2, 0, 1)
    return int(((red - green > 90) & (red - blue > 60) & (blue > green)).sum())


def count_green(image):
    """Pixels in the colours of what is desired."""
    red, green, blue = image.astype(int).transpose(2, 0, 1)
    return int(((green - red > 40) & (green - blue > 20)).sum())


def same(image, other):
    return np.array_equal(image, other)


@some_slow
def test_image(make, env_id):
    env = make(env_id)
    image = env.render()
    assert image.shape == (480, 640, 3)
    assert image.dtype == np.uint8
    assert image.reshape(-1, 3).std(axis=0).min() > 10.0
    assert count_green(image) > 20
    assert same(env.render(), image)
    assert same(make(env_id).render(), image)
    env_render_passive_checker(env)


@pytest.mark.slow
def test_motor_and_link_are_seen_to_move(make):
    env = make(STICTION_ID)
    before = env.render()
    hold(env, 300, share=-0.5)
    changed = (env.render() != before).any(axis=2)
    motor, spring, link = changed[:, :240], changed[:, 270:390], changed[:, 430:]
    assert min(motor.sum(), spring.sum(), link.sum()) > 500


@pytest.mark.slow
def test_spring_joins_the_blocks(make):
    between = make(STICTION_ID).render()[185:225, 280:370, 0]
    assert between.std() > 15.0


@pytest.mark.slow
def test_target_is_where_the_options_put_it(make):
    env = make(STICTION_ID)
    columns = []
    for target in (-0.02, 0.02):
        env.reset(options={"target": [target]})
        image = env.render().astype(int)
        columns.append(np.nonzero(image[..., 1] - image[..., 0] > 60)[1].mean())
    assert 60 < columns[1] - columns[0] < 120


@pytest.mark.slow
def test_reference_and_trace_of_the_square(make):
    env = make(SQUARE_ID)
    start = env.render()
    assert count_green(start) > 150
    assert count_red(start) == 0
    hold(env, 2000)
    assert count_red(env.render()) > 100
    env.reset(seed=0)
    assert same(env.render(), start)


@pytest.mark.slow
def test_target_of_the_arm_jumps_with_the_step(make):
    env = make(IDS[1], duration=4.0)
    hold(env, 2999)
    before = env.render()
    hold(env, 1)
    assert (env.render() != before).any(axis=2).sum() > 20


@some_slow
def test_drawing_changes_no_trajectory(make, env_id):
    drawn, plain = make(env_id, variant="randomized"), make(env_id, variant="randomized", render_mode=None)
    rng = np.random.default_rng(1)
    for step in range(60):
        action = rng.uniform(-0.3, 0.3) * drawn.action_space.high
        one, other = drawn.step(action), plain.step(action)
        if step % 20 == 0:
            drawn.render()
        assert one[0].tobytes() == other[0].tobytes()
        assert one[1:4] == other[1:4]
        assert all(one[4][name].tobytes() == other[4][name].tobytes() for name in other[4])


@pytest.mark.slow
@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_copies_of_an_environment_that_has_drawn(make, duplicate):
    env = make(STICTION_ID)
    hold(env, 50, share=-0.5)
    image = env.render()
    twin = duplicate(env.unwrapped)
    assert same(twin.render(), image)
    twin.close()
    assert same(env.render(), image)


@pytest.mark.slow
def test_closing_twice_and_drawing_again(make):
    env = make(STICTION_ID)
    image = env.render()
    env.close()
    env.close()
    assert same(env.unwrapped.render(), image)


@pytest.mark.slow
def test_vector_draws_every_environment(make):
    envs = gym.make_vec(STICTION_ID, num_envs=2, render_mode="rgb_array", variant="randomized")
    envs.reset(seed=5)
    images = envs.render()
    assert len(images) == 2
    for i, image in enumerate(images):
        single = make(STICTION_ID, variant="randomized")
        single.reset(seed=5 + i)
        assert same(single.render(), image)
    envs.close()


@pytest.mark.slow
def test_trace_ends_with_its_episode():
    envs = gym.make_vec(SQUARE_ID, num_envs=2, render_mode="rgb_array", duration=0.6)
    envs.reset(seed=0)
    start = envs.render()
    for _ in range(600):
        envs.step(0.0 * envs.action_space.high)
    assert min(count_red(image) for image in envs.render()) > 20
    envs.step(0.0 * envs.action_space.high)
    assert all(same(image, first) for image, first in zip(envs.render(), start, strict=True))
    envs.close()


def test_frame_rate_and_collected_frames(make):
    env = RenderCollection(make(STICTION_ID, decimation=20))
    assert env.metadata["render_fps"] == 50
    env.reset(seed=0)
    hold(env, 3)
    assert [frame.shape for frame in env.render()] == [(480, 640, 3)] * 4


def test_robot_without_camera_sites_and_mocap(tmp_path):
    path = tmp_path / "bare.xml"
    path.write_text("""<mujoco><visual><global offwidth="64" offheight="64"/></visual><worldbody><light pos="0 0 2"/>
        <body><joint name="slider" type="slide" axis="1 0 0"/><geom size="0.1"/></body></worldbody></mujoco>""")
    robot = replace(robot_of("single_link"), link_side=LinkSide(path, joints=("slider",)))
    renderer = SceneRenderer(Simulation(robot, stiction, 1, Settings()), "rgb_array")
    image = renderer.frame(Simulation(robot, stiction, 1, Settings()))
    assert image.shape == (480, 640, 3)
    assert image.std() > 10.0
    renderer.close()


def test_a_hand_is_seen_while_it_holds_on(make):
    """Skin-coloured, at its own point; gone before it grips, and after it has let go."""

    def soon(robot):
        hand = fo_gym.Hand(grip=0.01, strokes=1, turn=0.05, rest=0.0, release=0.01, stroke=0.1, speed=0.5)
        return replace(interaction(robot), hand=hand)

    def count_skin(image):
        red, green, blue = image.astype(int).transpose(2, 0, 1)
        return int(((red - green > 25) & (green - blue > 15)).sum())

    env = make("FJRInteraction-v0", task=soon)
    counts = [count_skin(env.render())]
    for steps in (100, 300):
        hold(env, steps)
        counts.append(count_skin(env.render()))
    assert counts[1] > 100 + max(counts[0], counts[2])
