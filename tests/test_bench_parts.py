"""The benchmark of speed: how fine a step a peer needs, the figure of growth, and the parts of a whole job."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from fo_gym.bench.figure import growth_figure
from fo_gym.bench.job import COMPENSATORS, METRICS, REFERENCES, SIMULATION, _Watch, parts_of_job
from fo_gym.bench.precision import cases_of, precision, steps_to_reach
from fo_gym.bench.yardsticks import OBSERVER
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.contest import contests_in
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.evaluation.runs.run import run_contests

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"


@pytest.mark.parametrize(
    ("target", "errors", "steps", "inside"),
    [
        (0.25, [1.0, 0.5, 0.25], 4, True),  # reached at one that was tried
        (0.3, [1.0, 0.5, 0.25], 4, True),  # between two: 2 * 0.5 / 0.3, rounded up
        (0.1, [1.0, 0.25, 0.0625], 4, True),  # of second order: 2 * sqrt(2.5) = 3.2
        (1.0, [1.0, 0.5, 0.25], 1, True),
        (0.01, [1.0, 0.5, 0.25], 100, False),  # beyond: first order
        (0.01, [1.0, 0.25, 0.0625], 10, False),
        (0.01, [9.0, 0.25, 0.0625], 10, False),  # the last two count
    ],
)
def test_steps_that_reach_an_error(target: float, errors: list[float], steps: int, inside: bool) -> None:
    assert steps_to_reach(target, (1, 2, 4), errors) == (steps, inside)


def test_an_error_that_does_not_fall_tells_nothing() -> None:
    with pytest.raises(ValueError, match=r"errors 5\.0e-01 and 5\.0e-01 at 2 and 4 steps do not fall; try more steps"):
        steps_to_reach(0.1, (1, 2, 4), [1.0, 0.5, 0.5])


@pytest.mark.parametrize("env_id", [STICTION, REGULATION])
def test_peers_err_as_little_as_the_plant(env_id: str) -> None:
    found = precision(env_id, 1, 40)
    assert 0.0 < found.ours < 1e-4
    for match in found.twins:
        tried = dict(match.tried)
        assert list(tried) == sorted(tried)
        if match.setting in tried:  # its error follows a power nearly
            assert tried[match.setting] == pytest.approx(found.ours, rel=0.3) or tried[match.setting] < found.ours
        else:
            assert "extrapolated" in match.note
            assert match.setting > max(tried)
            assert min(tried.values()) > found.ours
    assert dict(found.lsoda.tried)[found.lsoda.setting] <= found.ours


def test_cases_are_different_motions() -> None:
    for env_id in (STICTION, REGULATION):
        cases = cases_of(env_id, 3, 10)
        assert [len(case.tau_ext) for case in cases] == [10] * 3
        assert len({repr(case.gains) for case in cases}) == 3


def test_the_figure_shows_every_point() -> None:
    rows = [
        {"env": env, "over": over, "size": size, "ms": 2.0 * size, "q1": 1.9 * size, "q3": 2.2 * size}
        for env in (STICTION, REGULATION)
        for over in ("environments", "joints", "threads", "seconds")
        for size in (1.0, 2.0, 4.0)
    ]
    figure = growth_figure(pd.DataFrame(rows))
    assert len(figure.axes) == 4
    for axis in figure.axes:
        *lines, linear = axis.get_lines()
        assert len(lines) == 2
        for line in lines:
            np.testing.assert_array_equal(line.get_xydata(), [[1.0, 2.0], [2.0, 4.0], [4.0, 8.0]])
        slope = -1.0 if "threads" in axis.get_xlabel() else 1.0
        ratio = np.asarray(linear.get_ydata())[-1] / np.asarray(linear.get_ydata())[0]
        assert np.log(ratio) / np.log(4.0) == pytest.approx(slope)
        assert (axis.get_xscale(), axis.get_yscale()) == ("log", "log")


@pytest.mark.slow
def test_a_watched_job_is_the_job() -> None:
    """It gives the same rows, and its parts are all of it."""
    small = replace(load_protocol("quick"), environments=(STICTION,), variants=("nominal",), compensators=(OBSERVER,))
    watch = _Watch()
    watched = run_contests(contests_in(small), small.stamp, backend=watch)
    usual = run_contests(contests_in(small), small.stamp, backend=Processes(1))
    pd.testing.assert_frame_equal(watched.episodes, usual.episodes)
    assert set(watch.seconds) == {"reference_trials", "trials_together"}
    for name, clock in watch.clocks.items():
        assert 0.0 < clock.estimates < clock.records < watch.seconds[name]
    parts = parts_of_job(small)
    assert list(parts)[:4] == [REFERENCES, SIMULATION, COMPENSATORS, METRICS]
    assert all(taken >= 0.0 for taken in parts.values())
