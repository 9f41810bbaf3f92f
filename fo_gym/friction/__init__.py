"""Friction laws of the motors, one file each, and the seam that a law of one's own goes through."""

from fo_gym.friction.bristle import BristleLaw
from fo_gym.friction.dahl import Dahl
from fo_gym.friction.elasto_plastic import ElastoPlastic
from fo_gym.friction.law import FrictionLaw, Levels
from fo_gym.friction.lugre import FRICTIONLESS, LuGre
from fo_gym.friction.maxwell_slip import MaxwellSlip
from fo_gym.friction.named import LAWS, law_class, law_name

__all__ = [
    "FRICTIONLESS",
    "LAWS",
    "BristleLaw",
    "Dahl",
    "ElastoPlastic",
    "FrictionLaw",
    "Levels",
    "LuGre",
    "MaxwellSlip",
    "law_class",
    "law_name",
]
