"""Where the competitor's process begins: it confines itself, and only then imports the rest.

Nothing but the standard library is imported before: a thread of NumPy's would be left out.
"""

from __future__ import annotations

import importlib
import socket

from fo_gym.evaluation.competitors.guard.channel import DONE, Channel
from fo_gym.evaluation.competitors.guard.limits import Limits
from fo_gym.evaluation.competitors.guard.sandbox import confine

__all__ = ["main"]


def main(connection: int, memory: int) -> None:
    """Serve one competitor until the connection ends.

    Args:
        connection: file descriptor of the socket to the suite's process.
        memory: file descriptor of the memory that is shared with it.
    """
    channel = Channel(socket.socket(fileno=connection))
    _, bounds = channel.receive()
    missing = confine(Limits(**bounds["limits"]), bounds["readable"], bounds["scratch"], bounds["parent"])
    channel.send(DONE, missing)
    importlib.import_module("fo_gym.evaluation.competitors.guard.server").serve(channel, memory)
