"""Friction laws as a user writes them, in a file of his own."""

import math
from dataclasses import dataclass

import numpy as np

from fo_gym.friction import BristleLaw, FrictionLaw, Levels


def smooth_sign(v, p):
    """What a smooth law has for the sign of the velocity."""
    return math.tanh(v / p.width)


def respond(v, z, h, p, memory):
    """Friction near v as a line: its value there and its slope."""
    s = smooth_sign(v, p)
    slope = p.f_c * (1.0 - s * s) / p.width
    return p.f_c * s - slope * v, slope + p.sigma_2


def step(v, z, h, p, memory):
    """There is no state to move."""
    return -(p.f_c * smooth_sign(v, p) + p.sigma_2 * v)


@dataclass(frozen=True)
class SmoothCoulomb(FrictionLaw):
    """tau_f = -(f_c tanh(v / width) + sigma_2 v): never sticks."""

    f_c: float = 1.0
    width: float = 0.01
    sigma_2: float = 0.4

    levels = Levels(coulomb="f_c", viscous="sigma_2")
    states = 0
    respond = staticmethod(respond)
    step = staticmethod(step)

    def equations(self, v, z):
        """As it is written."""
        return np.empty(0), step(v, z, 0.0, self, None)

    def steady(self, v):
        """The same at any constant velocity."""
        return -(self.f_c * np.tanh(np.asarray(v) / self.width) + self.sigma_2 * np.asarray(v))

    @classmethod
    def like(cls, lugre):
        """With the same Coulomb and viscous friction."""
        return cls(f_c=lugre.f_c, sigma_2=lugre.sigma_2)


@dataclass(frozen=True)
class Sharp(BristleLaw):
    """A bristle that slips by the square of what it bears: one function says it all."""

    sigma_0: float = 1e5
    sigma_1: float = 300.0
    sigma_2: float = 0.4
    f_c: float = 1.0

    levels = Levels(coulomb="f_c", stiffness="sigma_0", damping="sigma_1", viscous="sigma_2")

    @staticmethod
    def rate(v, z, p):
        """Share of the load squared, where the bristle is bent forward."""
        load = p.sigma_0 * z / p.f_c
        return p.sigma_0 * abs(v) / p.f_c * abs(load) if z * v > 0.0 else 0.0

    def steady(self, v):
        """Coulomb and viscous friction."""
        return -(np.sign(v) * self.f_c + self.sigma_2 * np.asarray(v))
