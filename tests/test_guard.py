"""What a competitor in a process of its own cannot do: cheat, take the run with it, hang it, get out, want too much."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tables import STICTION

from fo_gym.compensators import make_compensator
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.guard.limits import Limits
from fo_gym.evaluation.episode.recording import References
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.contest import Contest
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.run import run_contests
from fo_gym.evaluation.runs.trial import reference_trials

ATTACKS = Path(__file__).parent / "attacks"
EPISODES = EpisodeSet(STICTION, "randomized", (7, 8), {"duration": 0.05})
OURS = Competitor("pid-high", "pid-high")

CHEATS = ("TruthByMemory", "TruthByFrames", "NoFriction", "AnothersRow", "Vandal", "Rewriter")
FAILURES = {
    "endings.py:ByGeneratorExit": r"estimate raised GeneratorExit at tick 2: bye \(endings.py, line \d+, in end\)",
    "endings.py:ByInterrupt": r"estimate raised KeyboardInterrupt at tick 2:  \(endings.py, line \d+, in end\)",
    "endings.py:ByExit": "estimate raised SystemExit at tick 2: usage",
    "endings.py:ByExitOfTheProcess": "at tick 2: it ended the process that it ran in, with exit status 3",
    "endings.py:ByClosing": "at tick [23]: it ended the process that it ran in",
    "endings.py:ByCrash": "at tick 2: the process that it ran in was ended by SIGSEGV",
    "endings.py:ByRecursion": "at tick 2: the process that it ran in was ended by SIGSEGV|RecursionError|MemoryError",
    "endings.py:ByAlarm": "at tick 2: the process that it ran in was ended by SIGALRM",
    "endings.py:LongWords": r"at tick 2: \\x1b\[2J\\x07\| <img> =1\+1!{1980,1990} \(endings.py, line \d+, in end\)$",
    "endings.py:ByMuteError": r"estimate raised MuteError at tick 2:  \(endings",
    "endings.py:Fraction": r"estimate returned \[nan\] at tick 0 in episode 0; it must be finite",
    "endings.py:Wide": r"estimate returned shape \(2, 1, 1000000\) at tick 0; \(num_envs, dof\) is \(2, 1\)",
    "endings.py:Words": (
        r"estimate raised ValueError at tick 0: estimate is \[\['much'\]\], of type <U4; give real numbers"
    ),
    "forgers.py:Early": r"at tick \d+: it answered before it was asked",
    "forgers.py:Flood": "at tick 2: it sent 10000002 bytes; 1048576 are allowed",
    "forgers.py:Garbage": "at tick 2: it sent what is no JSON",
    "forgers.py:Long": "at tick 2: it sent 4294967295 bytes; 1048576 are allowed",
    "forgers.py:Deep": "at tick 2: it sent what is no JSON",
    "forgers.py:Stranger": "at tick 2: it answered with the letter b'\\?'",
    "forgers.py:Nowhere": "at tick 2: it sent a shape that is none",
    "forgers.py:Nobody": "estimate raised  at tick 2: ",
    "forgers.py:Short": "at tick 2: it made the shared memory shorter",
    "forgers.py:Poet": r"feedback is \['measured'\]; allowed are 'measured', 'nominal'",
}
WANTING = {
    "endless.py:Loop": (Limits(tick=0.3), r"it took longer than 0.3 s \(Limits.tick\)"),
    "endless.py:LoopInReset": (Limits(tick=0.3), r"reset: it took longer than 0.3 s \(Limits.tick\)"),
    "endless.py:Slow": (Limits(run=0.3), r"it took longer than 0.3 s \(Limits.run\)"),
    "asleep.py:Asleep": (Limits(making=1.0), r"making it: it took longer than 1 s \(Limits.making\)"),
    "greedy.py:Memory": (
        Limits(memory=2 << 30),
        r"raised MemoryError at tick 0: it may use 2147483648 bytes \(Limits.memory\) \(greedy.py, line \d+, in take\)",
    ),
    "greedy.py:Threads": (Limits(threads=32), r"at tick 0: it had \d+ threads; the limit is 32"),
    "greedy.py:Files": (
        Limits(scratch=1 << 22),
        "it wrote .* into its scratch folder; the limits are 10000 and 4194304",
    ),
    "greedy.py:File": (Limits(scratch=1 << 22), r"raised OSError at tick 0: \[Errno 27\] File too large"),
    "greedy.py:Chatter": (Limits(scratch=1 << 22), r"raised OSError at tick 0: \[Errno 27\] File too large"),
}


def spec(attack: str) -> str:
    return str(ATTACKS / attack)


def table_of(*competitors: Competitor) -> pd.DataFrame:
    contest = Contest(EPISODES, competitors)
    return run_contests([contest], "", backend=Processes(1)).episodes


@pytest.fixture(scope="module")
def undisturbed() -> pd.DataFrame:
    """The rows of the others where nobody attacks."""
    return table_of(OURS)


@pytest.fixture(scope="module")
def references() -> References:
    return reference_trials(EPISODES)[0]


def assert_undisturbed(table: pd.DataFrame, undisturbed: pd.DataFrame) -> None:
    """The others' rows in a table are what they are without the attacks."""
    others = table[table["compensator"].isin(undisturbed["compensator"])].reset_index(drop=True)
    pd.testing.assert_frame_equal(others, undisturbed, check_exact=True)


def test_whoever_cheats_gets_what_is_honest(undisturbed: pd.DataFrame) -> None:
    """Their estimate is zero where they find nothing, and so are their scores."""
    table = table_of(*(Competitor(name, spec(f"cheats.py:{name}")) for name in CHEATS), OURS)
    assert_undisturbed(table, undisturbed)
    scores = table.set_index("compensator")
    assert scores.loc[list(CHEATS), "status"].eq("ok").all()
    assert scores.loc[list(CHEATS), "frr"].eq(0.0).all()


@pytest.mark.parametrize("cheat", ["TruthByMemory", "TruthByFrames", "NoFriction"])
def test_in_one_process_they_would_have_found_it(cheat: str) -> None:
    """That the test above can fail."""
    found = EPISODES.record(make_compensator(spec(f"cheats.py:{cheat}")), cheat)
    honest = EPISODES.record(make_compensator("none"), "none")
    assert np.abs(found.ticks["theta"] - honest.ticks["theta"]).max() > 1e-7


@pytest.mark.slow
def test_whoever_ends_ends_alone(undisturbed: pd.DataFrame) -> None:
    table = table_of(*(Competitor(attack, spec(attack)) for attack in FAILURES), OURS)
    assert_undisturbed(table, undisturbed)
    rows = table.groupby("compensator").first()
    assert rows.loc[list(FAILURES), "status"].eq("failed").all()
    errors = rows["error"]
    assert {attack: errors[attack] for attack, why in FAILURES.items() if not re.search(why, errors[attack])} == {}


@pytest.mark.slow
def test_nobody_wants_too_much(undisturbed: pd.DataFrame) -> None:
    wanting = (Competitor(attack, spec(attack), limits=limits) for attack, (limits, _) in WANTING.items())
    table = table_of(*wanting, OURS)
    assert_undisturbed(table, undisturbed)
    rows = table.groupby("compensator").first()
    assert rows.loc[list(WANTING), "status"].eq("failed").all()
    errors = rows["error"]
    assert {attack: errors[attack] for attack, (_, why) in WANTING.items() if not re.search(why, errors[attack])} == {}
