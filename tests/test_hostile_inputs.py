"""Specs, gains, evaluations, protocols and entries: refused before anything runs, and nothing is written."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hostile import NO_NUMBERS, Attack, check_refused
from hostile_files import ESTIMATES, PROTOCOL, STICTION, hostile_folder, written

import fo_gym
from fo_gym import evaluate, make_compensator
from fo_gym.evaluation.competitors.entry import load_entry
from fo_gym.evaluation.runs.protocol import Protocol, load_protocol


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    with hostile_folder(tmp_path_factory.mktemp("hostile")) as folder:
        yield folder


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
