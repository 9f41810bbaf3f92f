"""Landlock (Linux 5.13 and later): which files this process may read and write, for good.

It also keeps a process from the memory and the environment of those that are not confined with it. See landlock(7);
the numbers are those of linux/landlock.h.
"""

from __future__ import annotations

import ctypes
import os
import stat
import struct
from collections.abc import Iterable
from contextlib import suppress

_CREATE, _ADD, _RESTRICT = 444, 445, 446  # the same on every architecture
_VERSION, _PATH_BENEATH = 1, 1

_WRITE_FILE, _READ_FILE, _READ_DIR, _REMOVE_DIR, _REMOVE_FILE = (1 << bit for bit in range(1, 6))
_MAKE_DIR, _MAKE_FILE, _TRUNCATE = 1 << 7, 1 << 8, 1 << 14
_READ = _READ_FILE | _READ_DIR
_WRITE = _READ | _WRITE_FILE | _REMOVE_DIR | _REMOVE_FILE | _MAKE_DIR | _MAKE_FILE | _TRUNCATE
_ON_FILES = _READ_FILE | _WRITE_FILE | _TRUNCATE

_FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 5: 16}
"""How many rights on files there are, by the version that has them first."""
_NETWORK_FROM, _NETWORK_RIGHTS = 4, 0b11
_SCOPES_FROM, _SCOPES = 6, 0b11
"""Signals, and abstract sockets, to processes outside."""

__all__ = ["restrict"]


def _call(number: int, *arguments: object) -> int:
    result = ctypes.CDLL(None, use_errno=True).syscall(number, *arguments)
    if result < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return int(result)


def restrict(readable: Iterable[str], writable: str) -> None:
    """Leave this thread, and those that it starts, the right to read below some paths and to write below one.

    Nothing else may be read, written or run; no port used; no process outside signalled, as far as the kernel has it.

    Args:
        readable: files and folders; those that are not there count for nothing.
        writable: a folder.

    Raises:
        OSError: the kernel has no Landlock, or it is switched off.
    """
    version = _call(_CREATE, None, ctypes.c_size_t(0), _VERSION)
    handled = (1 << max(count for since, count in _FILE_RIGHTS.items() if since <= version)) - 1
    network, scopes = _NETWORK_RIGHTS * (version >= _NETWORK_FROM), _SCOPES * (version >= _SCOPES_FROM)
    attributes = struct.pack("<QQQ", handled, network, scopes)
    known = 8 * (1 + (version >= _NETWORK_FROM) + (version >= _SCOPES_FROM))
    rules = _call(_CREATE, attributes, ctypes.c_size_t(known), 0)
    try:
        for path in readable:
            with suppress(FileNotFoundError, NotADirectoryError, PermissionError):
                _allow(rules, path, _READ)
        _allow(rules, os.devnull, _READ_FILE | _WRITE_FILE)
        _allow(rules, writable, _WRITE & handled)
        _call(_RESTRICT, rules, 0)
    finally:
        os.close(rules)


def _allow(rules: int, path: str, rights: int) -> None:
    file = os.open(path, os.O_PATH | os.O_CLOEXEC)
    try:
        if not stat.S_ISDIR(os.fstat(file).st_mode):
            rights &= _ON_FILES
        _call(_ADD, rules, _PATH_BENEATH, struct.pack("<Qi", rights, file), 0)
    finally:
        os.close(file)
