"""`fo-gym robot` where it has nothing to show: one line, no file."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.robots import robot_of

ARMS = Path(__file__).parents[1] / "examples" / "arms"
TWO, SIX = str(ARMS / "two_links.xml"), str(ARMS / "six_axis.urdf")

REFUSED = {
    "inspect nothing.urdf": "robot file nothing.urdf does not exist",
    "inspect nobody": "robot is 'nobody'; give a Robot, one of gen3, miro_like,",
    f"inspect {TWO} --joints shoulder,wrist": r"joints ['wrist'] are not there",
    f"inspect {TWO} --tool hand": "the tool 'hand' is not there",
    f"inspect {TWO} --home 1,2,3": "home",
    f"inspect {TWO} --home ready": "home is keyframe 'ready'",
    f"new {TWO} --out there.toml": "--out there.toml is there already; name another file, or remove it",
    f"inspect {ARMS}": "robot is",
}


@pytest.mark.parametrize(("line", "told"), REFUSED.items(), ids=lambda text: text.rpartition("/")[2])
def test_refused_in_one_line(line: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("there.toml").write_text("mine", encoding="utf-8")
    result = CliRunner().invoke(app, ["robot", *line.split()])
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert told in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["there.toml"]
    assert Path("there.toml").read_text(encoding="utf-8") == "mine"


def test_what_new_writes_is_the_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["robot", "new", SIX, "--out", "arms/mine.toml"])
    assert (result.exit_code, result.stdout) == (0, "wrote arms/mine.toml\n")
    assert robot_of("arms/mine.toml").fingerprint == robot_of(SIX).fingerprint
