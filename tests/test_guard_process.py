"""The process of a competitor that is not ours: what it is told, where it may go, how it ends."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from answering import DOF, SQUARE, STICTION
from tables import SIX

import fo_gym
from fo_gym import specs
from fo_gym.evaluation.competitors.competitor import BASELINE, SUBMISSION, Competitor
from fo_gym.evaluation.competitors.guard import process
from fo_gym.evaluation.competitors.guard.limits import Limits
from fo_gym.evaluation.competitors.guard.proxy import Guarded
from fo_gym.evaluation.episode.faults import EndedError
from fo_gym.tuning.space import default_gains, search_space

ROOT = Path(__file__).parents[1]
ATTACKS = Path(__file__).parent / "attacks"
linux = pytest.mark.skipif(sys.platform != "linux", reason="other systems have neither Landlock nor seccomp")
MINE = """
import os
import numpy as np

print("\\x1b[31mhello")
if os.getpid() == {parent}:
    raise RuntimeError("imported where it must not be")


class Mine:
    feedback = "measured"
    search_space = {{"L": (1.0, 10.0), "P": (2.0, 3.0)}}

    def __init__(self, L=5.0, names=()):
        self.L = L
        if L > 10.0:
            raise ValueError(f"L is {{L}}; it must be at most 10")
        if L < 0.0:
            raise KeyError("negative")

    def reset(self, joints, num_envs):
        pass

    def estimate(self, signals):
        return np.zeros_like(signals.theta)
"""


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A stranger's class, whose file must not be imported here."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(MINE.format(parent=os.getpid()), encoding="utf-8")
    return "mine.py:Mine"


@pytest.mark.parametrize(
    ("env_id", "name", "source"),
    [(STICTION, "pid-high", "kim2019"), (SQUARE, "pid-high", "kim2019"), (SQUARE, "lugre-off", "lugre1995")],
)
def test_the_rows_are_the_same_bytes_as_in_this_process(env_id: str, name: str, source: str, tmp_path: Path) -> None:
    file = tmp_path / "copied.py"
    file.write_bytes((ROOT / "baselines" / f"{source}.py").read_bytes())
    arguments: dict[str, Any] = {"variant": "hardware", "seeds": 2, "duration": 0.3}
    here = fo_gym.evaluate(name, env_id, **arguments)
    there = fo_gym.evaluate(f"{file}:{name.replace('-', '_')}", env_id, **arguments)
    labels = ["compensator", "competitor_hash"]
    pd.testing.assert_frame_equal(there.drop(columns=labels), here.drop(columns=labels), check_exact=True)


def test_what_is_not_ours_is_guarded(mine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    ours = ("none", "ideal", *SIX)
    others = (mine, "baselines.kim2019:pid_high", "nobody")
    assert [name for name in (*ours, *others) if Competitor(name, name, BASELINE).guarded] == list(others)
    assert Competitor("theirs", "pid-high", SUBMISSION).guarded
    entries = specs.entry_points(group=specs.GROUP)
    foreign = [specs.EntryPoint(name, "mine:Mine", specs.GROUP) for name in ("theirs", "pid-high")]
    monkeypatch.setattr(specs, "entry_points", lambda group: [*foreign, *entries])
    with pytest.warns(UserWarning, match="plug-in 'mine:Mine' is ignored: the name 'pid-high' is reserved"):
        assert [Competitor(name, name).guarded for name in ("theirs", "pid-high")] == [True, False]


def test_what_it_says_of_its_learning_is_in_its_rows(mine: str) -> None:
    """Here and in a process of its own; and only True and False say something."""
    assert not fo_gym.evaluate(mine, STICTION, duration=0.01)["learned"].any()
    file = Path("mine.py")
    mine_py = file.read_text(encoding="utf-8")
    file.write_text(mine_py.replace("    search_space", "    learned = True\n    search_space"), encoding="utf-8")
    assert fo_gym.evaluate(mine, STICTION, duration=0.01)["learned"].all()
    assert fo_gym.evaluate("rl-direct", STICTION, duration=0.01)["learned"].all()
    file.write_text(mine_py.replace("    search_space", "    learned = 'yes'\n    search_space"), encoding="utf-8")
    with pytest.raises(TypeError, match="learned is 'yes'; give True or False"):
        fo_gym.evaluate(mine, STICTION, duration=0.01)


def test_it_is_imported_nowhere_else(mine: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Neither to score it nor to ask for its gains; and what it prints is plain."""
    assert fo_gym.evaluate(mine, STICTION, duration=0.01)["frr"].tolist() == [0.0]
    assert dict(search_space(mine)) == {"L": (1.0, 10.0), "P": (2.0, 3.0)}
    with pytest.raises(ValueError, match=r"has no attributes \['P'\]; the search starts from them"):
        default_gains(mine)
    assert capsys.readouterr().err == 3 * "mine.py:Mine | \\x1b[31mhello\n"


def test_what_a_long_run_took_is_not_taken_from_its_ticks(mine: str) -> None:
    """A tick has its limit whatever went before; the run as a whole has another one."""
    info = fo_gym.JointInfo(1, *(np.ones((1, 1)) for _ in range(3)), control_dt=1e-3)
    for spent, run, reason in ((25.0, 1800.0, None), (25.0, 20.0, r"it took longer than 20 s \(Limits.run\)")):
        guarded = Guarded(mine, {}, Limits(tick=10.0, run=run))
        guarded._spent = spent
        if reason is None:
            guarded.reset(info, 1)
        else:
            with pytest.raises(EndedError, match=reason):
                guarded.reset(info, 1)
        guarded.close()


def test_mistakes_when_it_is_made_are_told_as_ever(mine: str) -> None:
    cases: list[tuple[str, dict[str, Any], type[Exception], str]] = [
        (mine, {"L": 11.0}, ValueError, r"^L is 11.0; it must be at most 10 \(mine.py, line \d+, in __init__\)(\n|$)"),
        (mine, {"K": 1.0}, TypeError, "has no gain 'K'; it takes L, names"),
        (mine, {"L": -1.0}, fo_gym.CompensatorError, r"making it raised KeyError: 'negative' \(mine.py, line"),
        (mine, {"names": {1, 2}}, ValueError, "gains are .*; give text, numbers, lists and tables of them"),
        ("mine.py:Nobody", {}, ValueError, "mine.py has no 'Nobody'"),
        ("nowhere.py:Mine", {}, ValueError, "there is no file nowhere.py"),
    ]
    for spec, gains, kind, message in cases:
        with pytest.raises(kind, match=message):
            Guarded(spec, gains, Limits())


@linux
def test_every_way_out_is_shut(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And they are ways out: without the guard most of them are open."""
    monkeypatch.setenv("SECRET_TOKEN", "s3cr3t")
    own, others = tmp_path / "own", tmp_path / "others"
    own.mkdir()
    (own / "escapes.py").write_bytes((ATTACKS / "escapes.py").read_bytes())
    others.mkdir()
    (others / "secret.txt").touch()
    spec, gains = f"{own / 'escapes.py'}:Escapist", {"folder": [str(others)], "token": "SECRET_TOKEN"}
    with Competitor("escapist", spec, gains=gains).playing(STICTION, "nominal") as there:
        there.reset(fo_gym.JointInfo(1, *3 * [np.ones((1, 1))], 1e-3), 1)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["escapes.py", "others", "own", "secret.txt"]

    program = f"from fo_gym import make_compensator; make_compensator({spec!r}, **{gains!r})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    found = done.stderr.splitlines()[-1].partition("open: ")[2].split(", ")
    processes = {"fork", "spawn", "signal_parent", "connect", "hidden_memory", "outlive_parent", "hurry"}
    files = {"read", "list", "write", "write beside itself", "folder", "mode", "time", "truncate", "remove"}
    assert processes | files <= set(found)


@pytest.mark.slow
def test_what_competitors_build_on_works_there(tmp_path: Path) -> None:
    """Kernels that are compiled and cached, physics, linear algebra, weights beside the file, threads."""
    np.savez(tmp_path / "weights.npz", gain=np.array([[0.5]]))
    (tmp_path / "builder.py").write_text(
        "from concurrent.futures import ThreadPoolExecutor\n"
        "from pathlib import Path\n"
        "import mujoco, numba, numpy as np\n"
        "from scipy.linalg import solve\n"
        "\n"
        "@numba.njit(cache=True)\n"
        "def scaled(x, gain):\n"
        "    return gain * x\n"
        "\n"
        "class Builder:\n"
        "    feedback = 'measured'\n"
        "    def reset(self, joints, num_envs):\n"
        "        model = mujoco.MjModel.from_xml_string('<mujoco/>')\n"
        "        mujoco.mj_step(model, mujoco.MjData(model))\n"
        "        self.gain = np.load(Path(__file__).with_name('weights.npz'))['gain']\n"
        "    def estimate(self, signals):\n"
        "        with ThreadPoolExecutor(2) as pool:\n"
        "            half = pool.submit(scaled, signals.theta, self.gain[0, 0]).result()\n"
        "        return solve(self.gain, half.T).T\n"
    )
    guarded = Guarded(f"{tmp_path / 'builder.py'}:Builder", {}, Limits())
    guarded.reset(fo_gym.JointInfo(1, *3 * [np.ones((2, 1))], 1e-3), 2)
    signals = fo_gym.Signals.from_observation(np.arange(18.0).reshape(2, 9), 1)
    np.testing.assert_allclose(guarded.estimate(signals), signals.theta, rtol=1e-12)
    guarded.close()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["builder.py", "weights.npz"]


def test_without_a_protection_it_says_so(mine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    other_machine = "import platform\nplatform.machine = lambda: 'riscv64'\n"
    monkeypatch.setattr(process, "_BOOT", other_machine + process._BOOT)
    with pytest.warns(UserWarning, match="guards against competitors without: .*seccomp"):
        Guarded(mine, {}, Limits()).close()


def test_limits_are_above_zero() -> None:
    with pytest.raises(ValueError, match=r"Limits.tick is 0; it must be above 0"):
        Limits(tick=0)


def test_a_competitor_that_ended_stays_ended(mine: str) -> None:
    guarded = Guarded(mine, {}, Limits())
    guarded.close()
    guarded.close()
    with pytest.raises(RuntimeError, match="its process has ended"):
        guarded.reset(fo_gym.JointInfo(1, *3 * [np.ones((1, 1))], 1e-3), 1)


def test_a_process_that_ended_between_two_ticks_is_told_as_ended(mine: str) -> None:
    guarded = Guarded(mine, {}, Limits())
    guarded._process._process.kill()
    guarded._process._process.wait()
    with pytest.raises(EndedError, match="the process that it ran in was ended by SIGKILL"):
        guarded.reset(fo_gym.JointInfo(1, *3 * [np.ones((1, 1))], 1e-3), 1)


@pytest.mark.parametrize("env_id", DOF)
def test_signals_become_the_observation_again(env_id: str) -> None:
    obs = np.random.default_rng(0).normal(size=(3, 8 * DOF[env_id] + 4))
    np.testing.assert_array_equal(fo_gym.Signals.from_observation(obs, DOF[env_id]).observation(), obs)


@linux
def test_it_ends_with_whoever_runs_it_however_that_ends(tmp_path: Path) -> None:
    """Also in the middle of an endless loop, with the parent killed."""
    program = f"""
from fo_gym import JointInfo, Signals
from fo_gym.evaluation.competitors.guard.limits import Limits
from fo_gym.evaluation.competitors.guard.proxy import Guarded
import numpy as np
guarded = Guarded({str(ATTACKS / "endless.py") + ":Loop"!r}, {{}}, Limits())
guarded.reset(JointInfo(1, *3 * [np.ones((1, 1))], 1e-3), 1)
print(guarded._process._process.pid, flush=True)
guarded.estimate(Signals.from_observation(np.zeros((1, 9)), 1))
"""
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True) as runner:
        assert runner.stdout is not None
        child = os.pidfd_open(int(runner.stdout.readline()))
        runner.send_signal(signal.SIGKILL)
    ended = select.poll()
    ended.register(child, select.POLLIN)
    assert ended.poll(60_000)
    os.close(child)


def test_nothing_is_left_of_it(mine: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No process, no folder, no open file: neither when it is closed nor when it is forgotten."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(process.tempfile, "tempdir", str(tmp_path / "tmp"))
    before = os.listdir("/dev/fd")
    for _ in range(2):
        guarded = Guarded(mine, {}, Limits())
        pid = guarded._process._process.pid
        del guarded
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
    assert os.listdir("/dev/fd") == before
    assert list((tmp_path / "tmp").iterdir()) == []
