"""Whatever the plant accepts it follows: random joints on the single link against a stiff solver, over many decades.

An error counts against the motion, the span of the solver's theta; in presliding, where the bristle's deflection is all
the motion that there is, against 100 f_s / sigma_0. Near break-away a motion hangs on its torques: a twin of the
solver's run, with all torques off by 1e-5, says by how much, and the plant may be as far off as torques wrong by 1e-3.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, event, example, given, reject, settings
from hypothesis import strategies as st
from scipy.integrate import ODEintWarning

from envs_assets import asset_path
from fo_gym.certificate.oracle import Control, SingleLink, sampled
from fo_gym.friction import LuGre
from fo_gym.micro_steps import PhysicsDt
from fo_gym.parameters import FlexibleJoint
from fo_gym.plant import FlexibleJointPlant
from fo_gym.robots import LinkSide

DT = 1e-3
TOLERANCE, TWIN = 1e-3, 1e-5
SLIDER = LinkSide(asset_path("single_link"), joints=("joint",))


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    """Powers of ten from 10^low to 10^high."""
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


@dataclass(frozen=True)
class Drive:
    """Torques of a run, in units of f_s and of its length; what moves crosses zero velocity in most of them.

    Attributes:
        kind: of the motor's torque.
        size, turns: of it; `turns` half periods.
        push: on the link, as a share of `size`.
        speed: of both masses at the start, as a share of what f_c would give them in that time.
        ticks: length.
    """

    kind: str
    size: float
    turns: float
    push: float
    speed: float
    ticks: int

    def torques(self, f_s: float) -> tuple[np.ndarray, np.ndarray]:
        """On motor and link at every tick, (ticks,) each [N]."""
        u = (np.arange(self.ticks) + 0.5) / self.ticks
        shapes = {
            "step": np.where(u < 0.5, 1.0, -1.0),
            "wave": np.sin(np.pi * self.turns * u),
            "waves": np.sin(np.pi * self.turns * u) + 0.5 * np.sin(2.7 * np.pi * self.turns * u + 1.0),
            "bump": np.sin(np.pi * u) ** 2,
            "creep": np.minimum(u / 0.8, 1.0) / 2.5,
            "nothing": 0.0 * u,
        }
        pushed = self.push * np.exp(-(((u - 0.6) / 0.1) ** 2))
        pulled = shapes["creep"] if self.kind == "nothing" else 0.0
        return f_s * self.size * shapes[self.kind], f_s * self.size * (pushed + pulled)


DRIVES = st.builds(
    Drive,
    kind=st.sampled_from(["step", "wave", "waves", "bump", "creep", "nothing"]),
    size=log_uniform(0.0, 1.0),
    turns=st.floats(1.0, 10.0),
    push=st.sampled_from([0.0, 0.7, -0.4]),
    speed=st.sampled_from([0.0, 0.0, 0.3, -1.0]),
    ticks=st.integers(30, 200),
)


@st.composite
def single_links(draw: st.DrawFn) -> SingleLink:
    """Joints behind a link of 1 kg, whatever its unit of mass: bristle damping ratios and frequencies of the spring."""
    B, sigma_0, f_c = draw(log_uniform(-1, 1)), draw(log_uniform(2, 9)), draw(log_uniform(-2, 1.5))
    ratio = draw(st.one_of(st.just(0.0), log_uniform(-2, 1)))
    friction = LuGre(
        sigma_0=sigma_0,
        sigma_1=ratio * (sigma_0 * B) ** 0.5,
        sigma_2=draw(st.one_of(st.just(0.0), log_uniform(-2, 1))) * f_c,
        f_c=f_c,
        f_s=f_c * draw(st.one_of(st.floats(1.0, 3.0), log_uniform(0, 2))),
        v_s=draw(log_uniform(-7, 0)),
    )
    stiffness = draw(log_uniform(1.0, 3.4)) ** 2 / (1.0 / B + 1.0)
    damping = draw(st.one_of(st.just(0.0), log_uniform(-3, 0))) * (stiffness / (1.0 / B + 1.0)) ** 0.5
    return SingleLink(FlexibleJoint(stiffness, damping, B, torque_limit=100.0), friction)


def start_of(link: SingleLink, drive: Drive) -> np.ndarray:
    """The state at the start, (5, 1)."""
    start = np.zeros((5, 1))
    start[[1, 3]] = drive.speed * link.friction.f_c / link.joint.motor_inertia * drive.ticks * DT
    return start


def plant_run(link: SingleLink, drive: Drive, physics_dt: PhysicsDt) -> np.ndarray:
    """Motor positions at the ticks, (ticks + 1,).

    Raises:
        ValueError: the plant refuses this joint at this step.
    """
    plant = FlexibleJointPlant(SLIDER, 1, joints=link.joint, friction=link.friction, physics_dt=physics_dt)
    start = start_of(link, drive)
    plant.q_dot[:], plant.theta_dot[:] = start[1], start[3]
    motion = [0.0]
    for tau_m, tau_ext in zip(*drive.torques(link.friction.f_s), strict=True):
        plant.step(np.array([[tau_m]]), np.array([[tau_ext]]))
        motion.append(plant.theta.item())
    return np.array(motion)


class Torques(Control):
    """Torques that heed no measurement, in the place of the solver's controller."""

    def __init__(self, tau_m: np.ndarray) -> None:
        super().__init__(DT)
        self._coming: Iterator[float] = iter(tau_m)

    def __call__(self, *_: object) -> np.ndarray:
        return np.array([next(self._coming)])


def solver_run(link: SingleLink, drive: Drive, scale: float = 1.0) -> np.ndarray:
    """The solver's motor positions, (ticks + 1,), with all torques times `scale`."""
    tau_m, tau_ext = drive.torques(link.friction.f_s)
    atol = 1e-8 * link.friction.f_c / link.friction.sigma_0
    states = sampled(
        link, Torques(scale * tau_m), start_of(link, drive), scale * tau_ext[:, None], rtol=1e-9, atol=atol
    )
    return states[:, 2, 0]


def check_followed(link: SingleLink, drive: Drive, physics_dt: PhysicsDt) -> None:
    """Accepted and followed, or refused with a remedy; what the solver itself gives up on is left out, and counted."""
    refusal = ""
    try:
        ours = plant_run(link, drive, physics_dt)
    except ValueError as error:
        refusal = str(error)
    event("refused" if refusal else "accepted")
    if refusal:
        assert re.search("too long for joint 'joint': .* 1/s; use|no physics_dt of|at most 10000 are taken", refusal)
        return
    try:
        theirs, twin = solver_run(link, drive), solver_run(link, drive, 1.0 + TWIN)
    except ODEintWarning:
        event("the solver gave up")
        reject()
    motion = max(np.ptp(theirs), 100.0 * link.friction.f_s / link.friction.sigma_0)
    allowed = TOLERANCE * max(motion, np.abs(twin - theirs).max() / TWIN)
    assert np.abs(ours - theirs).max() <= allowed


STEPS = st.sampled_from([None, None, "auto", 2.5e-5])
SEARCH = settings(
    deadline=None,
    derandomize=True,
    database=None,
    phases=(Phase.explicit, Phase.generate, Phase.shrink),
    suppress_health_check=[HealthCheck.too_slow],
)


# At the default step these ended 4 % and 2 % off the solver without a word: a hard bristle, and an overdamped one.
PAPER_JOINT = FlexibleJoint(stiffness=3000.0, damping=0.0, motor_inertia=1.0, torque_limit=100.0)
HARD = SingleLink(PAPER_JOINT, LuGre(sigma_0=1e8, sigma_1=1e4, sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=1e-3))
OVERDAMPED = SingleLink(PAPER_JOINT, LuGre(sigma_0=1e5, sigma_1=1e4, sigma_2=0.4, f_c=1.0, f_s=1.5, v_s=1e-3))
PULL = Drive("nothing", size=3.0, turns=1.0, push=0.0, speed=0.0, ticks=200)


@settings(SEARCH, max_examples=20)
@example(link=HARD, drive=PULL, physics_dt=None)
@example(link=HARD, drive=PULL, physics_dt="auto")
@example(link=OVERDAMPED, drive=PULL, physics_dt=None)
@example(link=OVERDAMPED, drive=PULL, physics_dt="auto")
@given(link=single_links(), drive=DRIVES, physics_dt=STEPS)
def test_what_is_accepted_is_followed(link: SingleLink, drive: Drive, physics_dt: PhysicsDt) -> None:
    check_followed(link, drive, physics_dt)


@pytest.mark.slow
@settings(SEARCH, max_examples=500)
@given(link=single_links(), drive=DRIVES, physics_dt=STEPS)
def test_a_wide_search_finds_nothing_amiss(link: SingleLink, drive: Drive, physics_dt: PhysicsDt) -> None:
    check_followed(link, drive, physics_dt)
