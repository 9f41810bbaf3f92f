"""docs/robots.md: its commands and blocks run, in their order, and its rules are those of the code."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

import fo_gym
from fo_gym.control import design as gains
from fo_gym.envs.registry import ENVIRONMENTS
from fo_gym.robots import design, home
from fo_gym.tasks import hand_fit, joint_fit, square_fit
from fo_gym.tasks.square import square

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "robots.md").read_text(encoding="utf-8")
FENCED = re.compile(r"^```(python|toml)\n(.*?)^```$|^    \.venv/bin/fo-gym ([^\n]+)$", re.MULTILINE | re.DOTALL)
SCORING = ("evaluate", "leaderboard")
PROGRAM = """
import json, sys
from pathlib import Path

from fo_gym.cli import app

names = {}
for kind, text in json.load(sys.stdin):
    if kind == "command":
        app(text.split(), standalone_mode=False)
    elif text.startswith("# build/"):
        path = Path(text.partition("\\n")[0].removeprefix("# "))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    else:
        exec(text, names)
rows, envs = names["rows"], names["envs"]
assert rows["robot"].tolist() == ["six_axis"], rows
assert rows["frr"][0] > 0.8, rows
assert envs.num_envs == 8
"""


def steps() -> list[tuple[str, str]]:
    """("python" | "toml" | "command", text) in the order of the page."""
    found = [match.groups() for match in FENCED.finditer(PAGE)]
    return [(kind or "command", block or command) for kind, block, command in found]


def run_page(folder: Path, chosen: list[tuple[str, str]]) -> str:
    """Output of these steps, run in one process beside a copy of the examples."""
    shutil.copytree(ROOT / "examples", folder / "examples")
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "160"}
    command = [sys.executable, "-c", PROGRAM]
    options = {"cwd": folder, "env": environment, "capture_output": True, "text": True, "input": json.dumps(chosen)}
    done = subprocess.run(command, check=False, **options)  # type: ignore[call-overload]
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return str(done.stdout)


def test_what_does_not_score(tmp_path: Path) -> None:
    output = run_page(tmp_path, [step for step in steps() if step[1].split()[0] not in SCORING])
    assert re.search(r"^taken +frictionloss +.*shoulder 2, elbow 1.5", output, re.MULTILINE)
    assert re.search(r"^dropped +joint grip +is not named; welded at 0 m", output, re.MULTILINE)
    assert re.search(r"^environment +Nod-v0 \(arm, own\): on two_links, from ", output, re.MULTILINE)
    written = (tmp_path / "build/robots/six_axis.toml").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```ini\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    assert shown in written
    assert (tmp_path / "build/robots/six_axis.png").is_file()


@pytest.mark.slow
def test_the_whole_page(tmp_path: Path) -> None:
    assert len([step for step in steps() if step[1].split()[0] in SCORING]) >= 5
    run_page(tmp_path, steps())
    rows = pd.read_csv(tmp_path / "build/two_arms/episodes.csv")
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
