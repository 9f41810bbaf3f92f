"""A filter of system calls (seccomp, Linux): what no compensator needs is refused, for good.

Refused are other processes (starting, signalling, tracing, reading them), sockets, memory that no limit counts, the
rights and times of files, and the settings of the machine. See seccomp(2); the numbers are those of asm/unistd.h.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import struct

_ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}

# Name and number, x86_64 then aarch64, 0 where there is none.
_REFUSED = """
execve 59 221, execveat 322 281, fork 57 0, vfork 58 0, unshare 272 97, setns 308 268, ptrace 101 117,
process_vm_readv 310 270, process_vm_writev 311 271, process_madvise 440 440, process_mrelease 448 448, kcmp 312 272,
migrate_pages 256 238, move_pages 279 239, tkill 200 130, rt_sigqueueinfo 129 138, rt_tgsigqueueinfo 297 240,
pidfd_open 434 434, pidfd_getfd 438 438, pidfd_send_signal 424 424,
socket 41 198, socketpair 53 199, connect 42 203, bind 49 200, listen 50 201, accept 43 202, accept4 288 242,
io_uring_setup 425 425, io_uring_enter 426 426, io_uring_register 427 427, bpf 321 280, perf_event_open 298 241,
userfaultfd 323 282, add_key 248 217, request_key 249 218, keyctl 250 219,
mount 165 40, umount2 166 39, pivot_root 155 41, chroot 161 51, move_mount 429 429, open_tree 428 428, fsopen 430 430,
fsconfig 431 431, fsmount 432 432, fspick 433 433, mount_setattr 442 442, quotactl 179 60, quotactl_fd 443 443,
swapon 167 224, swapoff 168 225, reboot 169 142, kexec_load 246 104, kexec_file_load 320 294, init_module 175 105,
finit_module 313 273, delete_module 176 106, acct 163 89, syslog 103 116, personality 135 92, sethostname 170 161,
setdomainname 171 162, settimeofday 164 170, clock_settime 227 112, clock_adjtime 305 266, adjtimex 159 171,
setrlimit 160 164, setpriority 141 140, ioprio_set 251 30, sched_setscheduler 144 119, sched_setparam 142 118,
sched_setattr 314 274, iopl 172 0, ioperm 173 0, modify_ldt 154 0, uselib 134 0, vhangup 153 58,
shmget 29 194, shmat 30 196, semget 64 190, msgget 68 186, mq_open 240 180, memfd_create 319 279, memfd_secret 447 447,
open_by_handle_at 304 265, name_to_handle_at 303 264, fanotify_init 300 262, truncate 76 45,
chmod 90 0, fchmod 91 52, fchmodat 268 53, fchmodat2 452 452, chown 92 0, lchown 94 0, fchown 93 55, fchownat 260 54,
utime 132 0, utimes 235 0, futimesat 261 0, utimensat 280 88, setxattr 188 5, lsetxattr 189 6, fsetxattr 190 7,
removexattr 197 14, lremovexattr 198 15, fremovexattr 199 16
"""
_FIRST_UNKNOWN = 463
"""Calls that are newer than this list (Linux 6.12) are refused as if the kernel were older."""

_WATCHED = {
    "x86_64": {
        "clone": 56,
        "clone3": 435,
        "kill": 62,
        "tgkill": 234,
        "prctl": 157,
        "limits": 302,
        "fcntl": 72,
        "ioctl": 16,
    },
    "aarch64": {
        "clone": 220,
        "clone3": 435,
        "kill": 129,
        "tgkill": 131,
        "prctl": 167,
        "limits": 261,
        "fcntl": 25,
        "ioctl": 29,
    },
}
"""Calls of which some uses are refused."""
_CLONE_THREAD = 0x10000
_PARENT_DEATH_SIGNAL = 1
_SIGNALS_BY_FILE = (8, 10, 15)  # F_SETOWN, F_SETSIG, F_SETOWN_EX
_PIPE_SIZE = 1031  # F_SETPIPE_SZ
_TERMINAL = (0x8901, 0x8902, 0x5412, 0x541C)  # FIOSETOWN, SIOCSPGRP; TIOCSTI, TIOCLINUX type for the user

# Instructions of classic BPF, and what a filter answers.
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _ANSWER = 0x20, 0x15, 0x35, 0x45, 0x06
_ALLOW, _KILL_PROCESS, _ERROR = 0x7FFF0000, 0x80000000, 0x00050000
_NUMBER, _ARCHITECTURE, _ARGUMENTS = 0, 4, 16
_PR_SET_SECCOMP, _MODE_FILTER = 22, 2

Instruction = tuple[int, int, int, int]
"""Code, how many instructions to skip where it holds and where not, operand."""

__all__ = ["install"]


def _answer(value: int) -> Instruction:
    return _ANSWER, 0, 0, value


_REFUSE, _PASS = _answer(_ERROR | errno.EPERM), _answer(_ALLOW)
_UNKNOWN = _answer(_ERROR | errno.ENOSYS)


def _argument(i: int) -> Instruction:
    """Load the lower half of argument i; machines here are little-endian."""
    return _LOAD, 0, 0, _ARGUMENTS + 8 * i


def _where(values: tuple[int, ...], then: Instruction) -> list[Instruction]:
    """`then` where the loaded number is one of the values."""
    return [part for value in values for part in ((_EQUAL, 0, 1, value), then)]


def _unless(code: int, value: int) -> list[Instruction]:
    return [(code, 1, 0, value), _REFUSE]


def _watched(pid: int) -> dict[str, list[Instruction]]:
    """What decides about the calls that are allowed in part, by their name."""
    upper = (_LOAD, 0, 0, _ARGUMENTS + 8 * 2 + 4)
    itself = [_argument(0), *_unless(_EQUAL, pid)]
    return {
        "clone": [_argument(0), *_unless(_ANY_BIT, _CLONE_THREAD)],
        "clone3": [_UNKNOWN],  # its flags lie in memory, out of sight; libraries then take clone
        "kill": itself,
        "tgkill": itself,
        "prctl": [_argument(0), *_where((_PARENT_DEATH_SIGNAL,), _REFUSE)],
        "limits": [_argument(2), *_unless(_EQUAL, 0), upper, *_unless(_EQUAL, 0)],  # may be read, not set
        "fcntl": [_argument(1), *_where((*_SIGNALS_BY_FILE, _PIPE_SIZE), _REFUSE)],
        "ioctl": [_argument(1), *_where(_TERMINAL, _REFUSE)],
    }


def _program(machine: str, pid: int) -> bytes:
    column = 1 + list(_ARCHITECTURES).index(machine)
    numbers = (int(entry.split()[column]) for entry in _REFUSED.split(","))
    program = [(_LOAD, 0, 0, _ARCHITECTURE), (_EQUAL, 1, 0, _ARCHITECTURES[machine]), _answer(_KILL_PROCESS)]
    program += [(_LOAD, 0, 0, _NUMBER), (_AT_LEAST, 0, 1, _FIRST_UNKNOWN), _UNKNOWN]
    program += _where(tuple(number for number in numbers if number), _REFUSE)
    for name, decision in _watched(pid).items():
        block = [*decision, _PASS]
        program += [(_EQUAL, 0, len(block), _WATCHED[machine][name]), *block]
    return b"".join(struct.pack("<HBBI", *instruction) for instruction in (*program, _PASS))


class _Filter(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("program", ctypes.c_char_p))


def install() -> None:
    """Filter the calls of this thread and of those that it starts. It needs no_new_privs.

    Raises:
        OSError: the processor is not in the list, or the kernel has no such filters.
    """
    machine = platform.machine()
    if machine not in _ARCHITECTURES:
        raise OSError(errno.ENOSYS, f"no list of system calls for {machine}")
    program = _program(machine, os.getpid())
    filters = _Filter(len(program) // 8, program)
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(_PR_SET_SECCOMP, _MODE_FILTER, ctypes.byref(filters), 0, 0) != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
