"""The certificate: a check turns where something is broken on purpose.

That every check holds while nothing is broken is what `make reproduce-quick` measures, of the same subject.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from fo_gym.certificate import experiments, fidelity, oracle
from fo_gym.certificate.statement import CHECKS, check
from fo_gym.certificate.subject import Subject
from fo_gym.friction import LuGre
from fo_gym.plant import plant as plant_module
from fo_gym.plant import rigid_body
from fo_gym.plant.kernels import kernel_of
from fo_gym.plant.rigid_body import Share

GROUPS = {name: getattr(fidelity, name) for name in fidelity.__all__ if name != "CHECKS"}
slow = pytest.mark.slow
PUBLISHED, QUICK, COARSE = Subject(), Subject(quick=True), Subject(quick=True, physics_dt=1e-3)


def forget() -> None:
    """Drop what the checks keep of earlier runs."""
    for module in GROUPS.values():
        for kept in vars(module).values():
            if hasattr(kept, "cache_clear"):
                kept.cache_clear()


@pytest.fixture
def broken(monkeypatch: pytest.MonkeyPatch) -> Iterator[pytest.MonkeyPatch]:
    """A patch that no earlier run hides, and that no later one sees."""
    forget()
    yield monkeypatch
    forget()


# --- As it is --------------------------------------------------------------------------------------------------------


def test_all_checks_belong_to_the_groups() -> None:
    assert len(CHECKS) >= 25
    counts = Counter(each.group for each in CHECKS.values())
    assert set(counts) == {module.__name__ for module in GROUPS.values()}
    assert min(counts.values()) >= 3
    for each in CHECKS.values():
        assert each.source, each.id
        assert each.text.endswith("."), each.id
        assert each.fails == "", each.id


@pytest.mark.parametrize("id", ["frictional-lag", "inverse-dynamics", pytest.param("energy-free-motion", marks=slow)])
def test_numbers_repeat(broken: pytest.MonkeyPatch, id: str) -> None:
    first = CHECKS[id].measure(QUICK)
    forget()
    assert CHECKS[id].measure(QUICK) == first


@slow
def test_quick_runs_are_the_first_of_the_published_ones() -> None:
    """Fewer cases, the same ones: the worst of few is at most the worst of all, in the same interval."""
    few, all_of_them = (CHECKS["energy-swing"].measure(subject) for subject in (QUICK, PUBLISHED))
    assert few.number <= all_of_them.number
    assert (few.low, few.high) == (all_of_them.low, all_of_them.high)
    assert all_of_them.holds


def test_an_id_is_given_once() -> None:
    with pytest.raises(ValueError, match="two statements are called 'frictional-lag'"):
        check("frictional-lag", source="", text="")(CHECKS["frictional-lag"].measure)


# --- Broken on purpose -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "id",
    [
        "presliding-loop",
        "energy-free-motion",
        "sensitivity-f-s",
        *(
            pytest.param(id, marks=slow)
            for id in ("solver-paper", "order-stick-slip", "twin-link-implicitfast", "hold-displacement")
        ),
    ],
)
def test_a_coarse_step_is_seen(monkeypatch: pytest.MonkeyPatch, id: str) -> None:
    """A step that the plant itself refuses, taken all the same."""
    monkeypatch.setattr(plant_module, "check_steps", lambda *_, **__: None)
    assert not CHECKS[id].measure(COARSE).holds


@pytest.mark.parametrize(
    ("name", "factor", "ids"),
    [
        ("sigma_0", 1.1, ["presliding-forward", "presliding-back"]),
        pytest.param("f_s", 1.1, ["break-away", "stick-slip-onset", "hunting-period"], marks=slow),
        ("f_c", 0.9, ["frictional-lag", "stick-slip-distance", "stick-slip-speed", "stick-slip-period"]),
        pytest.param("sigma_2", 10.0, ["hunting-peak", "hunting-amplitude", "stick-slip-period"], marks=slow),
    ],
)
def test_another_friction_is_seen(broken: pytest.MonkeyPatch, name: str, factor: float, ids: list[str]) -> None:
    broken.setitem(experiments.PAPER, name, factor * experiments.PAPER[name])
    for id in ids:
        assert not CHECKS[id].measure(QUICK).holds, id


@pytest.mark.parametrize("id", ["energy-dissipation", "sensitivity-sigma-1", pytest.param("solver-paper", marks=slow)])
def test_a_wrong_sign_in_the_equations_is_seen(broken: pytest.MonkeyPatch, id: str) -> None:
    """Bristle damping that pushes: what the plant must not agree with."""
    right = oracle.lugre

    def wrong(v: Any, z: Any, friction: Any, *exp: Any) -> tuple[Any, Any]:
        z_rate, tau_f = right(v, z, friction, *exp)
        return z_rate, tau_f + 1.2 * friction.sigma_1 * z_rate

    for module in (oracle, fidelity.energy):
        broken.setattr(module, "lugre", wrong)
    assert not CHECKS[id].measure(QUICK).holds


@pytest.mark.parametrize(
    "id", ["inverse-dynamics", "energy-balance", "energy-swing", pytest.param("solver-two-link", marks=slow)]
)
def test_wrong_inertia_is_seen(broken: pytest.MonkeyPatch, id: str) -> None:
    """One per cent, at every pose."""

    class Heavier(Share):
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments)
            *bias, self._right = self.outputs
            self.outputs = (*bias, self._right.copy())

        def forward(self, ids: Any = None) -> None:
            super().forward(ids)
            self.outputs[-1][:] = 1.01 * self._right

    broken.setattr(rigid_body, "Share", Heavier)
    assert not CHECKS[id].measure(QUICK).holds


@pytest.mark.parametrize("id", ["twin-arm-rk4", pytest.param("twin-link-rk4", marks=slow)])
def test_another_twin_is_seen(broken: pytest.MonkeyPatch, id: str) -> None:
    """A spring that is stiffer by one per cent."""
    right: Callable[..., Any] = plant_module.twin_model

    def stiffer(*arguments: Any, **keywords: Any) -> Any:
        model = right(*arguments, **keywords)
        model.tendon_stiffness[-1] *= 1.01
        return model

    broken.setattr(plant_module, "twin_model", stiffer)
    assert not CHECKS[id].measure(QUICK).holds


@pytest.mark.parametrize("id", ["slide-steady", pytest.param("hold-creep", marks=slow)])
def test_a_leaking_bristle_is_seen(broken: pytest.MonkeyPatch, id: str) -> None:
    """A bristle that relaxes, by a part in 1e6 at every control period, and friction that is 2 % too small."""
    right = plant_module.bound

    def leaking(function: Any, state: np.ndarray, *arguments: Any) -> Any:
        call = right(function, state, *arguments)
        if function is not kernel_of(LuGre(**experiments.PAPER)):
            return call

        def advance() -> None:
            call()
            state[4] *= 1.0 - 1e-6
            arguments[-3][:] *= 0.98

        return advance

    broken.setattr(plant_module, "bound", leaking)
    assert not CHECKS[id].measure(QUICK).holds


# --- The experiments themselves --------------------------------------------------------------------------------------


def test_frictional_lag_widens_with_frequency() -> None:
    """Friction is larger while the velocity rises; the area between the branches grows with the frequency."""
    loops = [experiments.frictional_lag(omega) for omega in (1.0, 10.0, 25.0)]
    areas = [float(np.sum(loop.friction * np.gradient(loop.velocity))) for loop in loops]
    assert 0 < areas[0] < areas[1] < areas[2]


def test_stick_slip_pulls_with_its_spring() -> None:
    """The force in the trace is the spring's, at the far end's 0.1 m/s; stuck, it is friction that holds it."""
    trace = experiments.stick_slip()
    np.testing.assert_allclose(trace.force + 2.0 * trace.position, 0.2 * trace.time, atol=1e-12)
    stuck = (trace.time > 1.0) & (trace.time < 6.0)
    np.testing.assert_allclose(trace.friction[stuck], trace.force[stuck], rtol=1e-3)


# --- The other friction laws ------------------------------------------------------------------------------------------

LAWS_QUICKLY = [id for id, each in CHECKS.items() if id.startswith("law-") and not id.endswith(("-solver", "-order"))]


@pytest.mark.parametrize("id", LAWS_QUICKLY)
def test_laws_do_what_they_are_known_for(id: str) -> None:
    assert CHECKS[id].measure(QUICK).holds


@pytest.mark.parametrize("name", ["dahl", "elasto-plastic", pytest.param("maxwell-slip", marks=slow)])
def test_laws_follow_the_solver(name: str) -> None:
    assert CHECKS[f"law-{name}-solver"].measure(QUICK).holds


@slow
def test_laws_are_of_second_order() -> None:
    assert CHECKS["law-order"].measure(QUICK).holds
