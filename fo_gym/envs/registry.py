"""The environments there are: one row each, which names it, says what it is for, and registers it with Gymnasium."""

from __future__ import annotations

from dataclasses import dataclass

from gymnasium.envs.registration import register

__all__ = ["ENVIRONMENTS", "Environment", "known_environments"]


@dataclass(frozen=True)
class Environment:
    """A registered environment.

    Attributes:
        id: by which `gymnasium.make` finds it.
        entry_point: "module:Name", where NameEnv is the single and NameVectorEnv the batched environment.
        tags: what it is, for whoever picks some of them: "link" | "arm", and "step" | "path".
    """

    id: str
    entry_point: str
    tags: frozenset[str]


_ROWS = (
    Environment("FJRStiction-v0", "fo_gym.envs.stiction:Stiction", frozenset({"link", "step"})),
    Environment("FJRRegulation-v0", "fo_gym.envs.regulation:Regulation", frozenset({"arm", "step"})),
    Environment("FJRSquare-v0", "fo_gym.envs.square:Square", frozenset({"arm", "path"})),
)

ENVIRONMENTS = {row.id: row for row in _ROWS}
"""Every environment by its id."""

for _row in _ROWS:
    # The environments truncate themselves at `duration`, so that `decimation` does not stretch time.
    register(_row.id, entry_point=f"{_row.entry_point}Env", vector_entry_point=f"{_row.entry_point}VectorEnv")


def known_environments() -> tuple[str, ...]:
    """The environments that can be scored, by their ids."""
    return tuple(ENVIRONMENTS)
