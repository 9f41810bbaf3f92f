"""The certificate: checks of the physics against what is known apart from it. Importing this registers them."""

from fo_gym.reproduction.statement import CHECKS

# In the order of the table.
# isort: off
from fo_gym.reproduction.fidelity import lugre
from fo_gym.reproduction.fidelity import solver
from fo_gym.reproduction.fidelity import twin
from fo_gym.reproduction.fidelity import energy
from fo_gym.reproduction.fidelity import rest
from fo_gym.reproduction.fidelity import sensitivity
# isort: on

__all__ = ["CHECKS", "energy", "lugre", "rest", "sensitivity", "solver", "twin"]
