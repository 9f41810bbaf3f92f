"""What arXiv:1907.00553 says, statement by statement. Importing this registers them."""

from fo_gym.reproduction.claim import CLAIMS

# In the order of the table.
# isort: off
from fo_gym.reproduction.claims import panels
from fo_gym.reproduction.claims import rest
from fo_gym.reproduction.claims import arm_rest
from fo_gym.reproduction.claims import stiction
from fo_gym.reproduction.claims import lowpass
from fo_gym.reproduction.claims import algebra
from fo_gym.reproduction.claims import theorem2
from fo_gym.reproduction.claims import passivity
from fo_gym.reproduction.claims import model_based
from fo_gym.reproduction.claims import regulation
from fo_gym.reproduction.claims import square
from fo_gym.reproduction.claims import tracking
from fo_gym.reproduction.claims import interaction
# isort: on

__all__ = [
    "CLAIMS",
    "algebra",
    "arm_rest",
    "interaction",
    "lowpass",
    "model_based",
    "panels",
    "passivity",
    "regulation",
    "rest",
    "square",
    "stiction",
    "theorem2",
    "tracking",
]
