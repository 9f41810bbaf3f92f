"""The compiled single link: its mass, its range, and what is drawn of it."""

import mujoco
import numpy as np
import pytest
from robots import Robot, X


@pytest.fixture(scope="module")
def single() -> Robot:
    return Robot("single_link")


def test_single_link_is_one_kilogram_on_a_rail(single: Robot) -> None:
    model = single.model
    assert (model.nq, model.nv) == (1, 1)
    assert model.body_mass.sum() == 1
    assert model.joint("joint").type[0] == mujoco.mjtJoint.mjJNT_SLIDE
    np.testing.assert_array_equal(model.joint("joint").axis, X)
    for q in (-0.3, 0.0, 0.01):
        assert single.inertia(np.array([q])) == np.ones((1, 1))


def test_single_link_has_no_bias_force(single: Robot) -> None:
    data = single.data
    data.qpos[:], data.qvel[:] = 0.2, 3.0
    mujoco.mj_forward(single.model, data)
    assert data.qfrc_bias[0] == 0


def test_single_link_starts_in_the_middle_of_its_range(single: Robot) -> None:
    assert single.home == 0
    np.testing.assert_array_equal(single.model.joint("joint").range, [-0.5, 0.5])
    assert single.model.jnt_limited.all()


def test_motor_block_is_scenery(single: Robot) -> None:
    motor = single.model.body("motor")
    assert motor.mocapid[0] == 0
    assert motor.mass[0] == 0
    data = single.at(np.zeros(1))
    np.testing.assert_allclose(data.site("spring_link").xpos - data.site("spring_motor").xpos, 0.08 * X, atol=1e-15)
    data.mocap_pos[0] += 0.01 * X
    mujoco.mj_forward(single.model, data)
    np.testing.assert_allclose(data.site("spring_link").xpos - data.site("spring_motor").xpos, 0.07 * X, atol=1e-15)


def test_a_centimetre_is_plainly_visible(single: Robot) -> None:
    camera = single.data.camera("view")
    single.at(np.zeros(1))
    distance = np.linalg.norm(camera.xpos - single.data.body("link").xpos)
    height = 2 * distance * np.tan(np.deg2rad(single.model.camera("view").fovy[0]) / 2)
    assert 0.01 / height > 1 / 30
