"""Specs, gains, evaluations, protocols, entries and commands: refused before anything runs, and nothing is written."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hostile import NO_NUMBERS, Attack, check_refused
from typer.testing import CliRunner

import fo_gym
from fo_gym import evaluate, make_compensator
from fo_gym.cli import app
from fo_gym.evaluation.competitors.entry import load_entry
from fo_gym.evaluation.runs.protocol import Protocol, load_protocol

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"
ROW = "env,variant,compensator,seed,protocol,competitor_hash\n"
FILES: dict[str, str | bytes] = {
    "file": "",
    "empty.py": "",
    "binary.toml": bytes(range(256)),
    "empty.toml": "",
    "no_rows/episodes.csv": "",
    "no_text/episodes.csv": bytes(range(256)),
    "no_table/episodes.csv": "a,b\n1\n1,2,3\n",
    "no_seed/episodes.csv": f"{ROW}{STICTION},nominal,pid-low,1.5,full@1,1\n",
    "no_env/episodes.csv": f"{ROW}Nothing-v0,nominal,pid-low,1,full@1,1\n",
    "no_name/episodes.csv": f"{ROW}{STICTION},nominal,{'x' * 100000},1,full@1,1\n",
    "no_processor/episodes.csv": f"{ROW}{STICTION},nominal,pid-low,1,full@1,1\n",
    "no_processor/processor.json": '{"x": 3}',
    "no_variant/episodes.csv": f"{ROW}{STICTION},wild,pid-low,1,full@1,1\n",
}


PROTOCOL = {
    "name": '"small"',
    "split": '"validation"',
    "seeds": "2",
    "environments": '["FJRSquare-v0"]',
    "variants": '["nominal"]',
    "compensators": '["pid-low"]',
}


def protocol(**keys: str) -> str:
    return "\n".join(f"{key} = {value}" for key, value in {**PROTOCOL, **keys}.items())


PROTOCOLS = {
    "nobody.toml": protocol(compensators='["nobody"]'),
    "references.toml": protocol(compensators='["none", "ideal"]'),
    "case.toml": protocol(compensators='["PID-low"]'),
    "space.toml": protocol(compensators='["pid-low "]'),
    "blank.toml": protocol(compensators='[""]'),
    "no_file.toml": protocol(compensators='["nothing.py:Mine"]'),
    "digits.toml": protocol(seeds="9" * 5000),
    "nested.toml": f"name = {'[' * 5000}",
}
MINE = """import numpy as np
class Mine:
    feedback = "nominal"
    def reset(self, joints, num_envs): self.shape = (num_envs, joints.dof)
    def estimate(self, signals): return {estimate}
"""
ESTIMATES = {
    "complex_.py": "np.zeros(self.shape, complex)",
    "bools.py": "np.zeros(self.shape, bool)",
    "objects.py": "np.zeros(self.shape, object)",
    "masked.py": "np.ma.masked_array(np.zeros(self.shape), mask=True)",
    "texts.py": "np.full(self.shape, '1')",
    "nothing_.py": "None",
}
"""What a file's class gives, which crosses to another process."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A working directory with files that are not what they are taken for."""
    folder = tmp_path_factory.mktemp("hostile")
    for name, content in FILES.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    (folder / "loop").symlink_to("loop")
    for name in (*PROTOCOLS, *ESTIMATES):
        content = PROTOCOLS.get(name) or MINE.format(estimate=ESTIMATES.get(name))
        (folder / name).write_text(content, encoding="utf-8")
    for name in ("folder.toml", "folder.py", "no_file/episodes.csv"):
        (folder / name).mkdir(parents=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield folder


def written(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if "__pycache__" not in path.parts}


def test_specs(folder: Path) -> None:
    before = written(folder)
    specs: tuple[Any, ...] = (
        *(None, True, 1, 1.5, 1j, b"pid-low", "", ["pid-low"], {"pid-low"}, object(), len, np.array(["none", "none"])),
        *("nobody", ":", "a:", ":b", ".a:b", "..a:b", "no such:Mine", "a.b.c:Mine", "file:Mine", "pid-low\n", " "),
        *("nothing.py:Mine", "folder.py:Mine", "empty.py:Mine", "os:path", "os:sep", "os:nothing"),
    )
    check_refused(("compensator", value, make_compensator) for value in specs)
    assert written(folder) == before


NUMBERS: tuple[Any, ...] = (True, "1.5", 1j, np.timedelta64(1), None, math.nan, math.inf, 0.0, -1.0, [50.0], 10**400)
OBSERVERS = (
    ("PIDObserver", "pid-low", ("L", "Lp", "Li")),
    ("PDObserver", "pd-high", ("L", "Lp")),
    ("LeTienObserver", "letien-low", ("L", "gain")),
    ("SuperTwistingObserver", "supertwisting", ("S1", "T2")),
    ("KanekoObserver", "kaneko", ("L",)),
    ("KimChungObserver", "kimchung", ("L", "eps", "tie")),
    ("L1Observer", "l1", ("G", "Gp", "K")),
    ("FrictionFeedForward", "feedforward", ("rate",)),
)


def test_gains() -> None:
    cases: list[Attack] = [
        (f"{told}: {gain}", value, lambda value, spec=spec, gain=gain: make_compensator(spec, **{gain: value}))
        for told, spec, gains in OBSERVERS
        for place, gain in enumerate(gains)
        for value in (NUMBERS if spec == "pid-low" and place == 0 else NUMBERS[:: 2 + place])
    ]
    cases += [
        ("LuGreObserver: k", each, lambda each: make_compensator("lugre-off", k=each)) for each in NUMBERS if each != 0
    ]
    cases += [
        ("KimChungObserver: tau_k", each, lambda each: make_compensator("kimchung", tau_k=each))
        for each in (1, "no", None)
    ]
    cases += [
        ("friction", value, lambda value, spec=spec: make_compensator(spec, friction=value))
        for spec in ("lugre-nominal", "feedforward")
        for value in (1.0, "lugre", {}, {1: 1.0}, [fo_gym.FRICTIONLESS])
    ]
    cases += [("LeTienObserver: gain", 1.5, lambda value: make_compensator("letien-low", gain=value))]
    check_refused(cases)
    with pytest.raises(ValueError, match=r"Lp\^2 = 49 is not above 2 Li = 49; raise Lp above 7 or lower Li below 24.5"):
        make_compensator("pid-low", Lp=7.0, Li=24.5)


def test_evaluations(folder: Path) -> None:
    before = written(folder)

    def scored(**arguments: Any) -> object:
        return evaluate(**{"compensator": "pid-low", "env_id": STICTION, **arguments})  # type: ignore[arg-type]

    seeds = (*NO_NUMBERS, 0, -1, 1.5, "20", b"20", 1001, 10**400, iter([1]), np.zeros((2, 2), int))
    cases: list[Attack] = [("seeds", value, lambda value: scored(seeds=value, variant="randomized")) for value in seeds]
    cases += [
        ("seeds", value, lambda value: scored(seeds=value)) for value in ([], (), [1, 1], [3, 2, 3], np.zeros(0, int))
    ]
    cases += [("seeds[0]", value, lambda value: scored(seeds=[value])) for value in (*NO_NUMBERS, None, 1.5, -1, "1")]
    cases += [("env_id", value, lambda value: scored(env_id=value)) for value in (None, 1, ["a"], "", b"a", {})]
    cases += [("environment", value, lambda value: scored(env_id=value)) for value in ("Nothing-v0", "FJRStiction-v9")]
    cases += [("'CartPole-v1'", "CartPole-v1", lambda value: scored(env_id=value))]
    cases += [
        ("variant", value, lambda value: scored(variant=value)) for value in (None, 1, "wild", "", ["nominal"], True)
    ]
    cases += [
        (f"'{kind.__name__}'", "lacks", lambda _, kind=kind: scored(compensator=kind()))
        for kind in (int, bool, float, list, dict, object, type(None))
    ]
    cases += [("'int'", "lacks", lambda _: scored(compensator=int))]
    for name in (
        "render_mode",
        "num_envs",
        "autoreset_mode",
        "fricton",
        "env_kwargs",
        "vectorization_mode",
        "max_episode_steps",
    ):
        cases += [(name, name, lambda name: scored(**{name: 1}))]
    for name in ("feedback", "action_mode"):
        cases += [(name, name, lambda name: scored(**{name: "nominal"}))]
    cases += [
        ("duration", 1e300, lambda value: scored(duration=value)),
        ("decimation", True, lambda value: scored(decimation=value)),
    ]
    cases += [("feedback", "nominal", lambda _: scored(sensors="motor"))]
    check_refused(cases)
    assert written(folder) == before


def test_what_files_estimate(folder: Path) -> None:
    """What is no array of real numbers stays none on its way from another process."""
    for name in ESTIMATES:
        with pytest.raises(fo_gym.CompensatorError, match=r"estimate.*(give real numbers|without a mask)"):
            evaluate(f"{name}:Mine", STICTION, duration=0.01)


def test_classes_that_raise_when_made_are_named() -> None:
    class Refusing:
        def __init__(self) -> None:
            raise ZeroDivisionError("no")

    class Hiding:
        @property
        def feedback(self) -> str:
            raise RuntimeError("no")

    for kind in (Refusing, Hiding):
        with pytest.raises(fo_gym.CompensatorError, match=f"compensator '{kind.__name__}': making it raised .*: no"):
            evaluate(kind, STICTION)


def check_files(
    folder: Path, read: Callable[[Path], object], good: Mapping[str, str], tried: Mapping[str, Iterable[str]]
) -> None:
    """Fail, naming them all, where a TOML file with a key spoilt is read, or refused without naming the key."""
    file, offenders = folder.parent / "tried.toml", []
    for key, values in tried.items():
        for value in values:
            file.write_text("\n".join(f"{k} = {v}" for k, v in {**good, key: value}.items()), encoding="utf-8")
            try:
                read(file)
            except ValueError as error:
                if key.removesuffix("s") not in str(error):
                    offenders.append(f"{key} = {value}: {error}")
            else:
                offenders.append(f"{key} = {value}: accepted")
    assert not offenders, "\n".join(offenders)


KEYS = tuple(PROTOCOL)


def test_protocols(folder: Path) -> None:
    good: dict[str, Any] = dict(zip(KEYS, ("p", "validation", 2, (STICTION,), ("nominal",), ("pid-low",)), strict=True))
    bad: dict[str, tuple[Any, ...]] = {
        "name": (None, 1, True, "", ["p"]),
        "split": (None, 1, "training", ["validation"], True),
        "seeds": (True, 1.5, "2", None, [2]),
        "environments": ((), (1,), ("Nothing-v0",), (STICTION, STICTION), (True,), ([STICTION],)),
        "variants": ((), (1,), ("wild",), ("nominal", "nominal")),
        "compensators": ((), (1,), ("a", "a"), (None,)),
    }
    check_refused(
        (
            name.removesuffix("s"),
            (value[0] if value else []) if isinstance(value, tuple) else value,
            lambda _, name=name, value=value: Protocol(**{**good, name: value}),
        )
        for name, values in bad.items()
        for value in values
    )
    with pytest.raises(ValueError, match=r"1001|seeds"):
        Protocol(**{**good, "seeds": 10**30})
    before = written(folder)
    values = (
        "true",
        "1.5",
        "-1",
        '""',
        "[]",
        "[1]",
        "{}",
        "{a = 1}",
        "1979-05-27",
        "nan",
        "99999999999999999999",
        "[true]",
    )
    check_files(folder, load_protocol, PROTOCOL, dict.fromkeys(KEYS, values))
    for name in ("binary.toml", "folder.toml", "empty.toml", "nothing.toml", ""):
        with pytest.raises(ValueError, match=re.escape(f"protocol {name}:") + "|there is no protocol"):
            load_protocol(name)
        with pytest.raises(ValueError, match=re.escape(f"entry {name or '.'}")):
            load_entry(Path(name))
    assert written(folder) == before


ENTRY = {"spec": '"mine.py:Mine"', "authors": '["Me"]', "link": '""'}


def test_entries(folder: Path) -> None:
    tried = {
        "spec": ("1", "true", '""', '"none"', '"ideal"', "[]", "{}", "1979-05-27"),
        "authors": ("1", "true", '"Me"', "[]", "[1]", '["a\\nb"]', "{}"),
        "link": ("1", "true", "[]", '"javascript:x"', '"http://a b"', '"ftp://a"'),
        "name": (
            "1",
            "true",
            "[]",
            '""',
            '"none"',
            '"IDEAL"',
            '".."',
            '"-"',
            '"--out"',
            f'"{"x" * 101}"',
            '"a|b"',
            '"a\\nb"',
            '"<img>"',
            '"../a"',
        ),
        "gains": ("1", "true", "[]", '"L"'),
        "sets": ("1", "true", '"L"', "{}", "[1]", "[[]]", "[{}]", '[{env = "a", variant = "nominal", gains = {}}]'),
        "colour": ("1",),
    }
    check_files(folder, load_entry, ENTRY, tried)


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
