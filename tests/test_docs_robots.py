"""docs/robots.md: its commands and blocks run, in their order, and its rules are those of the code."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd
import pytest
from page_code import Step, run_pages, steps

import fo_gym
from fo_gym.control import design as gains
from fo_gym.envs.registry import ENVIRONMENTS
from fo_gym.robots import design, home
from fo_gym.tasks import hand_fit, joint_fit, square_fit
from fo_gym.tasks.square import square

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "robots.md").read_text(encoding="utf-8")
STEPS = steps(PAGE)
SCORING = ("evaluate", "leaderboard")
AFTER = """
assert rows["robot"].tolist() == ["six_axis"], rows
assert rows["frr"][0] > 0.8, rows
assert envs.num_envs == 8
"""


def is_scoring(step: Step) -> bool:
    return step.kind == "sh" and step.text.split()[1] in SCORING


def run_page(folder: Path, chosen: list[Step]) -> str:
    """Output of these steps, run in one process beside a copy of the examples."""
    output, raised = run_pages(folder, {"robots": chosen}, short=False, after=AFTER)
    assert raised == {}
    return output


def test_what_does_not_score(tmp_path: Path) -> None:
    output = run_page(tmp_path, [step for step in STEPS if not is_scoring(step)])
    assert re.search(r"^taken +frictionloss +.*shoulder 2, elbow 1.5", output, re.MULTILINE)
    assert re.search(r"^dropped +joint grip +is not named; welded at 0 m", output, re.MULTILINE)
    assert re.search(r"^environment +Nod-v0 \(arm, own\): on two_links, from ", output, re.MULTILINE)
    written = (tmp_path / "0" / "build/robots/six_axis.toml").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```ini\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    assert shown in written
    assert (tmp_path / "0" / "build/robots/six_axis.png").is_file()


@pytest.mark.slow
def test_the_whole_page(tmp_path: Path) -> None:
    assert sum(map(is_scoring, STEPS)) >= 5
    run_page(tmp_path, STEPS)
    rows = pd.read_csv(tmp_path / "0" / "build/two_arms/episodes.csv")
    assert set(rows["robot"]) == {"two", "six"}
    scores = rows.set_index(["robot", "compensator"])["frr"]
    for robot in ("two", "six"):
        assert scores[robot, "pid-high"] > 0.8


def test_a_robot_that_does_not_suit_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 3 joints; this one has 2"):
        square(robot := fo_gym.Robot.from_file(ROOT / "examples/arms/two_links.xml")).fitted_to(robot)


def test_the_rules_are_those_of_the_code() -> None:
    lines = dict(re.findall(r"^\| ([^|]+) \| (.+) \|$", PAGE, re.MULTILINE))
    rules = {
        "home": [f"{home.CANDIDATES} poses"],
        "torque limit": [
            f"{design.LIMIT_GRAVITY:g} times",
            f"{design.LIMIT_ACCELERATION:g} rad/s^2",
            f"{design.LIMIT_SHARE:g} of the strongest",
        ],
        "B": [f"/ {design.ACCELERATION:g} rad/s^2", *(f"{each:g} " for each in design.INERTIA_RATIO)],
        "K_j": [
            *(f"({each:g} rad/s)^2 B" for each in design.MOTOR_MODE),
            f"{design.SAG:g} rad",
            f"above {design.SPRING_MODE:g} rad/s",
        ],
        "D_j": [f"ratio of {design.SPRING_DAMPING:g}"],
        "f_c": [
            f"by {design.PLACEHOLDER:g} rad/s^2",
            f"at most {design.FRICTION_MOST:g} of the torque limit",
            f"{design.FRICTION_SHARE:g} of that limit",
            "{:g} to {:g} rad/s^2".format(*design.FRICTION_DECELERATION),
        ],
        "f_s": [f"{design.STICTION:g} f_c"],
        "sigma_0": ["f_c / 1e-4 rad", f"above {design.BRISTLE_MODE:g} rad/s"],
        "v_s": [f"{design.STRIBECK:g} rad/s"],
        "sigma_2": [f"{design.VISCOUS:g} B"],
        "motor PD": [
            f"{gains.JOINT.bandwidth:g} rad/s",
            f"{gains.STIFFNESS_RATE:g} B",
            f"{gains.TOMEI:g} times",
            f"damping of {gains.JOINT.damping:g}",
            f"{gains.DAMPING_RATE:g} B",
        ],
        "impedance": [
            f"{each.bandwidth:g} rad/s ({'damping ' * (each is gains.POSITION)}{each.damping:g})"
            for each in (gains.POSITION, gains.ORIENTATION, gains.ELBOW)
        ],
        "`FJRSquare-v0`": [
            f"{1e2 * square_fit.LARGEST_SIDE:g} cm",
            f"{square_fit.MARGIN:g} rad",
            f"above {square_fit.SINGULAR:g} and above {square_fit.SINGULAR_SHARE:g}",
        ],
        "`FJRTracking-v0`": [
            f"{joint_fit.AMPLITUDE:g} rad",
            "{:g} to {:g} Hz".format(*joint_fit.FREQUENCIES),
        ],
        "`FJRInteraction-v0`": [
            f"a stroke's length in {hand_fit.STROKE_TIME:g} s",
            f"at most {hand_fit.STIFFNESS:g} N/m, {hand_fit.FORCE_SHARE:g} of any torque limit",
            f"{hand_fit.TOOL_RATE:g} rad/s with the links alone",
        ],
    }
    missing = [(row, text) for row, texts in rules.items() for text in texts if text not in lines[row]]
    assert missing == []
    assert {name.strip("`") for name in lines if name.startswith("`FJR")} == set(ENVIRONMENTS)
    assert design.DEFLECTION == 1e-4
    assert (joint_fit.ROOM_SHARE, joint_fit.TORQUE_SHARE) == (0.5, 0.5)
