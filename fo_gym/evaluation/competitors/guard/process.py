"""A competitor's process as the suite sees it: how it is started, watched, waited for and ended."""

from __future__ import annotations

import json
import os
import select
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import weakref
from contextlib import suppress
from pathlib import Path
from typing import IO, Protocol

from fo_gym.evaluation.competitors.guard import memory
from fo_gym.evaluation.competitors.guard.limits import Limits
from fo_gym.evaluation.episode.faults import EndedError, plain
from fo_gym.instructions import VARIABLES

_BOOT = """import json, sys
sys.path[:] = json.loads(sys.argv[1])
from fo_gym.evaluation.competitors.guard.boot import main
main(int(sys.argv[2]), int(sys.argv[3]))
"""
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""One each: more would fight for the cores, move last digits, and be there before they can be confined."""
_KEPT = ("LANG", "LC_ALL", "TZ", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", *VARIABLES)
"""What of the environment the process has: what chooses language and instructions, and no secrets."""

_GLANCE = 0.05
"""How long to wait before looking what the process is up to [s]."""
_FAREWELL = 1.0
"""How long a process that closed the connection may take to end [s]."""
_MOST_FILES = 10_000
_LONGEST_OUTPUT = 4000
"""Characters that are passed on of what it printed."""

__all__ = ["Process"]


class Closes(Protocol):
    """A file or a socket."""

    def close(self) -> None:
        """Give it back."""


def _environment(scratch: str) -> dict[str, str]:
    kept = {name: os.environ[name] for name in _KEPT if name in os.environ}
    own = {**dict.fromkeys(("HOME", "TMPDIR", "NUMBA_CACHE_DIR"), scratch), **dict.fromkeys(_THREADS, "1")}
    # MuJoCo, which a competitor may build on, would else start a process to look for a screen.
    return {**kept, **own, "MUJOCO_GL": "disable"}


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # a real-time signal
        return f"signal {number}"


def _kill(process: subprocess.Popen[bytes]) -> None:
    """End the process and all that it started."""
    if process.returncode is None:  # else its number may be somebody else's by now
        with suppress(ProcessLookupError, PermissionError):  # PermissionError: a group of the dead, on macOS
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _clean(process: subprocess.Popen[bytes], scratch: str, shared: int, *open_files: Closes) -> None:
    """End the process and leave nothing of it."""
    _kill(process)
    os.close(shared)
    for file in open_files:
        file.close()
    shutil.rmtree(scratch, ignore_errors=True)


class Process:
    """A Python of its own, started afresh: nothing of this process's memory is in it.

    It ends with `end`, with this object, and where the system can do that with this process, however that ends.

    Attributes:
        connection: socket to it.
        memory: file descriptor of what is shared with it.
        scratch: the folder that it may write.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._deadline = 0.0
        self.scratch = tempfile.mkdtemp(prefix="fo-gym-")
        self.memory = memory.create()
        self._output: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the process)
        self.connection, theirs = socket.socketpair()
        paths = json.dumps([os.path.abspath(path) for path in sys.path])
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-u", "-c", _BOOT, paths, str(theirs.fileno()), str(self.memory)],
                stdin=subprocess.DEVNULL,
                stdout=self._output,
                stderr=self._output,
                env=_environment(self.scratch),
                start_new_session=True,
                pass_fds=(theirs.fileno(), self.memory),
            )
        # What it does not read, it shall not hold up: sending raises BlockingIOError then.
        patience = struct.pack("ll", max(1, int(limits.tick)), 0)
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, patience)
        self._readable = select.poll()
        self._readable.register(self.connection, select.POLLIN)
        files = (self.connection, self._output)
        self._clean = weakref.finalize(self, _clean, self._process, self.scratch, self.memory, *files)

    def expect_within(self, seconds: float) -> None:
        """Set the deadline of what comes next. Raises TimeoutError where there is no time left."""
        if seconds <= 0:
            raise TimeoutError
        self._deadline = time.monotonic() + seconds

    def has_spoken(self, seconds: float = 0.0) -> bool:
        """Whether there is something to read, after waiting for that long at most."""
        return bool(self._readable.poll(1000.0 * seconds))

    @property
    def ended(self) -> bool:
        """Whether `end` was called."""
        return not self._clean.alive

    def wait(self) -> None:
        """Return when there is something to read.

        Raises:
            TimeoutError: there is nothing by the deadline.
            EndedError: it has too many threads, or wrote too much.
        """
        while not self.has_spoken(_GLANCE):
            self.look()
            if time.monotonic() > self._deadline:
                raise TimeoutError

    def look(self) -> None:
        """See what the process is up to. Raises EndedError where that is too much."""
        tasks = Path(f"/proc/{self._process.pid}/task")
        with suppress(OSError):  # no such folder: another system, or it has just ended
            threads = tasks.stat().st_nlink - 2
            if threads > self._limits.threads:
                raise EndedError(f"it had {threads} threads; the limit is {self._limits.threads}")
        files = written = 0
        for folder, _, names in os.walk(self.scratch):
            files += 1 + len(names)
            with suppress(FileNotFoundError):
                written += sum(os.lstat(os.path.join(folder, name)).st_size for name in names)
            if files > _MOST_FILES or written > self._limits.scratch:
                raise EndedError(
                    f"it wrote {files} files with {written} bytes into its scratch folder; "
                    f"the limits are {_MOST_FILES} and {self._limits.scratch}"
                )

    def epitaph(self) -> str:
        """How it ended, once the connection is closed: by itself, by a signal, or not at all."""
        try:
            status = self._process.wait(_FAREWELL)
        except subprocess.TimeoutExpired:
            return "it closed the connection to its process"
        if status >= 0:
            return f"it ended the process that it ran in, with exit status {status}"
        return f"the process that it ran in was ended by {_signal_name(-status)}"

    def end(self) -> str:
        """End it, and return the beginning of what it printed."""
        if self.ended:
            return ""
        _kill(self._process)
        self._output.seek(0)
        printed = self._output.read(4 * _LONGEST_OUTPUT).decode(errors="replace")
        self._clean()
        return plain(printed, _LONGEST_OUTPUT).strip()
