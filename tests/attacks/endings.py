"""Competitors that try to take the run with them when they go."""

import ctypes
import os
import signal
import sys

import numpy as np


class Ending:
    """Works for two ticks."""

    feedback = "measured"

    def reset(self, joints, num_envs):
        self.tick = -1

    def estimate(self, signals):
        self.tick += 1
        if self.tick == 2:
            self.end()
        return np.zeros_like(signals.theta)


class ByGeneratorExit(Ending):
    def end(self):
        raise GeneratorExit("bye")


class ByInterrupt(Ending):
    def end(self):
        raise KeyboardInterrupt


class ByExit(Ending):
    def end(self):
        sys.exit("usage")


class ByExitOfTheProcess(Ending):
    def end(self):
        os._exit(3)


class ByClosing(Ending):
    """Closes all files."""

    def end(self):
        os.closerange(0, 256)


class ByCrash(Ending):
    def end(self):
        ctypes.string_at(0)


class ByRecursion(Ending):
    """Deeper than the stack of the machine."""

    def end(self):
        sys.setrecursionlimit(1 << 30)
        np.asarray(Nested(), dtype=np.float64)


class Nested:
    """An array of arrays without end."""

    def __len__(self):
        return 1

    def __getitem__(self, i):
        return repr(self)

    def __repr__(self):
        return repr(self)


class ByAlarm(Ending):
    def end(self):
        os.kill(os.getpid(), signal.SIGALRM)


class LongWords(Ending):
    """Its error is long, and speaks to the terminal."""

    def end(self):
        raise RuntimeError("\x1b[2J\x07| <img> =1+1" + 100_000 * "!")


class MuteError(Exception):
    def __str__(self):
        raise SystemExit


class ByMuteError(Ending):
    def end(self):
        raise MuteError


class Fraction(Ending):
    """Returns what is no number."""

    def estimate(self, signals):
        return np.full_like(signals.theta, np.nan)


class Wide(Ending):
    def estimate(self, signals):
        return np.zeros((*signals.theta.shape, 10**6))


class Words(Ending):
    def estimate(self, signals):
        return [["much"]]
