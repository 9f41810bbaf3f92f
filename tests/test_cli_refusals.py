"""The command line: how it says no."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from commands import run, strangers_folder, written

pytestmark = pytest.mark.usefixtures("short_episodes")

REFUSED = [
    ("evaluate nobody", "unknown compensator 'nobody'; registered are none, ideal"),
    ("evaluate nowhere.py:Mine", "there is no file nowhere.py"),
    ("evaluate mine.py:Yours", "mine.py has no 'Yours'"),
    ("evaluate mine.py:Undecided", "feedback is 'both'; allowed are 'measured', 'nominal'"),
    ("evaluate pid-high --env FJRNothing-v0", "unknown environment 'FJRNothing-v0'; known are FJRStiction-v0"),
    ("evaluate pid-high --variant wild", "unknown variant 'wild'; known are nominal, randomized"),
    ("evaluate pid-high --seeds 1001", "1001 seeds were asked for; give a number from 1 to 1000"),
    ("evaluate pid-high --traces", "--traces are written beside the results; add --out DIR"),
    ("evaluate pid-high pid-high", "two competitors are called 'pid-high'"),
    ("evaluate mine.py:Mine --gains L=70", "'mine.py:Mine' has no gain 'L'; it takes bandwidth, sign"),
    ("evaluate pid-high --gains Lx=70", "'pid-high' has no gain 'Lx'; it takes L, Lp, Li"),
    ("evaluate pid-high --gains L=7O", "L is '7O'; give a value as TOML has it"),
    ("evaluate pid-high --gains L", "--gains is 'L'; give NAME=VALUE"),
    ("evaluate pid-high --gains L=1 --gains L=2", "names 'L' twice"),
    ("evaluate pid-high --gains Li=200", "Lp^2 = 400 is not above 2 Li = 400; raise Lp above 20"),
    ("evaluate pid-high pd-high --gains L=70", "--gains and --name are for one compensator; 2 were given"),
    ("evaluate pid-high --name a|b", "--name is 'a|b'; give letters"),
    ("evaluate pid-high --baselines nobody", "unknown compensator 'nobody'"),
    ("evaluate mine.py:Mine --name pid-high", "two competitors are called 'pid-high'"),
    ("sweep nobody --gains L=1:2:3", "unknown compensator 'nobody'"),
    ("sweep mine.py:Mine --gains L=1:2:3", "'mine.py:Mine' has no gain 'L'; it takes bandwidth, sign"),
    ("sweep pid-high --gains L=20:10:3", "L is '20:10:3'; give LOW below HIGH"),
    ("sweep pid-high --gains L=a,b", "L is 'a'; give a value as TOML has it"),
    ("sweep pid-high --gains L=true,false", "L is 'true'; it is over numbers"),
    ("sweep pid-high --gains L=1,1.0", "L is '1,1.0'; it names a value twice"),
    ("sweep pid-high --gains Lp=1,2 --env FJRNothing-v0", "unknown environment 'FJRNothing-v0'"),
    ("leaderboard --quick --protocol full", "--quick and --protocol exclude each other"),
    ("leaderboard --protocol nothing.toml", "there is no protocol 'nothing.toml'; name a TOML file or one of full"),
    ("leaderboard --protocol [notes].toml", "protocol [notes].toml: "),
    ("evaluate tiny.toml", "entry tiny.toml: missing keys ['spec', 'authors', 'link'], unknown keys ['split', "),
    ("leaderboard --protocol tiny.toml --submissions nowhere", "there is no folder nowhere"),
    ("leaderboard --protocol tiny.toml --address here", "add --backend ray"),
    ("verify nowhere", "there is no nowhere/episodes.csv"),
    ("verify --jobs 0", "jobs"),
    ("leaderboard --protocol tiny.toml --jobs 0", "jobs"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with strangers_folder(tmp_path_factory.mktemp("stranger")) as folder:
        yield folder


@pytest.mark.parametrize(("command", "message"), REFUSED)
def test_refused_in_one_line(folder: Path, command: str, message: str) -> None:
    before = written(folder)
    result = run(*command.split())
    assert result.code == 2
    assert result.out == ""
    assert result.err.startswith("error: ")
    assert message in result.err
    assert result.err.count("\n") == 1
    assert written(folder) == before


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("evaluate", "COMPENSATOR"),
        ("evaluate pid-high --seeds 0", "--seeds"),
        ("evaluate pid-high --wobble", "--wobble"),
        ("evaluate pid-high --out mine.py", "mine.py"),
        ("leaderboard --out mine.py", "mine.py"),
        ("evaluat pid-high", "evaluat"),
    ],
)
def test_wrong_usage(folder: Path, command: str, message: str) -> None:
    result = run(*command.split())
    assert result.code == 2
    assert message in result.err
    assert "Usage" in result.err
