"""What a process of its own costs a competitor: the same class, in this process and in one of its own, by turns.

Run it on a machine that does nothing else: .venv/bin/python docs/guard.py
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np

import baselines.kim2019
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.runs.episodes import EpisodeSet
from fo_gym.evaluation.runs.seeds import VALIDATION_SEEDS, first

ROUNDS = 5
SECONDS = 4.0
EPISODES = 20


def main() -> None:
    """Time both on the environments with one joint and with seven."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "copied.py"
        file.write_bytes(Path(baselines.kim2019.__file__).read_bytes())
        pair = Competitor("ours", "pid-high"), Competitor("guarded", f"{file}:pid_high")
        for env_id in ("FJRStiction-v0", "FJRRegulation-v0"):
            episodes = EpisodeSet(env_id, "randomized", first(VALIDATION_SEEDS, EPISODES), {"duration": SECONDS})
            times = np.array([[tick_times(episodes, each) for each in pair] for _ in range(ROUNDS)])
            estimate, step = np.median(times, axis=0).T
            print(f"{env_id}, {EPISODES} episodes: estimate {estimate[0]:.0f} us, guarded {estimate[1]:.0f} us;")
            print(f"    a tick with its simulation {step[0]:.0f} us, guarded {step[1]:.0f} us: {step[1] / step[0]:.2f}")


def tick_times(episodes: EpisodeSet, competitor: Competitor) -> tuple[float, float]:
    """Median time of one `estimate`, and time of a whole tick, for the whole batch [us]."""
    with competitor.playing(episodes.env_id, episodes.variant) as compensator:
        start = perf_counter()
        recording = episodes.record(compensator, competitor.name)
        seconds = perf_counter() - start
    return 1e6 * float(np.median(recording.seconds)), 1e6 * seconds / len(recording.seconds)


if __name__ == "__main__":
    main()
