"""Hardware by design: the MIRO-like arm's own comes out of its numbers, within what one rule for all joints can."""

from __future__ import annotations

import numpy as np

from fo_gym.robots import robot_of
from fo_gym.robots.design_hardware import designed_hardware


def test_it_is_near_the_hardware_of_the_shipped_arm() -> None:
    """Exactly where the arm gives shares; within a factor of four where it gives all joints the same."""
    arm = robot_of("miro_like")
    own, made = arm.hardware, designed_hardware(arm.flexible, arm.friction, np.ones(arm.dof))
    assert own is not None
    same = ("delay", "saturation", "load", "temperature", "model_error", "push_time")
    assert [name for name in same if getattr(own, name) != getattr(made, name)] == []
    for part, names in (
        (lambda each: each.sensors.encoder, ("resolution", "cutoff")),
        (lambda each: each.ripple, ("period",)),
        (lambda each: each.link_friction, ("width",)),
    ):
        for name in names:
            np.testing.assert_allclose(getattr(part(made), name), np.full(arm.dof, getattr(part(own), name)).min())
    for part, names in (
        (lambda each: each.sensors.torque, ("noise", "offset")),
        (lambda each: each.ripple, ("amplitude",)),
        (lambda each: each.link_friction, ("coulomb", "viscous")),
    ):
        for name in names:
            ratio = np.asarray(getattr(part(made), name)) / getattr(part(own), name)
            assert ((ratio > 0.25) & (ratio < 4.0)).all(), name


def test_a_slide_counts_as_a_hinge_with_a_lever() -> None:
    link = robot_of("single_link")
    made = designed_hardware(link.flexible, link.friction, np.array([0.1]))
    assert made.sensors.encoder is not None
    assert made.ripple is not None
    np.testing.assert_allclose(made.sensors.encoder.resolution, 1e-7)
    np.testing.assert_allclose(made.ripple.period, 2.0 * np.pi / 200.0 * 0.1)
