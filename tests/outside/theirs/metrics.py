"""A metric, under the entry points `fo_gym.metrics`."""

import numpy as np

from fo_gym.evaluation.metrics import Episode, Tolerance, metric


@metric("theirs_largest_ju", unit="ju", better="lower", tolerance=Tolerance(1e-6, 1e-3))
def largest_error(episode: Episode) -> float:
    """Largest |theta - theta_d|, worst joint."""
    return float(np.max(np.abs(episode.motion.theta - episode.theta_d)))
