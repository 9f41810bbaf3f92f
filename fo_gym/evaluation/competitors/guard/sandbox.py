"""What the competitor's process gives up before a stranger's code is imported, for good."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import struct
from collections.abc import Callable, Iterable

from fo_gym.evaluation.competitors.guard import landlock, seccomp
from fo_gym.evaluation.competitors.guard.limits import Limits

_OPEN_FILES = 256
_SET_PARENT_DEATH_SIGNAL, _SET_NO_NEW_PRIVILEGES = 1, 38  # of prctl(2)
_CAPABILITIES_VERSION, _READ_EVERY_FILE = 0x20080522, 1 << 2  # of capabilities(7)

__all__ = ["confine"]


def _prctl(option: int, value: int) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(option, value, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def _end_with(parent: int) -> None:
    """Be killed when the parent ends, however it ends."""
    _prctl(_SET_PARENT_DEATH_SIGNAL, signal.SIGKILL)
    if os.getppid() != parent:  # it ended before that was said
        os._exit(1)


def _limit(limits: Limits) -> None:
    """Bounds that the system keeps. The parent keeps those of time and threads; the processor's time is a backstop."""
    seconds = int(limits.making + limits.run) * (os.cpu_count() or 1)
    bounds = {
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_CPU: seconds + 1,
        resource.RLIMIT_FSIZE: limits.scratch,
        resource.RLIMIT_NOFILE: _OPEN_FILES,
        resource.RLIMIT_AS: limits.memory,
    }
    for kind, most in bounds.items():
        hard = resource.getrlimit(kind)[1]
        bound = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (bound, bound))


def _drop_capabilities() -> None:
    """Leave what makes root more than a user, but for reading: Landlock says what may be read."""
    libc = ctypes.CDLL(None, use_errno=True)
    head, data = struct.pack("<Ii", _CAPABILITIES_VERSION, 0), ctypes.create_string_buffer(24)
    if libc.capget(head, data) == 0:
        permitted = struct.unpack("<6I", data.raw)[1] & _READ_EVERY_FILE
        if libc.capset(head, struct.pack("<6I", permitted, permitted, 0, 0, 0, 0)) == 0:
            return
    raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def _check_alone() -> None:
    """Raise RuntimeError where there are threads already: Landlock would not bind them."""
    tasks = "/proc/self/task"
    if os.path.isdir(tasks) and len(os.listdir(tasks)) > 1:
        raise RuntimeError("something was imported too early: there are threads that cannot be confined")


def confine(limits: Limits, readable: Iterable[str], scratch: str, parent: int) -> list[str]:
    """Give up what no compensator needs.

    Args:
        limits: what may be used.
        readable: files and folders that may be read.
        scratch: the folder that may be written.
        parent: id of the process to end with.

    Returns:
        Names of the protections that this system does not have.
    """

    def landlocked() -> None:
        _prctl(_SET_NO_NEW_PRIVILEGES, 1)
        landlock.restrict(readable, scratch)

    protections: dict[str, Callable[[], None]] = {
        "end with the parent": lambda: _end_with(parent),
        "limits of memory and files": lambda: _limit(limits),
        "fewer capabilities": _drop_capabilities,
        "Landlock": landlocked,
        "seccomp": seccomp.install,
    }
    _check_alone()
    missing = []
    for name, set_up in protections.items():
        try:
            set_up()
        except (OSError, AttributeError, ValueError):  # AttributeError: the C library has no such call
            missing.append(name)
    return missing
