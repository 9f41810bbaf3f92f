"""What the kernel does where a large array is made, for the tests of the workers' memory."""

from __future__ import annotations

import resource

import numpy as np


def page_faults() -> tuple[int, int]:
    """How many there are while an array of 128 MB is made, and while it is made again."""
    counts = [resource.getrusage(resource.RUSAGE_SELF).ru_minflt]
    for _ in range(2):
        np.ones(2**24)
        counts.append(resource.getrusage(resource.RUSAGE_SELF).ru_minflt)
    return counts[1] - counts[0], counts[2] - counts[1]
