"""The way of a hand's own point, compiled: a hand in a simulation asks for it at every tick."""

from __future__ import annotations

from fo_gym.compiling import jit

__all__ = ["stroke_at"]


@jit
def stroke_at(since, stroke, speed, turn, strokes):
    """How far a hand's point is [m], and its speed [m/s], `since` [s] it gripped; the rest as of Hand."""
    time = stroke / speed + turn
    if since <= 0.0:
        return 0.0, 0.0
    if since >= strokes * time:
        return (stroke if strokes % 2 else 0.0), 0.0
    index = int(since / time)
    inside = since - index * time
    mirrored = inside > 0.5 * time  # the second half of a stroke is the first, backwards
    inside = min(inside, time - inside)
    x = min(inside / turn, 1.0)
    # Speed is 3 x^2 - 2 x^3 of the whole while it swells; its integral is x^3 - x^4 / 2.
    rate = speed * x * x * (3.0 - 2.0 * x)
    distance = speed * turn * x * x * x * (1.0 - 0.5 * x) + speed * max(inside - turn, 0.0)
    if mirrored:
        distance = stroke - distance
    return (stroke - distance, -rate) if index % 2 else (distance, rate)
