"""The example of a plug-in: installed beside fo-gym, known by its name, scored, and its weights count."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from tables import SQUARE

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "plugin_compensator"
PROTOCOL = f"""
name = "small"
split = "validation"
seeds = 1
environments = ["{SQUARE}"]
variants = ["nominal"]
compensators = ["pd-high", "tabulated"]
"""
CONTENT = """
import json
from fo_gym.evaluation.competitors.competitor import Competitor
found = Competitor("tabulated", "tabulated")
print(json.dumps([found.hash_on("", ""), sorted(found.content.files), found.content.versions]))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a protocol, and the plug-in installed in `site`."""
    folder = tmp_path_factory.mktemp("plugin")
    (folder / "small.toml").write_text(PROTOCOL, encoding="utf-8")
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
    run(folder, "-m", "pip", "install", *options, "--target", str(folder / "site"), str(EXAMPLE))
    return folder


def run(folder: Path, *arguments: str) -> str:
    """Output of Python in the folder, where what is in `site` is installed."""
    environment = os.environ | {"PYTHONPATH": str(folder / "site")}
    command = [sys.executable, *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return done.stdout


def content(folder: Path) -> tuple[str, list[str], dict[str, Any]]:
    """Hash, files and packages of the installed plug-in."""
    found: tuple[str, list[str], dict[str, Any]] = tuple(json.loads(run(folder, "-c", CONTENT)))
    return found


def test_it_stands_on_a_leaderboard(folder: Path) -> None:
    assert "compensator  tabulated\n" in run(folder, "-m", "fo_gym.cli", "list")
    run(folder, "-m", "fo_gym.cli", "leaderboard", "--protocol", "small.toml", "--out", "out", "--jobs", "1")
    board = pd.read_csv(folder / "out" / "leaderboard.csv").set_index("compensator")
    assert board["status"].tolist() == ["ok"] * 5
    assert board.loc["tabulated", "competitor_hash"] == content(folder)[0]
    assert board["learned"].to_dict() == {
        **dict.fromkeys(("none", "ideal", "bound", "pd-high"), False),
        "tabulated": True,
    }
    # The table knows most of the friction beforehand; the observer beside it is that of pd-high.
    assert 1.0 > board.loc["tabulated", "frr"] > board.loc["pd-high", "frr"] > 0.9


def test_its_weights_count(folder: Path) -> None:
    before, files, packages = content(folder)
    assert files == ["tabulated_friction", "tabulated_friction/table.npz"]
    assert packages == {"numpy": np.__version__}
    table = folder / "site" / "tabulated_friction" / "table.npz"
    old = table.read_bytes()
    np.savez(table, speed=np.array([0.0, 1.0]), friction=np.array([0.0, 1.0]))
    after, *_ = content(folder)
    table.write_bytes(old)
    assert after != before == content(folder)[0]


def test_its_weights_are_what_it_learned(tmp_path: Path) -> None:
    """The same training gives the same table, up to the last digits of other versions."""
    example = tmp_path / "example"
    (example / "tabulated_friction").mkdir(parents=True)
    for name in ("learn.py", "tabulated_friction/__init__.py"):
        (example / name).write_bytes((EXAMPLE / name).read_bytes())
    done = subprocess.run([sys.executable, "learn.py"], cwd=example, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with (
        np.load(EXAMPLE / "tabulated_friction" / "table.npz") as shipped,
        np.load(example / "tabulated_friction" / "table.npz") as learned,
    ):
        for name in ("speed", "friction"):
            np.testing.assert_allclose(learned[name], shipped[name], rtol=0.02)
