"""Workers use their memory again; the process that asks them to work gives its own back, as ever."""

from __future__ import annotations

import platform

import pytest
from paging import page_faults

from fo_gym.evaluation.runs.allocator import keep_freed_memory
from fo_gym.evaluation.runs.backends import Processes

GLIBC = platform.libc_ver()[0] == "glibc"


@pytest.mark.skipif(not GLIBC, reason="only glibc can be told to keep freed memory")
def test_only_a_worker_keeps_what_is_freed() -> None:
    here = [faults for _, pair in Processes(1).run(page_faults, [()]) if pair for faults in pair]
    workers = [pair for _, pair in Processes(2).run(page_faults, [(), ()])]
    assert len(here) == len(workers) == 2
    assert min(here) > 30  # 64 pages of 2 MB at least, some of which may be there
    assert all(pair is not None and pair[1] < min(here) / 4 for pair in workers)


def test_where_there_is_another_c_library_nothing_happens(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(platform, "libc_ver", lambda: ("", ""))
    assert not keep_freed_memory()
