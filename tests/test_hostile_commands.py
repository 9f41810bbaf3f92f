"""Commands that ask for what cannot be: refused before anything runs, and nothing is written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostile_files import hostile_folder, written
from typer.testing import CliRunner

from fo_gym.cli import app

COMMANDS = """\
evaluate pid-high --jobs -5
evaluate pid-high --jobs abc
evaluate pid-high --jobs 100000
evaluate pid-high --seeds -1
evaluate pid-high --seeds 1.5
evaluate pid-high --env Nothing-v0
evaluate pid-high --env CartPole-v1
evaluate pid-high --variant wild
evaluate pid-high --out file
evaluate pid-high --out file/deeper
evaluate pid-high --out /proc/nothing/deeper
evaluate pid-high --gains L
evaluate pid-high --gains spec=1
evaluate pid-high --gains L=1979
evaluate pid-high --gains L=1 --gains L=2
evaluate pid-high --name a|b
evaluate pid-high --baselines nobody
evaluate pid-high --traces
evaluate pid-high --out loop
evaluate pid-high --out loop/deeper
evaluate pid-high --out LONG
evaluate pid-high --store loop
evaluate pid-high --store LONG
evaluate pid-high --out=
evaluate pid-high --name=
evaluate pid-high --name -
evaluate pid-high --name PID-LOW
evaluate pid-high --name LONG
evaluate ideal --name mine
evaluate none --baselines none --out new
evaluate pid-high --gains L=DIGITS
evaluate pid-high --gains L=NESTED
evaluate pid-high --baselines ,,
evaluate pid-high --baselines pid-low,pid-low
evaluate LONG.py:Mine
evaluate LONG.toml
evaluate :
evaluate ..a:b
evaluate os:path
evaluate folder.toml
evaluate binary.toml
evaluate folder.py:Mine
evaluate empty.py:Mine
leaderboard --protocol folder.toml
leaderboard --protocol binary.toml
leaderboard --protocol nothing.toml
leaderboard --protocol LONG
leaderboard --protocol nobody.toml
leaderboard --protocol case.toml
leaderboard --protocol references.toml
leaderboard --protocol space.toml
leaderboard --protocol blank.toml
leaderboard --protocol no_file.toml
leaderboard --protocol digits.toml
leaderboard --protocol nested.toml
leaderboard --protocol=
leaderboard --quick --backend ray --address=
leaderboard --quick --out loop
leaderboard --quick --store file
leaderboard --quick --store file/deeper
leaderboard --quick --out file/deeper
leaderboard --quick --submissions file
leaderboard --quick --submissions LONG
leaderboard --quick --backend nothing
leaderboard --quick --address here
leaderboard --quick --jobs -2
sweep pid-high
sweep pid-high --gains L
sweep pid-high --gains L=1:2
sweep pid-high --gains L=1:2:1000000000
sweep pid-high --gains L=1:1000:101 --gains Lp=1:1000:100
sweep pid-high --gains L=50 --out file
sweep pid-high --gains L=50 --env Nothing-v0
sweep pid-high --gains L=50 --variant wild
sweep pid-high --gains L=50 --jobs 0
sweep LONG.toml --gains L=50
verify nowhere
verify LONG
verify file
verify no_rows
verify no_text
verify no_table
verify no_seed
verify no_env
verify no_variant
verify no_file
verify no_name
verify no_processor
verify LONG
verify no_seed --sample 0
verify no_seed --seed -1
verify no_seed --jobs 0
reproduce --out file
reproduce --out file/deeper
reproduce --only nothing
reproduce --jobs 0
tune pid-high --trials 0
tune pid-high --trials -1
tune pid-high --episodes 0
tune pid-high --episodes 1001
tune pid-high --final-episodes 0
tune pid-high --seed -1
tune pid-high --seed 4294967296
tune pid-high --env Nothing-v0
tune pid-high --variant nominal
tune pid-high --variant wild
tune pid-high --out file/deeper
tune pid-high --out loop
tune pid-high --name ..
tune pid-high --name LONG
tune pid-high --env FJRStiction-v0 --env FJRStiction-v0
tune pid-high --variant hardware --variant hardware
sweep pid-high --gains L=1:2:1000000000
sweep pid-high --gains L=1:2:DIGITS
sweep pid-high --gains L=1:2:1000 --gains Lp=1:2:1000
sweep pid-high --gains L=DIGITS
train --out loop
train
train --out file
train --out new --algo nothing
bench --env Nothing-v0
bench --env FJRStiction-v0 --env FJRStiction-v0
bench --repeats 1000000000
bench --num-envs 0
bench --num-envs 1000000000
bench --repeats 0
bench --out file/deeper
"""


LONGEST = 1000
WORDS = {"LONG": "x" * 300, "DIGITS": "9" * 5000, "NESTED": "[" * 5000}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with hostile_folder(tmp_path_factory.mktemp("hostile")) as folder:
        yield folder


def test_commands(folder: Path) -> None:
    """Each ends with exit code 2 and says why in a line, or as wrong usage; none writes anything."""
    before = written(folder)
    offenders = []
    for command in COMMANDS.splitlines():
        words = re.sub("|".join(WORDS), lambda found: WORDS[found[0]], command).split()
        result = CliRunner().invoke(app, words)
        told = re.sub(r"\x1b\[[0-9;]*m", "", result.stderr)
        in_a_line = told.startswith("error: ") and told.count("\n") == 1 and len(told) < LONGEST
        if result.exit_code != 2 or not (in_a_line or "Usage" in told) or result.stdout:
            offenders.append(f"{command}: exit code {result.exit_code}, {result.exception!r}: {result.output}")
        if written(folder) != before:
            offenders.append(f"{command}: wrote {written(folder) - before}")
            before = written(folder)
    assert not offenders, "\n".join(offenders)
