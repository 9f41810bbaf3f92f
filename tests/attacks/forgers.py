"""Competitors that speak for themselves on the connection to the suite's process."""

import gc
import os

from attacks.endings import Ending


def of_class(name):
    return next(thing for thing in gc.get_objects() if type(thing).__name__ == name)


class Forger(Ending):
    """Does its deed at the third tick."""

    def end(self):
        self.forge(of_class("Channel"), of_class("_Server"))


class Early(Forger):
    """Answers the next tick before it is asked, many times."""

    def forge(self, channel, server):
        for _ in range(1000):
            channel.send(b"D")


class Flood(Forger):
    """More than any buffer holds."""

    def forge(self, channel, server):
        channel.send(b"D", 10_000_000 * "x")


class Garbage(Forger):
    def forge(self, channel, server):
        channel._connection.sendall(b"D\x05\x00\x00\x00\xff\xfe{[,")


class Long(Forger):
    def forge(self, channel, server):
        channel._connection.sendall(b"D\xff\xff\xff\xff")


class Deep(Forger):
    def forge(self, channel, server):
        channel._connection.sendall(b"D\x60\xea\x00\x00" + 60_000 * b"[")


class Stranger(Forger):
    """Another letter."""

    def forge(self, channel, server):
        channel.send(b"?")


class Nowhere(Forger):
    """The shape of no array."""

    def forge(self, channel, server):
        channel.send(b"S", [-1, "x"])


class Nobody(Forger):
    """An error that is none."""

    def forge(self, channel, server):
        channel.send(b"E", [{"kind": 3}])


class Short(Forger):
    """Takes the memory away from under the suite."""

    def forge(self, channel, server):
        os.ftruncate(server._memory, 0)
        channel.send(b"D")
        os._exit(0)


class Poet:
    """Says it is made, with a feedback of its own."""

    def __init__(self):
        of_class("Channel").send(b"D", {"feedback": ["measured"]})
