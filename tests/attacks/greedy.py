"""Competitors that want all of the machine."""

import tempfile
import threading

import numpy as np


class Greedy:
    feedback = "measured"

    def reset(self, joints, num_envs):
        pass

    def estimate(self, signals):
        self.take()
        return np.zeros_like(signals.theta)


class Memory(Greedy):
    def take(self):
        blocks = []
        while True:
            blocks.append(bytearray(1 << 26))


class Threads(Greedy):
    def take(self):
        never = threading.Event()
        threading.stack_size(1 << 16)
        for _ in range(100):
            threading.Thread(target=never.wait, daemon=True).start()
        never.wait()


class Files(Greedy):
    """Many files, each of them small enough."""

    def take(self):
        for _ in range(40):
            with tempfile.NamedTemporaryFile(delete=False) as file:
                file.write(bytes(1 << 19))
        threading.Event().wait()


class File(Greedy):
    def take(self):
        with tempfile.TemporaryFile() as file:
            file.write(bytes(1 << 25))
            file.flush()


class Chatter(Greedy):
    def take(self):
        while True:
            print(1000 * "\x1b[31mchatter")
