"""The kind of machine that computed a row: what it is called, and what counts for that."""

from __future__ import annotations

import json
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from fo_gym.evaluation.competitors.guard import process
from fo_gym.evaluation.runs import processor as module
from fo_gym.evaluation.runs.processor import processor, processor_features
from fo_gym.evaluation.runs.provenance import is_provenance, provenance
from fo_gym.instructions import VARIABLES

ELSEWHERE = Path(__file__).parents[1] / "docs" / "processors" / "elsewhere.py"
TELL = """
import json
from fo_gym.evaluation.runs.processor import processor, processor_features
print(json.dumps([processor(), dict(processor_features())]))
"""


def test_a_processor_is_named_by_what_decides_the_last_bits() -> None:
    features = processor_features()
    architecture, target, digest = processor().split()
    assert (architecture, target) == (features["architecture"], features["numba_cpu"])
    assert len(digest) == 8
    assert {"cpu", "cpu_features", "numba_features", "numpy_features", "libc", "OPENBLAS_CORETYPE"} <= set(features)
    assert provenance()["processor"] == processor()
    assert is_provenance("processor")


def test_whatever_decides_the_last_bits_changes_the_name(monkeypatch: pytest.MonkeyPatch) -> None:
    features, names = dict(processor_features()), {processor()}
    for feature in features:
        monkeypatch.setattr(module, "processor_features", lambda feature=feature: features | {feature: "other"})
        names.add(processor.__wrapped__())
    assert len(names) == 1 + len(features)


def test_a_strangers_process_computes_as_the_suites(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = {name for variables in runpy.run_path(str(ELSEWHERE))["instruction_sets"]().values() for name in variables}
    assert known <= set(VARIABLES)
    for name in VARIABLES:
        monkeypatch.setenv(name, f"that of {name}")
    environment = process._environment(str(tmp_path))
    assert {name: environment.get(name) for name in VARIABLES} == {name: f"that of {name}" for name in VARIABLES}


@pytest.mark.slow
def test_a_command_runs_as_another_processor_computes() -> None:
    def told(name: str) -> tuple[str, dict[str, str]]:
        command = [sys.executable, "-W", "error", str(ELSEWHERE), name, sys.executable, "-W", "error", "-c", TELL]
        name, features = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        return name, features

    (native, _), (generic, features) = told("native"), told("generic")
    assert native != generic
    assert generic.split()[1] == features["numba_cpu"] == "generic"
    assert features["numba_features"] == features["numpy_features"] == ""
    done = subprocess.run([sys.executable, str(ELSEWHERE), "z80", "true"], check=False, capture_output=True, text=True)
    assert "unknown instruction set 'z80'; here are native, generic" in done.stderr
