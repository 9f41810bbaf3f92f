"""Environments of others: what `fo_gym.register` refuses, and what a package does to others that cannot be imported."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from typing import Any

import pytest

import fo_gym
from fo_gym.envs import registry

TASK = fo_gym.Task(fo_gym.Step(size=0.05), duration=0.2)


@pytest.mark.parametrize(
    ("env_id", "tags", "message"),
    [
        ("Mine", ("arm",), "such as MyTask-v0"),
        ("FJRStiction-v0", ("link",), "is taken, by fo_gym"),
        ("Mine-v0", "arm", "tags is 'arm'; give some of link, arm"),
        ("Mine-v0", ("arm", "fast"), "give some of link, arm"),
    ],
)
def test_what_is_refused(monkeypatch: pytest.MonkeyPatch, env_id: str, tags: Any, message: str) -> None:
    before = dict(registry.ENVIRONMENTS)
    # As from a console, which has no file to be imported again.
    monkeypatch.setattr("fo_gym.envs.registration._source", lambda caller: "")
    with pytest.raises(ValueError, match=message):
        fo_gym.register(env_id, "single_link", TASK, tags=tags)
    assert before == registry.ENVIRONMENTS


def test_a_package_that_cannot_be_imported_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    broken = EntryPoint("broken", "no_such_module", registry.GROUP)
    monkeypatch.setattr(registry, "entry_points", lambda group: [broken])
    registry._import_plug_ins.cache_clear()
    with pytest.warns(UserWarning, match="importing no_such_module raised ModuleNotFoundError"):
        assert "FJRStiction-v0" in registry.known_environments()
    monkeypatch.undo()
    registry._import_plug_ins.cache_clear()
