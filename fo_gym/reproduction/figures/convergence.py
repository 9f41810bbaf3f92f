"""How far the plant is from an independent solver, over its step and over the time it takes, beside MuJoCo alone."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from fo_gym.certificate.cases import PERIOD, Case, paper_case
from fo_gym.certificate.steppers import Stepper, motion, plant, solver, twin
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures.precision import Point, arm_step, measure
from fo_gym.reproduction.figures.style import BLACK, LINES, ORANGE, PURPLE, SKY, figure_of, letter

TITLE = "Convergence and cost of the plant"
CAPTION = (
    "Largest distance of links and motors from an independent solver (LSODA on the equations at a tolerance of 1e-10; "
    "on the arm with Pinocchio's rigid body), under the PID-type observer at low gains sampled at 1 kHz. (a) Two "
    "seconds of the single link, over the step. This plant is of second order through stick and slip; its twin, "
    "wholly in MuJoCo, comes closer at first order at most. (b) The same runs, and solvers "
    "of SciPy at several tolerances, over the time spent per simulated second, in one process on one environment. (c) "
    "Half a second of the 7-joint arm, over the step: what remains of the plant's error below 0.1 ms comes from "
    "inertia and bias, which are held over each control period of 1 ms."
)
_PLANT, _FAST, _RK4 = "this plant", "MuJoCo, implicitfast", "MuJoCo, RK4"
_STYLES: dict[str, dict[str, Any]] = {
    _PLANT: {"color": LINES["pid"]["color"], "marker": "o"},
    _FAST: {"color": LINES["pd"]["color"], "marker": "s", "linestyle": LINES["pd"]["linestyle"]},
    _RK4: {"color": LINES["letien"]["color"], "marker": "^", "linestyle": LINES["letien"]["linestyle"]},
    "LSODA": {"color": PURPLE, "marker": "D", "linestyle": ":"},
    "Radau": {"color": ORANGE, "marker": "v", "linestyle": ":"},
    "BDF": {"color": SKY, "marker": "P", "linestyle": ":"},
}
_METHODS: dict[str, Callable[[Case, float], Stepper]] = {
    _PLANT: plant,
    _FAST: partial(twin, integrator="implicitfast"),
    _RK4: partial(twin, integrator="rk4"),
}
_TOLERANCES = {
    "LSODA": (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9),
    "Radau": (1e-3, 1e-5, 1e-7),
    "BDF": (1e-5, 1e-6, 1e-7),
}
_REPEATS = 3
_ARM_PERIODS = 500

__all__ = ["CAPTION", "TITLE", "figure"]

Curves = dict[str, tuple[list[float], list[Point]]]
"""By method: steps [s] or tolerances, and what was measured there."""


def figure(subject: Subject) -> Figure:
    """Error over step on the single link, error over time spent, and error over step on the arm."""
    # Longer steps cannot follow the bristle's damping, and the plant refuses them.
    halvings, repeats = ((2, 4), 1) if subject.quick else (range(2, 7), _REPEATS)
    steps = [PERIOD / 2**k for k in halvings]
    link, arm = paper_case("pid-low"), arm_step(_ARM_PERIODS)
    stepped = _over_step(link, steps, repeats)
    solved = _over_tolerance(link, 1 if subject.quick else None, repeats)
    drawn = figure_of(3.5)
    axes = drawn.subplots(1, 3)
    _draw_over_step(axes[0], stepped, "m")
    _draw_over_time(axes[1], stepped | solved)
    _draw_over_step(axes[2], _over_step(arm, steps, 1), "rad")
    for index, text in enumerate(
        ("single link, over the step", "single link, over time", "7-joint arm, over the step")
    ):
        letter(axes[index], index, text)
    for axis in axes[:2]:
        axis.set_ylim(5e-11, 2e-3)
    handles, labels = axes[1].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=len(labels), handlelength=3.0, columnspacing=1.4)
    return drawn


def _over_step(case: Case, steps: list[float], repeats: int) -> Curves:
    """The plant and its twins at every step [s]."""
    truth = motion(case, solver(case))
    measure(case, truth, partial(plant, case, steps[0]), 1)  # compiles the kernel where it is not in the cache yet
    return {
        name: (steps, [measure(case, truth, partial(method, case, step), repeats) for step in steps])
        for name, method in _METHODS.items()
    }


def _over_tolerance(case: Case, count: int | None, repeats: int) -> Curves:
    """The solvers of SciPy at their first `count` tolerances."""
    truth = motion(case, solver(case))
    curves: Curves = {}
    for name, tolerances in _TOLERANCES.items():
        some = list(tolerances[:count])
        curves[name] = (
            some,
            [measure(case, truth, partial(solver, case, name, rtol, 1e-3 * rtol), repeats) for rtol in some],
        )
    return curves


def _draw_over_step(axis: Axes, curves: Curves, unit: str) -> None:
    """Error over step, with slopes to compare with."""
    for name, (steps, points) in curves.items():
        axis.loglog(1e3 * np.array(steps), [point.error for point in points], label=name, markersize=4, **_STYLES[name])
    longest = curves[_PLANT][0][0]
    ends = 1e3 * np.array([longest, longest / 8])
    # Above or below the curve that each slope belongs to.
    guides: tuple[tuple[int, str, float, dict[str, Any]], ...] = (
        (1, _FAST, 3.0, {"xytext": (-2, 2), "ha": "right", "va": "bottom"}),
        (2, _PLANT, 0.25, {"xytext": (3, -3), "ha": "left", "va": "top"}),
    )
    for order, name, beside, place in guides:
        slope = beside * curves[name][1][0].error * (ends / ends[0]) ** order
        axis.loglog(ends, slope, color=BLACK, linewidth=0.7)
        middle = np.sqrt(ends.prod()), np.sqrt(slope.prod())
        axis.annotate(f"order {order}", middle, textcoords="offset points", fontsize=8.0, **place)
    axis.set_xlim(1e-2, 0.4)
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("step [ms]")
    axis.set_ylabel(f"largest error [{unit}]")


def _draw_over_time(axis: Axes, curves: Curves) -> None:
    """Error over the time that it takes."""
    for name, (_, points) in curves.items():
        seconds, errors = [point.seconds for point in points], [point.error for point in points]
        axis.loglog(seconds, errors, label=name, markersize=4, **_STYLES[name])
    axis.axvline(1.0, color="0.4", linewidth=0.8)
    axis.text(0.9, 0.04, "real time", rotation=90, ha="right", fontsize=8.0, transform=axis.get_xaxis_transform())
    axis.set_xlim(1e-2, 1.5)
    axis.set_xlabel("time spent per simulated second [s]")
    axis.set_ylabel("largest error [m]")
