"""The environments as learning agents like them: `AgentView`, also of batches, and its policies as compensators.

As in Gymnasium, `fo_gym.wrappers` is for single environments and `fo_gym.wrappers.vector` for vector environments.
"""

from fo_gym.wrappers import vector
from fo_gym.wrappers.compensator import AgentCompensator
from fo_gym.wrappers.single import AgentView

__all__ = ["AgentCompensator", "AgentView", "vector"]
