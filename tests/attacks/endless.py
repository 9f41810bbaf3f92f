"""Competitors that never come back."""

import signal

import numpy as np


class Loop:
    """Catches whatever it can."""

    feedback = "measured"

    def reset(self, joints, num_envs):
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGALRM, signal.SIGXCPU):
            signal.signal(number, signal.SIG_IGN)

    def estimate(self, signals):
        while True:
            try:
                while True:
                    pass
            except BaseException:
                pass


class LoopInReset(Loop):
    def reset(self, joints, num_envs):
        self.estimate(None)


class Slow(Loop):
    """Each tick in time, all of them not."""

    def estimate(self, signals):
        signal.sigtimedwait([], 0.03)
        return np.zeros_like(signals.theta)
