"""The page on maps, films and figures: its Python runs, its commands exist, and its maps are what they say."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd
import pytest

from fo_gym.cli import _OWN

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "maps.md").read_text(encoding="utf-8")


def test_its_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, short_episodes: None) -> None:
    monkeypatch.chdir(tmp_path)
    (block,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(block, {})
    assert {path.name for path in tmp_path.iterdir()} == {"episode.png", "ranking.png"}


def test_its_commands_exist() -> None:
    commands = re.findall(r"^    \.venv/bin/fo-gym (\S+)", PAGE, re.MULTILINE)
    assert len(commands) >= 5
    assert set(commands) <= set(_OWN)


def test_its_maps_say_what_the_page_says() -> None:
    pid, pd_, friction = (pd.read_csv(DOCS / "maps" / name / "map.csv") for name in ("pid", "pd", "friction"))
    assert [len(pid), len(pd_), len(friction)] == [1600, 1600, 576]
    refused = (pid["L"] / 5.0) ** 2 <= 2.0 * pid["Li"]
    assert (pid["status"] == "failed").equals(refused)
    hunts = pid["hunting_ratio"] == 1.0
    assert hunts[~refused & (pid["L"] < 50.0)].mean() > 0.5
    assert hunts[~refused & (pid["L"] > 150.0)].mean() < 0.02
    assert (pd_["hunting_ratio"] == 1.0).mean() < 0.01
    stiff = pd_["L"] * pd_["Lp"]
    assert pd_["steady_state_error_ju"][stiff > 2000.0].max() < pd_["steady_state_error_ju"][stiff < 200.0].median()
    calm = (friction["f_s/f_c"] < 1.05) | (friction["v_s"] > 0.05)
    assert (friction["hunting_ratio"] == 1.0)[calm].mean() < 0.1
    assert (friction["hunting_ratio"] == 1.0)[(friction["f_s/f_c"] > 1.5) & (friction["v_s"] < 3e-4)].mean() > 0.7
