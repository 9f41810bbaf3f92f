"""The five LuGre experiments of Canudas de Wit et al. (1995) on the joint kernel."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fo_gym.certificate.experiments import Trace, break_away, frictional_lag, hunting, presliding, stick_slip
from fo_gym.certificate.fidelity.lugre import BREAK_AWAY, LAG
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures.style import BLACK, KINDS, LINES, MICRO, MILLI, figure_of, letter, thin

Array = NDArray[np.float64]

TITLE = "The LuGre experiments of 1995"
CAPTION = (
    "The experiments of Canudas de Wit et al. (1995) on the joint kernel, a motor of 1 kg; friction is drawn as the "
    "force -tau_f that opposes motion. (a) Presliding: a force that stays below break-away, there and back; the "
    "bristles give like a spring with hysteresis. (b) Frictional lag at a prescribed velocity: friction is larger "
    "while the velocity rises, and the loop widens with the frequency. (c) Break-away force over the rate of the "
    "force; circles: values of an independent stiff solver. (d) Stick-slip: the motor is pulled over a spring of 2 "
    "N/m whose end moves at 0.1 m/s. (e) Hunting: PID control of the position to 1 m (dashed)."
)
_POINTS = 1000

__all__ = ["CAPTION", "TITLE", "figure"]


def figure(subject: Subject) -> Figure:
    """Above the three experiments without time axis, below stick-slip and hunting over time."""
    drawn = figure_of(6.6)
    upper, lower = drawn.subfigures(2, 1, height_ratios=[1.0, 1.6], squeeze=False)[:, 0]
    left, middle, right = upper.subplots(1, 3)
    _draw_presliding(left, subject)
    _draw_lag(middle, subject)
    _draw_break_away(right, subject)
    columns = lower.subplots(3, 2, sharex="col").T
    _draw_motion(columns[0], stick_slip(subject.physics_dt))
    _draw_motion(columns[1], hunting(subject.physics_dt))
    letter(columns[0][0], 3, "stick-slip")
    letter(columns[1][0], 4, "hunting under PID control")
    columns[1][0].axhline(1.0, color="0.5", linestyle="--", linewidth=0.8)
    lower.align_ylabels(columns[0])
    lower.align_ylabels(columns[1])
    return drawn


def _sparse(values: Array) -> Array:
    """A smooth curve with few points."""
    return values[:: max(1, len(values) // _POINTS)]


def _draw_presliding(axis: Axes, subject: Subject) -> None:
    """Friction over displacement."""
    trace = presliding(subject.physics_dt)
    axis.plot(MICRO * _sparse(trace.position), _sparse(trace.friction), color=LINES["pid"]["color"])
    letter(axis, 0, "presliding")
    axis.set_xlabel(r"displacement [$\mu$m]")
    axis.set_ylabel(r"friction $-\tau_f$ [N]")


def _draw_lag(axis: Axes, subject: Subject) -> None:
    """Friction over velocity, a loop per frequency."""
    for omega, kind in zip(LAG, KINDS, strict=True):
        lag = frictional_lag(omega, subject.physics_dt)
        label = rf"$\omega={omega:g}$ rad/s"
        style = {"color": LINES[kind]["color"], "linestyle": LINES[kind]["linestyle"]}
        axis.plot(MILLI * _sparse(lag.velocity), _sparse(lag.friction), label=label, **style)
    letter(axis, 1, "frictional lag")
    axis.legend(loc="upper right", handlelength=2.6)
    axis.set_xlabel("velocity [mm/s]")
    axis.set_ylabel(r"friction $-\tau_f$ [N]")


def _draw_break_away(axis: Axes, subject: Subject) -> None:
    """Largest friction before the motor slides, over the rate of the force."""
    rates = np.geomspace(min(BREAK_AWAY), max(BREAK_AWAY), 60)
    force = [float(break_away(rate, subject.physics_dt).friction.max()) for rate in rates.tolist()]
    axis.plot(rates, force, color=LINES["pid"]["color"], label="kernel")
    solver = list(BREAK_AWAY.values())
    axis.plot(list(BREAK_AWAY), solver, "o", color=BLACK, markerfacecolor="none", markersize=4.5, label="solver")
    letter(axis, 2, "break-away")
    axis.legend(loc="upper right")
    axis.set_xlabel("rate of the force [N/s]")
    axis.set_ylabel("break-away force [N]")


def _draw_motion(axes: Array, trace: Trace) -> None:
    """Position, velocity and friction over time."""
    quantities = {
        "position [m]": trace.position,
        "velocity [m/s]": trace.velocity,
        r"friction $-\tau_f$ [N]": trace.friction,
    }
    for axis, (label, values) in zip(axes, quantities.items(), strict=True):
        axis.plot(*thin(trace.time, values), color=LINES["pid"]["color"])
        axis.set_ylabel(label)
    axes[-1].set_xlabel("time [s]")
    axes[-1].set_xlim(0.0, float(trace.time[-1]))
