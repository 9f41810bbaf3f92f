"""How compensators are found: by registered name, in a module, in a stranger's file; and what is refused."""

from __future__ import annotations

import pickle
import sys
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fo_gym
from baselines import LeTienObserver, PDObserver, PIDObserver
from fo_gym import list_compensators, make_compensator, specs
from fo_gym.compensators import Ideal, NoCompensation
from fo_gym.specs import GROUP

SIX = {
    "letien-high": LeTienObserver,
    "letien-low": LeTienObserver,
    "pd-high": PDObserver,
    "pd-low": PDObserver,
    "pid-high": PIDObserver,
    "pid-low": PIDObserver,
}

STRANGER = """\
import numpy as np


class Mine:
    feedback = "nominal"

    def __init__(self, gain=100.0):
        self.gain = gain

    def reset(self, joints, num_envs):
        self.inertia = joints.motor_inertia

    def estimate(self, signals):
        return self.gain * self.inertia * (signals.theta_dot - signals.theta_n_dot)


class Mute:
    feedback = "measured"

    def reset(self, joints, num_envs):
        pass


class Sideways(Mine):
    feedback = "sideways"


class Undecided:
    def reset(self, joints, num_envs):
        pass

    def estimate(self, signals):
        return signals.theta


class Fragile(Mine):
    def __init__(self):
        raise RuntimeError("there are no weights")


def tuned(**gains):
    return Mine(**({"gain": 7.0} | gains))
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working directory of a stranger, with a file of theirs."""
    (tmp_path / "mine.py").write_text(STRANGER, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def plug_ins(monkeypatch: pytest.MonkeyPatch, *entries: tuple[str, str]) -> None:
    """Let these (name, value) be all installed plug-ins."""
    found = [EntryPoint(name, value, GROUP) for name, value in entries]
    monkeypatch.setattr(specs, "entry_points", lambda group: [each for each in found if each.group == group])


def test_list_holds_the_references_and_the_baselines() -> None:
    names = list_compensators()
    assert names[:2] == ["none", "ideal"]
    assert set(SIX) <= set(names)
    assert names[2:] == sorted(set(names[2:]))


@pytest.mark.parametrize("name", SIX)
def test_registered_name(name: str) -> None:
    assert type(make_compensator(name)) is SIX[name]
    assert make_compensator(name) is not make_compensator(name)


@pytest.mark.parametrize(("name", "kind"), [("none", NoCompensation), ("ideal", Ideal)])
def test_references_are_measured_and_silent(name: str, kind: type) -> None:
    reference = make_compensator(name)
    assert type(reference) is kind
    assert reference.feedback == "measured"
    joints = fo_gym.JointInfo(2, np.ones((3, 2)), np.ones((3, 2)), np.ones((3, 2)), 1e-3)
    reference.reset(joints, 3)
    answer = reference.estimate(fo_gym.Signals.from_observation(np.ones((3, 17)), 2))
    np.testing.assert_array_equal(answer, np.zeros((3, 2)))


def test_module_and_class() -> None:
    assert vars(make_compensator("baselines.kim2019:PIDObserver", L=9.0, Lp=4.0, Li=7.0)) == {
        "L": 9.0,
        "Lp": 4.0,
        "Li": 7.0,
    }


@pytest.mark.parametrize("absolute", [False, True])
def test_file_of_a_stranger(folder: Path, absolute: bool) -> None:
    file = folder / "mine.py" if absolute else Path("mine.py")
    mine: Any = make_compensator(f"{file}:Mine")
    assert (type(mine).__name__, mine.feedback, mine.gain) == ("Mine", "nominal", 100.0)


def test_gains_pass_through(folder: Path) -> None:
    made: Any = make_compensator("mine.py:Mine", gain=3.0)
    assert made.gain == 3.0
    made = make_compensator("mine.py:tuned", gain=4.0)
    assert made.gain == 4.0
    registered: Any = make_compensator("pid-low", Li=7.0)
    assert (registered.L, registered.Lp, registered.Li) == (50.0, 10.0, 7.0)


def test_gains_of_one_do_not_leak_into_the_next() -> None:
    before: Any = make_compensator("pd-low", L=77.0)
    after: Any = make_compensator("pd-low")
    assert (before.L, after.L) == (77.0, 50.0)


def test_a_file_imported_again_is_found_again(folder: Path) -> None:
    make_compensator("mine.py:Mine")
    again = make_compensator(f"{folder}/../{folder.name}/mine.py:Mine")
    assert sys.modules[type(again).__module__].Mine is type(again)
    assert type(pickle.loads(pickle.dumps(again))) is type(again)
    assert len({name for name in sys.modules if name.startswith("fo_gym_file_") and _is_from(name, folder)}) == 1


def _is_from(name: str, folder: Path) -> bool:
    return Path(str(sys.modules[name].__file__)).is_relative_to(folder)


def test_files_of_the_same_name_stay_apart(folder: Path) -> None:
    other = folder / "other"
    other.mkdir()
    (other / "mine.py").write_text(STRANGER.replace("100.0", "5.0"), encoding="utf-8")
    first: Any = make_compensator("mine.py:Mine")
    second: Any = make_compensator("other/mine.py:Mine")
    assert (first.gain, second.gain, type(first)().gain) == (100.0, 5.0, 100.0)


def test_unknown_name_lists_the_registered() -> None:
    with pytest.raises(ValueError, match=r"unknown compensator 'pit'.*none, ideal.*pid-high, pid-low.*file\.py:Class"):
        make_compensator("pit")


@pytest.mark.parametrize(
    ("spec", "error", "message"),
    [
        ("theirs.py:Mine", ValueError, r"there is no file theirs\.py"),
        ("mine.py:Yours", ValueError, r"mine\.py has no 'Yours'"),
        ("no_such_package.sub:Mine", ValueError, r"'no_such_package\.sub:Mine'.*No module named 'no_such_package'"),
        ("baselines.kim2019:Yours", ValueError, r"baselines\.kim2019 has no 'Yours'"),
        ("mine.py:Mute", TypeError, r"'mine\.py:Mute' lacks estimate; it needs .*estimate\(signals\)"),
        ("mine.py:Undecided", TypeError, r"'mine\.py:Undecided' lacks feedback; it needs feedback = 'measured'"),
        ("mine.py:Sideways", TypeError, r"feedback is 'sideways'; allowed are 'measured', 'nominal'"),
    ],
)
def test_refused_with_the_remedy(folder: Path, spec: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make_compensator(spec)


@pytest.mark.parametrize("spec", ["none", "pid-high", "baselines.kim2019:PIDObserver", "mine.py:Mine"])
def test_unknown_gain(folder: Path, spec: str) -> None:
    with pytest.raises(TypeError, match=r"'wobble'|takes no arguments"):
        make_compensator(spec, wobble=1.0)


def test_gain_out_of_range() -> None:
    with pytest.raises(ValueError, match="raise Lp above"):
        make_compensator("pid-low", Lp=1.0)


BROKEN_FILES = {
    "syntax.py": ("class Mine(:\n", "SyntaxError"),
    "dependency.py": ("import no_such_package\n", "no_such_package"),
    "crash.py": ("1 / 0\n", "ZeroDivisionError"),
}


@pytest.mark.parametrize("file", BROKEN_FILES)
def test_a_file_that_cannot_be_imported(folder: Path, file: str) -> None:
    content, message = BROKEN_FILES[file]
    (folder / file).write_text(content, encoding="utf-8")
    with pytest.raises(fo_gym.CompensatorError, match=f"{file}:Mine.*{message}"):
        make_compensator(f"{file}:Mine")
    assert not any(name.startswith("fo_gym_file_") and _is_from(name, folder) for name in sys.modules)


def test_a_class_that_cannot_be_made(folder: Path) -> None:
    with pytest.raises(fo_gym.CompensatorError, match=r"mine\.py:Fragile.*RuntimeError: there are no weights"):
        make_compensator("mine.py:Fragile")


@pytest.mark.parametrize("name", ["ideal", "none"])
def test_a_plug_in_cannot_take_a_reserved_name(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """It is left out, and says so; everybody else is there."""
    plug_ins(monkeypatch, (name, "theirs:Ideal"), ("theirs", "baselines.kim2019:pd_low"))
    with pytest.warns(UserWarning, match=rf"theirs:Ideal.*ignored.*{name}.*reserved"):
        assert list_compensators() == ["none", "ideal", "bound", "theirs"]
    with pytest.warns(UserWarning, match="reserved"):
        assert type(make_compensator(name)).__module__ == "fo_gym.compensators"


def test_ideal_cannot_compete_under_another_name(folder: Path) -> None:
    (folder / "sneak.py").write_text("from fo_gym.compensators import Ideal\ndef make(): return Ideal()\n")
    for sneak in ("sneak.py:make", "fo_gym.compensators:Ideal"):
        with pytest.raises(ValueError, match="is the reference 'ideal', not a competitor"):
            make_compensator(sneak)
    with pytest.raises(ValueError, match="not a competitor"):
        fo_gym.evaluate(type(make_compensator("ideal")), "FJRStiction-v0", duration=0.01)


def test_a_script_that_exits_is_named(folder: Path) -> None:
    (folder / "script.py").write_text("import sys\nsys.exit('usage')\n")
    with pytest.raises(fo_gym.CompensatorError, match=r"script\.py:C.*SystemExit: usage"):
        make_compensator("script.py:C")


def test_plug_ins_of_others_are_listed_and_made(monkeypatch: pytest.MonkeyPatch) -> None:
    plug_ins(monkeypatch, ("theirs", "baselines.kim2019:pd_low"))
    assert list_compensators() == ["none", "ideal", "bound", "theirs"]
    assert type(make_compensator("theirs")) is PDObserver


def test_two_plug_ins_of_one_name_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    plug_ins(monkeypatch, ("pid", "a:X"), ("pid", "b:Y"))
    assert list_compensators() == ["none", "ideal", "bound", "pid"]
    with pytest.raises(ValueError, match=r"two plug-ins are called 'pid': a:X and b:Y; name one of them"):
        make_compensator("pid")
    plug_ins(monkeypatch, ("pid", "a:X"), ("pid", "a:X"))
    assert list_compensators() == ["none", "ideal", "bound", "pid"]


def test_evaluate_takes_name_spec_class_and_instance(folder: Path) -> None:
    mine = type(make_compensator("mine.py:Mine"))
    given: dict[str, Any] = {name: name for name in ("letien-high", "mine.py:Mine")}
    given |= {"Mine": mine, "LeTienObserver": LeTienObserver(L=100.0)}
    scores = {}
    for name, compensator in given.items():
        row = fo_gym.evaluate(compensator, "FJRStiction-v0", duration=0.2).iloc[0]
        assert row["compensator"] == name
        scores[name] = row["frr"]
    assert scores["mine.py:Mine"] == scores["Mine"]
    assert scores["letien-high"] == scores["LeTienObserver"]


@pytest.mark.parametrize("what", [object(), 3, dict, "estimate"])
def test_evaluate_refuses_what_is_no_compensator(what: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="compensator"):
        fo_gym.evaluate(what, "FJRStiction-v0", duration=0.01)
