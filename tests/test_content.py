"""What a competitor consists of: the files and packages that its hash covers, found without running anything."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from entries import ENTRY, MINE, Write
from tables import SQUARE, STICTION

import fo_gym
from fo_gym.evaluation.competitors.content import content_of, suite
from fo_gym.evaluation.competitors.entry import load_entry


def test_only_what_is_imported_counts() -> None:
    files = set(content_of("pid-low").files)
    assert "baselines.kim2019" in files
    assert "baselines.gains" in files
    assert not {"baselines", "baselines.letien2008"} & files
    assert not any(name.startswith("fo_gym") for name in files)
    assert content_of("pid-low").versions == {"numpy": np.__version__}


def test_weights_in_a_package_count() -> None:
    files = set(content_of("rl-direct").files)
    assert {"baselines.rl.network", "baselines/rl/weights/rl-direct/policy.safetensors"} <= files
    assert "safetensors" in content_of("rl-direct").versions


def test_nothing_is_imported_or_run_to_find_out(write: Write) -> None:
    path = write(mine_py="raise RuntimeError('imported')\nfrom .. import x\nimport nowhere.at_all\n")
    assert set(content_of(f"{path}:Mine").files) == {"mine.py"}
    assert set(content_of(f"{write(broken_py='class Mine(:')}:Mine").files) == {"broken.py"}
    for spec in ("nobody", "nowhere.py:Mine", "nowhere.at_all:Mine", "none", "ideal"):
        assert content_of(spec).files == {}, spec


def test_no_source_file_ends_the_search(write: Write, tmp_path: Path) -> None:
    """The file counts however deep its syntax; links in circles and files that never end are left out."""
    deep = {"minus": "x = " + 100_000 * "-" + "1", "plus": "x = 1" + 100_000 * "+1", "else": "if x: pass\n"}
    deep["else"] += 30_000 * "elif x: pass\n"
    for name, source in deep.items():
        assert set(content_of(f"{write(mine_py=source)}:Mine").files) == {"mine.py"}, name
    (tmp_path / "nets").mkdir()
    for name in ("a", "b", "c"):
        (tmp_path / "nets" / name).symlink_to(tmp_path / "nets")
    os.mkfifo(tmp_path / "pipe")
    os.mkfifo(tmp_path / "nets" / "pipe")
    path = write(mine_py="W = ['nets', 'pipe']")
    assert set(content_of(f"{path}:Mine").files) == {"mine.py"}


def test_files_that_a_file_names_count(write: Write, tmp_path: Path) -> None:
    (tmp_path / "nets").mkdir()
    (tmp_path / "nets" / "deep.npz").write_text("1", encoding="utf-8")
    path = write(mine_py='W = ["w.npz", "nets", "..", "", "/etc", "gone.npz"]', w_npz="1", other_npz="2")
    assert set(content_of(f"{path}:Mine").files) == {"mine.py", "mine/w.npz", "mine/nets/deep.npz"}


def test_a_helper_on_the_path_counts(write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    path = write(mine_py="def f():\n    from helper_of_mine import g\n")
    (tmp_path / "helper_of_mine.py").write_text("import numpy", encoding="utf-8")
    content = content_of(f"{path}:Mine")
    assert set(content.files) == {"mine.py", "helper_of_mine"}
    assert content.versions == {"numpy": np.__version__}


def test_the_hash_tells_competitors_apart(write: Write, tmp_path: Path) -> None:
    path = write(theirs_toml=ENTRY, mine_py=MINE)
    first = load_entry(path)
    assert first.hash_on(SQUARE, "nominal") == first.hash_on(STICTION, "nominal") != first.hash_on(SQUARE, "randomized")
    moved = tmp_path / "elsewhere"
    moved.mkdir()
    for name in ("theirs.toml", "mine.py"):
        (moved / name).write_bytes((tmp_path / name).read_bytes())
    assert load_entry(moved / "theirs.toml").hash_on(SQUARE, "nominal") == first.hash_on(SQUARE, "nominal")
    write(mine_py=MINE + "\n")
    assert load_entry(path).hash_on(SQUARE, "nominal") != first.hash_on(SQUARE, "nominal")


def test_the_hash_covers_a_file_that_a_gain_names(write: Write) -> None:
    text = ENTRY.replace("L = 80.0", 'weights = "w.npz"')
    hashes = []
    for weights in ("1", "2"):
        competitor = load_entry(write(theirs_toml=text, mine_py=MINE, w_npz=weights))
        hashes.append(competitor.hash_on(SQUARE, "nominal"))
    assert hashes[0] != hashes[1]


def test_what_stands_there_for_type_checkers_alone_does_not_count(write: Write) -> None:
    imports = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import pandas\nelse:\n    import numpy\n"
    assert set(content_of(f"{write(mine_py=imports + MINE)}:Mine").versions) == {"numpy"}
    assert set(content_of(f"{write(mine_py='import pandas')}:Mine").versions) == {"pandas"}


def test_the_suite_is_everything_that_computes() -> None:
    files = set(suite().files)
    root = Path(fo_gym.__file__).parent
    for part in ("plant", "control", "tasks", "envs", "hardware", "evaluation/metrics"):
        for path in (root / part).rglob("*.py"):
            module = ".".join(("fo_gym", *path.relative_to(root).with_suffix("").parts))
            assert path.name == "__init__.py" or module in files, module
    assert {"fo_gym", "fo_gym.evaluation.episode.recording", "envs_assets", "envs_assets/miro_like.xml"} <= files
    assert not {"fo_gym.evaluation.results.tables", "fo_gym.evaluation.runs.store", "fo_gym.cli"} & files
    assert {"mujoco", "numba", "numpy"} <= set(suite().versions)
