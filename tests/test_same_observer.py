"""Le Tien's observer as a stranger would write it: on every set of episodes it is tied with the project's own."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from tables import REGULATION, STICTION

from fo_gym import ENVIRONMENTS, JointInfo, Signals
from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.results.leaderboard import standings
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.contest import Contest
from fo_gym.evaluation.runs.episodes import EpisodeSet, rows
from fo_gym.evaluation.runs.run import run_contests
from fo_gym.evaluation.runs.trial import reference_trials
from fo_gym.tasks.variants import VARIANTS

SEEDS = (1, 2, 3, 4, 5, 6, 7, 8)
DURATIONS = {STICTION: 2.0, REGULATION: 4.5}
"""Of the episodes here [s]; 3 elsewhere. Regulation steps at 3 s, the others move at once."""

OURS = competitor_of("letien-high")


class MomentumObserver:
    """r = K (B theta' - ∫ (tau_m - tau_j + r) dt), De Luca's residual, of which each tick adds what is new.

    It knows nothing of a nominal motor: what the motor got is what it commanded itself.
    """

    feedback = "measured"

    def __init__(self, K: float = 100.0) -> None:
        self.K = K

    def reset(self, joints: JointInfo, num_envs: int) -> None:
        self.inertia, self.dt = joints.motor_inertia, joints.control_dt
        self.momentum: np.ndarray | None = None

    def estimate(self, signals: Signals) -> np.ndarray:
        momentum = self.inertia * signals.theta_dot
        if self.momentum is None:
            self.residual = np.zeros_like(momentum)
        else:
            gained = momentum - self.momentum - self.dt * (self.driven + self.residual)
            self.residual = self.residual + self.K * gained
        self.momentum = momentum
        self.driven = signals.tau_c - self.residual - signals.tau_j
        return self.residual


class Slower(MomentumObserver):
    """The same with 30 % less bandwidth: no twin of it."""

    def __init__(self) -> None:
        super().__init__(70.0)


def scored(env_id: str, variant: str, *strangers: MomentumObserver) -> pd.DataFrame:
    """Rows of ours and of the strangers."""
    episodes = EpisodeSet(env_id, variant, SEEDS, {"duration": DURATIONS.get(env_id, 3.0)})
    references, *_ = reference_trials(episodes)
    ours = run_contests([Contest(episodes, (OURS,))], "", backend=Processes(1)).episodes
    theirs = []
    for stranger in strangers:
        name = type(stranger).__name__
        theirs.append(rows(episodes, name, episodes.record(stranger, name), references, stranger))
    return pd.concat([ours, *theirs], ignore_index=True)


def assert_tied(env_id: str, variant: str) -> None:
    table = scored(env_id, variant, MomentumObserver())
    found = standings(table).set_index("compensator")
    assert set(found.index) == {"letien-high", "MomentumObserver"}
    assert found["verdict"].isin(["best", "tied"]).all()
    assert found["tied_group"].tolist() == ["a", "a"]
    frr = table.pivot(index="seed", columns="compensator", values="frr")
    assert (frr["MomentumObserver"] != frr["letien-high"]).any()  # another program, other last bits


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_stranger_is_tied_on_the_single_link(variant: str) -> None:
    assert_tied(STICTION, variant)


@pytest.mark.slow
@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("env_id", [env_id for env_id in ENVIRONMENTS if env_id != STICTION])
def test_a_stranger_is_tied_on_the_arm(env_id: str, variant: str) -> None:
    assert_tied(env_id, variant)


def test_another_observer_is_not_tied() -> None:
    """Else the test above could not fail."""
    found = standings(scored(STICTION, "randomized", MomentumObserver(), Slower())).set_index("compensator")
    verdicts = found["verdict"]
    assert verdicts["Slower"] == "behind"
    assert sorted(verdicts.drop("Slower")) == ["best", "tied"]
