"""What the kernel is compiled of: kept on disk, and never older than what it was made of."""

from __future__ import annotations

import importlib
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import fo_gym
from fo_gym import compiling
from fo_gym.friction import LuGre
from fo_gym.plant.kernels import kernel_of

ROOT = Path(__file__).parents[1]

LAW = """
from dataclasses import dataclass
from helper import factor
from fo_gym.friction import FrictionLaw, Levels

SHARE = {share}


def respond(v, z, h, p, memory):
    return 0.0, SHARE * factor() * p.sigma_2


@dataclass(frozen=True)
class Viscous(FrictionLaw):
    sigma_2: float = 1.0
    levels = Levels(viscous="sigma_2")
    states = 0
    respond = staticmethod(respond)

    @staticmethod
    def step(v, z, h, p, memory):
        return -SHARE * factor() * p.sigma_2 * v
"""
HELPER = "def factor():\n    return {factor}\n"
RUN = """
import sys
from own import Viscous
from fo_gym.certificate.experiments import Joint
joint = Joint(friction=Viscous())
joint.put(theta_dot=1.0)
print(-joint.advance() / (0.5 + 0.5 * joint.theta_dot))
advance = joint._advance
print(len(advance.stats.cache_hits), len(advance.stats.cache_misses))
"""


def ran(folder: Path, share: float, factor: float) -> tuple[float, str]:
    """Viscous friction that a new process feels, and how it came by its kernel; who compiles it says so."""
    folder.joinpath("own.py").write_text(LAW.format(share=share))
    folder.joinpath("helper.py").write_text(HELPER.format(factor=factor))
    for file in folder.glob("*.py"):
        os.utime(file, (1e9, 1e9))  # the same time stamp and, with one digit each, the same size
    environment = os.environ | {
        "PYTHONPATH": f"{folder}{os.pathsep}{ROOT}",
        "NUMBA_CACHE_DIR": str(folder / "cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [sys.executable, "-c", RUN]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    felt, how = done.stdout.splitlines()
    told = "compiling the joint kernel of Viscous for this machine, once: some ten seconds\n"
    assert done.stderr == (told if how == "0 1" else "")
    return float(felt), how


def test_a_law_that_is_edited_runs_as_it_is_now(tmp_path: Path) -> None:
    """A constant of the law's file, and a helper in another; what has not changed is not compiled again."""
    assert ran(tmp_path, 1, 1) == (pytest.approx(1.0), "0 1")
    assert ran(tmp_path, 1, 1) == (pytest.approx(1.0), "1 0")
    assert ran(tmp_path, 2, 1) == (pytest.approx(2.0), "0 1")
    assert ran(tmp_path, 2, 3) == (pytest.approx(6.0), "0 1")
    assert ran(tmp_path, 2, 3) == (pytest.approx(6.0), "1 0")
    assert len(list((tmp_path / "cache").rglob("*Viscous*.nbi"))) == 1, "a law leaves its old kernels behind"


def outer(x: float) -> float:
    return inner(x) + 1.0


def inner(x: float) -> float:
    return 2.0 * x


def test_plain_functions_are_compiled_with_what_they_call() -> None:
    assert compiling.compiled(outer)(3.0) == 7.0
    assert outer(3.0) == 7.0


def test_the_content_of_a_kernel_holds_what_it_is_made_of(monkeypatch: pytest.MonkeyPatch) -> None:
    before = compiling.content(outer)
    assert compiling.content(outer) == before
    monkeypatch.setitem(globals(), "inner", lambda x: 3.0 * x)
    assert compiling.content(outer) != before


def test_whatever_is_kept_is_kept_under_all_that_it_calls() -> None:
    """What a function calls must stand above it: its content is taken when it is made."""
    for info in pkgutil.walk_packages(fo_gym.__path__, "fo_gym."):
        importlib.import_module(info.name)
    kept = {
        f"{name}.{each}": thing
        for name, module in list(sys.modules.items())
        if name.startswith("fo_gym.")
        for each, thing in vars(module).items()
        if isinstance(getattr(thing, "_cache", None), compiling._ContentCache)
    }
    assert len(kept) > 10
    assert [name for name, thing in kept.items() if thing._cache._stamp != compiling.content(thing)] == []


def test_laws_of_one_kind_share_a_kernel() -> None:
    one, other = LuGre(1e5, 300.0, 0.4, 1.0, 1.5, 1e-3), LuGre(1e4, 30.0, 0.4, 1.0, 1.5, 1e-3)
    assert kernel_of(one) is kernel_of(other)
