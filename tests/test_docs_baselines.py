"""docs/baselines.md: its program runs, and its table is that of the rows there are."""

from __future__ import annotations

import re
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from fo_gym import make_compensator
from fo_gym.compensators import is_privileged

PAGE = (Path(__file__).parents[1] / "docs" / "baselines.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| (`[^|]*) \| `(\w+\.py)` \| (\w+) \| [^|]* \| ([^|]*) \|$", PAGE, re.MULTILINE)


def test_the_table_names_every_classical_row_with_its_file_its_feedback_and_its_gains() -> None:
    written = {name: row for row in ROWS for name in re.findall(r"`([\w-]+)`", row[0])}
    classical = {
        entry.name: entry.value
        for entry in entry_points(group="fo_gym.compensators")
        if not entry.value.startswith("baselines.rl")
    }
    assert set(classical) - set(written) == set()
    for name, (_, file, feedback, gains) in written.items():
        made = make_compensator(name)
        assert classical[name].startswith(f"baselines.{file.removesuffix('.py')}:"), name
        assert made.feedback == feedback, name
        tuned = set() if is_privileged(made) else set(type(made).search_space)  # type: ignore[attr-defined]
        assert tuned <= set(gains.split(", ")), name


def test_its_program_runs(capsys: pytest.CaptureFixture[str]) -> None:
    """For a moment of one episode: what it prints in full is what the page shows."""
    (block,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    short = block.replace("seeds=6", "seeds=1, duration=0.02")
    assert short != block
    exec(short, {})
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed] == ["friction", "stiction", "stribeck", "bristle", "viscous"]
