"""Messages between the two processes: a letter, and JSON. Nothing that comes is unpickled, or longer than agreed."""

from __future__ import annotations

import json
import socket
import struct
from collections.abc import Callable
from typing import Any

CONFINE, MAKE, DECLARE, RESET, BEGIN, TICK = b"C", b"M", b"G", b"R", b"B", b"T"
"""What is asked: give up what is not needed; make the competitor; name its gains; start episodes; expect these sizes;
estimate from what lies in the memory."""

DONE, RAISED, SHAPE = b"D", b"E", b"S"
"""What is answered: it is done; it raised; the estimate has this shape, which is a wrong one."""

LONGEST_ANSWER = 1 << 20
"""Bytes of an answer that are read."""

_HEAD = struct.Struct("<cI")

__all__ = [
    "BEGIN",
    "CONFINE",
    "DECLARE",
    "DONE",
    "LONGEST_ANSWER",
    "MAKE",
    "RAISED",
    "RESET",
    "SHAPE",
    "TICK",
    "Channel",
    "ChannelError",
]


class ChannelError(RuntimeError):
    """What came is no message; the text says why."""


def _silence() -> None:
    """Reading waits by itself."""


class Channel:
    """One end of a connection.

    Args:
        connection: a stream socket.
        longest: bytes of a message that are accepted; None = any number.
        wait: called before every read: it returns when there is something to read, or raises.
    """

    def __init__(
        self, connection: socket.socket, longest: int | None = None, wait: Callable[[], None] = _silence
    ) -> None:
        self._connection = connection
        self._longest = longest
        self._wait = wait

    def send(self, letter: bytes, content: Any = None) -> None:
        """Send a message; what JSON does not know raises TypeError or ValueError."""
        body = b"" if content is None else json.dumps(content).encode()
        self._connection.sendall(_HEAD.pack(letter, len(body)) + body)

    def receive(self) -> tuple[bytes, Any]:
        """The next message, None where it has no content. Raises EOFError at the end, ChannelError for what is none."""
        letter, length = _HEAD.unpack(self._exactly(_HEAD.size))
        if self._longest is not None and length > self._longest:
            raise ChannelError(f"it sent {length} bytes; {self._longest} are allowed")
        if not length:
            return letter, None
        try:
            return letter, json.loads(self._exactly(length))
        except (ValueError, RecursionError) as error:
            raise ChannelError(f"it sent what is no JSON: {error}") from error

    def _exactly(self, length: int) -> bytes:
        parts = b""
        while len(parts) < length:
            self._wait()
            part = self._connection.recv(length - len(parts))
            if not part:
                raise EOFError
            parts += part
        return parts
