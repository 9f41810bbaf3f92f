"""What the "randomized" variant draws from."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fo_gym.checks import NOT_NEGATIVE, POSITIVE, Value, check_ranges, check_values

Range = tuple[float, float]

__all__ = ["Randomization"]


@dataclass(frozen=True)
class Randomization:
    """Ranges of the "randomized" variant. Factors are drawn log-uniformly, per joint unless noted.

    Attributes:
        friction: factor on Coulomb friction (LuGre: f_c); of friction, all act on what its law has of it.
        stiction: factor on the share by which stiction (f_s) exceeds Coulomb friction.
        stribeck: factor on the Stribeck velocity (v_s).
        bristle: factor on the stiffness (sigma_0); the damping (sigma_1) gets its square root, which keeps its ratio.
        viscous: factor on viscous friction (sigma_2).
        motor_inertia, stiffness: factors on B and K_j.
        mass: factor on the masses of the robot file, one for all links.
        start: largest offset of each joint at reset [m | rad], uniform; one value or one per joint.
        step: factor on the size of the target's step, uniform, with a random sign per joint.
        push_time: start of the push [s], uniform.
        push: factor on the push, uniform, with a random sign.
        hand_stroke, hand_speed, hand_stiffness: factors of the hand, which is damped in proportion; drawn, like the
            direction of its strokes, a quarter of a turn from `Hand.direction` to `Hand.across`, where there is one.
    """

    friction: Range = (0.6, 1.6)
    stiction: Range = (0.5, 1.5)
    stribeck: Range = (0.5, 2.0)
    bristle: Range = (0.5, 2.0)
    viscous: Range = (0.5, 2.0)
    motor_inertia: Range = (0.75, 1.33)
    stiffness: Range = (0.7, 1.4)
    mass: Range = (0.8, 1.25)
    start: Value = 0.0
    step: Range = (0.5, 1.5)
    push_time: Range = (0.0, 0.0)
    push: Range = (0.5, 1.5)
    hand_stroke: Range = (0.7, 1.0)
    hand_speed: Range = (0.8, 1.3)
    hand_stiffness: Range = (0.5, 1.0)

    @property
    def fastest(self) -> Randomization:
        """Ranges without width, from which only the fastest joints and bristles are drawn, at the nominal start."""
        ends = {name: (getattr(self, name)[1],) * 2 for name in ("stiction", "bristle", "viscous", "stiffness")}
        ends |= {name: (getattr(self, name)[0],) * 2 for name in ("motor_inertia", "mass")}
        return replace(self, start=0.0, **ends)

    def __post_init__(self) -> None:
        check_values(self, start=NOT_NEGATIVE)
        check_ranges(self, hand_stroke=POSITIVE, hand_speed=POSITIVE, hand_stiffness=POSITIVE)
        check_ranges(self, step=NOT_NEGATIVE, push=NOT_NEGATIVE, push_time=NOT_NEGATIVE)
        check_ranges(self, friction=POSITIVE, stiction=POSITIVE, stribeck=POSITIVE, bristle=POSITIVE, viscous=POSITIVE)
        check_ranges(self, motor_inertia=POSITIVE, stiffness=POSITIVE, mass=POSITIVE)
