"""The environments that `fo_gym.register` makes: robot and task come with the registration."""

from __future__ import annotations

from fo_gym.envs.single import JointEnv
from fo_gym.envs.vector import JointVectorEnv

__all__ = ["MadeEnv", "MadeVectorEnv"]


class MadeEnv(JointEnv):
    """Flexible joints with friction, on a robot and a task of one's own. See `fo_gym.register`."""


class MadeVectorEnv(JointVectorEnv):
    """`num_envs` copies of MadeEnv in one batch."""
