"""Effects of one's own, that tests add to a robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fo_gym.hardware import Effect


@dataclass(frozen=True)
class Drift(Effect):
    """A torque sensor whose zero drifts, at a rate per episode, and is set anew now and then, a little wrong."""

    largest: float = 0.5
    period: float = 5e-3
    noisy = True

    def draw(self, dof, generator):
        return {"rate": generator.uniform(-self.largest, self.largest, dof)}

    def begin(self, episodes):
        return {"zero": np.zeros_like(episodes.truth.tau_j), "since": np.zeros_like(episodes.time)}

    def measure(self, readings, episodes):
        memory = episodes.memory
        due = episodes.time >= memory["since"] + self.period - 1e-9
        memory["zero"] = np.where(due, 0.01 * episodes.standard_normal(), memory["zero"])
        memory["since"] = np.where(due, episodes.time, memory["since"])
        drift = episodes.drawn["rate"] * (episodes.time - memory["since"]) + memory["zero"]
        return readings._replace(tau_j=readings.tau_j + drift)


@dataclass(frozen=True)
class Weak(Effect):
    """Motors that give a share of what they are told."""

    share: float

    def command(self, tau_m, episodes):
        return self.share * tau_m


def replace_name(effect, name):
    """The effect under another name."""
    return type(name, (type(effect),), {})(**vars(effect))
