"""MuJoCo's messages: to the terminal, not into a file of whatever folder a program happens to run in."""

from __future__ import annotations

import mujoco

_DEFAULT_FILE = "MUJOCO_LOG.TXT"

__all__ = ["keep_off_disk"]


def keep_off_disk() -> None:
    """Have MuJoCo write no log file, in this process; one that somebody chose by its name stays."""
    log = mujoco.MjLogConfig.get()
    if log.logfile == _DEFAULT_FILE:
        log.logto_file = False
        log.set()
