"""The certificate: checks of the physics against what is known apart from it. Importing this registers them."""

from fo_gym.certificate.statement import CHECKS

# In the order of the table.
# isort: off
from fo_gym.certificate.fidelity import lugre
from fo_gym.certificate.fidelity import solver
from fo_gym.certificate.fidelity import twin
from fo_gym.certificate.fidelity import energy
from fo_gym.certificate.fidelity import rest
from fo_gym.certificate.fidelity import sensitivity
from fo_gym.certificate.fidelity import laws
# isort: on

__all__ = ["CHECKS", "energy", "laws", "lugre", "rest", "sensitivity", "solver", "twin"]
