"""A competitor that tries to get out of its process; it raises with the names of the ways that were open."""

import ctypes
import fcntl
import os
import resource
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np

PARENT = os.getppid()
LIBC = ctypes.CDLL(None, use_errno=True)


def refused(result):
    """Raises OSError where a call of the C library did not succeed."""
    if result < 0:
        raise OSError(ctypes.get_errno(), "refused")


def fork():
    child = os.fork()
    if child == 0:
        os._exit(0)
    os.waitpid(child, 0)


def spawn():
    subprocess.run([sys.executable, "-c", ""], check=True)


def signal_parent():
    os.kill(PARENT, 0)


def signal_by_handle():
    os.close(os.pidfd_open(PARENT))


def signal_by_file():
    reading, writing = os.pipe()
    try:
        fcntl.fcntl(reading, fcntl.F_SETOWN, PARENT)
    finally:
        os.close(reading)
        os.close(writing)


def trace_parent():
    refused(LIBC.ptrace(0x4206, PARENT, 0, 0))  # PTRACE_SEIZE


def read_parent():
    Path(f"/proc/{PARENT}/mem").open("rb").close()


def parents_environment():
    Path(f"/proc/{PARENT}/environ").read_bytes()


def parents_files():
    os.listdir(f"/proc/{PARENT}/fd")


def parents_command():
    Path(f"/proc/{PARENT}/cmdline").read_bytes()


def limit_parent():
    resource.prlimit(PARENT, resource.RLIMIT_CORE, resource.prlimit(PARENT, resource.RLIMIT_CORE))


def unlimit():
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))


def outlive_parent():
    refused(LIBC.prctl(1, 0, 0, 0, 0))  # PR_SET_PDEATHSIG


def hurry():
    refused(LIBC.setpriority(0, 0, 1))


def connect():
    socket.socket().close()


def connect_here():
    socket.socketpair()[0].close()


def hidden_memory():
    os.close(os.memfd_create("hidden"))


class Escapist:
    """Tries all of it when it is made, and the ways into files that it is given.

    Args:
        folder: of the suite, not its own: holds secret.txt, which is also what it would change.
        token: a variable of the environment.
    """

    feedback = "measured"

    def __init__(self, folder, token):
        secret = Path(folder[0]) / "secret.txt"
        ways = [
            *(fork, spawn, signal_parent, signal_by_handle, signal_by_file, trace_parent, read_parent),
            *(parents_environment, parents_files, parents_command, limit_parent, unlimit, outlive_parent, hurry),
            *(connect, connect_here, hidden_memory),
        ]
        files = {
            "read": secret.read_text,
            "list": lambda: os.listdir(secret.parent),
            "write": lambda: secret.with_name("written").write_text("x"),
            "write beside itself": lambda: Path(__file__).with_name("written").write_text("x"),
            "append": lambda: secret.open("a").close(),
            "rename": lambda: secret.rename(secret),
            "folder": lambda: secret.with_name("folder").mkdir(),
            "link": lambda: os.link(secret, os.path.join(os.environ["TMPDIR"], "linked")),
            "truncate": lambda: os.truncate(secret, 0),
            "mode": lambda: secret.chmod(0o600),
            "owner": lambda: os.chown(secret, os.getuid(), -1),
            "time": lambda: os.utime(secret),
            "environment": lambda: os.environ[token],
            "remove": secret.unlink,
            "home": lambda: os.listdir(os.path.expanduser("~root")),
        }
        open_ones = []
        for name, way in {**{way.__name__: way for way in ways}, **files}.items():
            try:
                way()
            except (OSError, KeyError, ValueError, BlockingIOError):
                continue
            open_ones.append(name)
        if open_ones:
            raise RuntimeError(f"open: {', '.join(open_ones)}")

    def reset(self, joints, num_envs):
        own = Path(os.environ["TMPDIR"]) / "own"
        own.mkdir()
        (own / "file").write_text("what is its own it may write")

    def estimate(self, signals):
        return np.zeros_like(signals.theta)
