"""The command line: tables on a narrow terminal, extras, and commands of plug-ins."""

from __future__ import annotations

import json
import re
import sys
import tomllib
from importlib.metadata import EntryPoint, PackageNotFoundError
from pathlib import Path
from types import SimpleNamespace

import pytest
from commands import run
from rich.console import Console

from fo_gym import cli, extras
from fo_gym.cli import view
from fo_gym.evaluation.results.tables import Ranking
from fo_gym.tasks.variants import VARIANTS

WIDE = Ranking(
    "FJRStiction-v0, nominal",
    ["rank", "compensator", "FRR", "95 % interval", "ranks", "group", "steady-state error [mm]", "lag [ms]", "verdict"],
    [["1", "a-long-name of mine", "0.9838", "0.9821 ... 0.9852", "1 ... 3", "ab", "0.0124", "5.1", "best"]] * 2
    + [["", "theirs", "", "", "", "", "", "", "failed: KeyError: a long tale, which is told to its very end"]],
)
SETS = [f"{env}, {variant}" for env in ("FJRStiction-v0", "FJRRegulation-v0", "FJRSquare-v0") for variant in VARIANTS]
SUMMARY = Ranking("Friction rejection ratio", ["compensator", *SETS], [["pid-measured", *map(str, range(9))]])


@pytest.mark.parametrize("width", [60, 80, 100, 140])
@pytest.mark.parametrize("ranking", [WIDE, SUMMARY])
def test_tables_fit_the_terminal(
    ranking: Ranking, width: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(view, "console", Console(width=width))
    view.print_tables([ranking])
    printed = capsys.readouterr().out
    assert max(len(line) for line in printed.splitlines() if not line.startswith("left out")) <= width
    assert "…" not in printed
    named = {heading for heading in ranking.headings if all(word in printed for word in heading.split())}
    assert named == set(ranking.headings)  # as a column, or as what was left out
    if ranking is SUMMARY:
        places = [cell for line in printed.splitlines() if "pid-measured" in line for cell in line.strip("│ ").split()]
        assert [cell for cell in places if cell.isdigit()] == list("012345678")


def test_a_wide_terminal_has_every_column(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    for width, left_out in ((150, False), (80, True)):
        monkeypatch.setattr(view, "console", Console(width=width))
        view.print_tables([WIDE])
        assert ("left out" in capsys.readouterr().out) == left_out


def test_how_to_install_an_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a clone as the Makefile does it; else by the name of the package."""
    clone = json.dumps({"url": "file:///somewhere", "dir_info": {"editable": True}})
    in_place = ".venv/bin/pip install -c constraints.txt -e '.[tune]' (in the folder of the clone)"
    for noted, command in (
        (clone, in_place),
        (None, "pip install 'fo-gym[tune]'"),
        (json.dumps({"url": "file:///somewhere", "dir_info": {}}), "pip install 'fo-gym[tune]'"),
    ):
        installed = SimpleNamespace(read_text=lambda name, noted=noted: noted)
        monkeypatch.setattr(extras, "distribution", lambda name, installed=installed: installed)
        assert extras.install_command("tune") == command

    def nowhere(name: str) -> None:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(extras, "distribution", nowhere)
    assert extras.install_command("tune") == in_place


def test_extras_are_those_of_the_project() -> None:
    """Every message names an extra that pyproject.toml has."""
    root = Path(__file__).parents[1]
    known = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    sources = [
        path.read_text(encoding="utf-8") for part in ("fo_gym", "baselines") for path in (root / part).rglob("*.py")
    ]
    named = {extra for source in sources for extra in re.findall(r"install_command\(['\"](\w+)", source)}
    assert {"bench", "page", "ray", "reproduce", "rl", "tune", "video"} == named <= set(known)
    assert not [
        source for source in sources if "pip install 'fo-gym[" in source and "def install_command" not in source
    ]


def test_commands_of_plug_ins(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Listed without being imported, run when called; one that is broken or has a name of ours spoils nothing."""
    (tmp_path / "greeting.py").write_text(
        'def greet(name: str) -> None:\n    """Greet somebody."""\n    print(f"hello {name}")\n', encoding="utf-8"
    )
    monkeypatch.syspath_prepend(tmp_path)
    values = {"greet": "greeting:greet", "broken": "nowhere:at_all", "list": "greeting:greet"}
    entries = [EntryPoint(name, value, "fo_gym.commands") for name, value in values.items()]
    monkeypatch.setattr(cli, "entry_points", lambda group: entries)
    listed = run("--help")
    assert "greet" in listed.out
    assert "fo-gym: command 'list' of greeting:greet is left out: the name is taken" in capsys.readouterr().err
    assert "greeting" not in sys.modules
    assert run("greet", "you").out == "hello you\n"
    assert "Greet somebody." in run("greet", "--help").out
    wrong = run("broken")
    assert wrong.code == 2
    assert "command 'broken' of nowhere:at_all cannot be loaded: No module named 'nowhere'" in wrong.err
    assert "FJRStiction-v0" in run("list").out
