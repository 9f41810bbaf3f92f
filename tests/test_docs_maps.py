"""The page on maps, films and figures: its Python runs, its commands exist, and its maps are what they say."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fo_gym.cli import _OWN
from fo_gym.page.maps import maps_in

pytestmark = pytest.mark.looks

DOCS = Path(__file__).parents[1] / "docs"
MAPS = DOCS.parent / "leaderboard" / "maps"
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
    pid, pd_, friction = (pd.read_csv(MAPS / name / "map.csv") for name in ("pid", "pd", "friction"))
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


def test_the_page_has_its_maps_with_what_is_marked() -> None:
    maps = {each.name: each for each in maps_in(MAPS)}
    assert list(maps) == ["friction", "pd", "pid"]
    assert [layer.title for layer in maps["pid"].layers] == [
        "limit cycle, peak to peak [mm]", "steady state error [mm]", "1 - FRR, what is left of friction's effect"
    ]  # fmt: skip
    assert maps["pd"].layers[0].title == "steady state error [mm]"
    assert maps["pid"].marks.points == [
        ("paper&#x27;s low gains", 50.0, 25.0),
        ("paper&#x27;s high gains", 100.0, 100.0),
    ]
    assert maps["pid"].marks.line_name == "L<sub>p</sub><sup>2</sup> = 2 L<sub>i</sub>"
    np.testing.assert_allclose(
        [y for _, y in maps["pid"].marks.line], np.square(maps["pid"].x.values) / 50.0, rtol=1e-5
    )
    assert maps["friction"].marks.points == maps["friction"].marks.line == []
    hunting = np.array(maps["friction"].layers[0].values, dtype=float)  # v_s upwards, f_s/f_c to the right
    assert maps["friction"].layers[0].low == 0.1
    assert hunting[0, 0] < 0.1
    assert hunting[0, -1] > 0.5
