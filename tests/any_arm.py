"""What any arm has to do in every task, by its file alone, for the tests of arms that come in packages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import gymnasium as gym
import numpy as np
import pandas as pd
from environments import GYMNASIUM_TOLERATED, told_by
from gymnasium.utils.env_checker import check_env

from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.contest import Contest
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.run import run_contests
from fo_gym.specs import BUILT_IN, list_compensators

TASKS = ("FJRRegulation-v0", "FJRSquare-v0")
INTERACTION = "FJRInteraction-v0"
CLASSICAL = tuple(name for name in list_compensators() if name not in BUILT_IN and not name.startswith("rl-"))


def check_interface(path: Path, env_id: str) -> None:
    """Gymnasium's own checks, and every environment of a batch as it is alone, to the bit."""
    short = {"robot": str(path), "duration": 0.2, "variant": "randomized"}
    env = gym.make(env_id, **short)
    assert told_by(check_env, env.unwrapped) <= GYMNASIUM_TOLERATED
    envs = gym.make_vec(env_id, num_envs=2, **short)
    batch, _ = envs.reset(seed=5)
    alone = [gym.make(env_id, **short).unwrapped for _ in range(2)]
    for i, each in enumerate(alone):
        np.testing.assert_array_equal(each.reset(seed=5 + i)[0], batch[i])
    for k in range(50):
        action = 0.1 * envs.single_action_space.high * np.sin(0.3 * k)
        batch, reward, *_ = envs.step(np.tile(action, (2, 1)))
        for i, each in enumerate(alone):
            obs, own, *_ = each.step(action)
            np.testing.assert_array_equal(obs, batch[i])
            assert own == reward[i]


def scores(path: Path, env_id: str, names: Sequence[str]) -> pd.DataFrame:
    """The nominal rows of these compensators, by their names."""
    episodes = EpisodeSet(env_id, "nominal", (1_000_000_000,), {"robot": str(path)})
    contest = Contest(episodes, tuple(competitor_of(name) for name in names))
    return run_contests([contest], "", backend=Processes(1)).episodes.set_index("compensator")
