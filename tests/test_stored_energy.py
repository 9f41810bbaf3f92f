"""What is stored when a push begins: closed forms of the single link, and conservation of energy on the arm."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from fo_gym import FRICTIONLESS, PDGains
from fo_gym.evaluation.episode.stored import stored_energy
from fo_gym.tasks.scenario import Push

STICTION, REGULATION = "FJRStiction-v0", "FJRRegulation-v0"
NAMES = ("theta", "theta_dot", "q", "q_dot")


def simulation_of(env_id: str, times: list[float | None], **arguments: Any) -> Any:
    """A batch of the nominal episode, each pushed, with no torque, at another time."""
    simulation = gym.make_vec(env_id, num_envs=len(times), **arguments).unwrapped.simulation  # type: ignore[attr-defined]
    simulation.reset(np.arange(len(times)), [np.random.default_rng(0) for _ in times])
    for i, time in enumerate(times):
        push = None if time is None else Push(time, 0.1, np.zeros(simulation.dof))
        simulation.scenarios[i] = replace(simulation.scenarios[i], push=push)
    return simulation


def at_rest(simulation: Any, ticks: int, **values: float) -> dict[str, np.ndarray]:
    """Ticks of which each is the same state: 0 but for `values`."""
    shape = (ticks, simulation.num_envs, simulation.dof)
    return {name: np.full(shape, values.get(name, 0.0)) for name in (*NAMES, "theta_n", "theta_n_dot")}


def test_a_single_link() -> None:
    """M = B = 1, K = 3000, K_p = 50, the target at 10 mm."""
    simulation = simulation_of(STICTION, [0.005, None, 1.0])
    rested = stored_energy(simulation, at_rest(simulation, 11, theta=0.004, q=0.004))
    assert rested[0] == pytest.approx(0.5 * 50.0 * 0.006**2, rel=1e-6)
    assert np.isnan(rested[1:]).all()  # no push, and one after the end
    moving = stored_energy(simulation, at_rest(simulation, 11, theta=0.01, q=0.01, theta_dot=0.2, q_dot=0.3))
    assert moving[0] == pytest.approx(0.5 * (0.2**2 + 0.3**2), rel=1e-6)
    wound = stored_energy(simulation, at_rest(simulation, 11, theta=0.01, q=0.012))
    assert wound[0] == pytest.approx(0.5 * 3000.0 * 0.002**2, rel=1e-6)


def test_what_has_left_the_finite_numbers_has_no_energy() -> None:
    simulation = simulation_of(STICTION, [0.005, 0.005])
    ticks = at_rest(simulation, 11, theta=0.01, q=0.012)
    ticks["theta"][:, 1] = np.inf
    energy = stored_energy(simulation, ticks)
    assert energy[0] == pytest.approx(0.5 * 3000.0 * 0.002**2, rel=1e-6)
    assert not np.isfinite(energy[1])


def test_under_nominal_feedback_the_larger_of_two_counts() -> None:
    simulation = simulation_of(STICTION, [0.005], feedback="nominal")
    ticks = at_rest(simulation, 11, theta=0.01, q=0.01, theta_n=0.01)
    assert stored_energy(simulation, ticks)[0] == pytest.approx(0.0, abs=1e-12)
    ticks["theta_n"][:] = 0.007  # where the controller believes the motor, its spring and the joint's are wound by 3 mm
    assert stored_energy(simulation, ticks)[0] == pytest.approx(0.5 * (50.0 + 3000.0) * 0.003**2, rel=1e-6)
    ticks = at_rest(simulation, 11, theta=0.007, q=0.007, theta_n=0.01)
    assert stored_energy(simulation, ticks)[0] == pytest.approx(0.5 * 3000.0 * 0.003**2, rel=1e-6)


def test_without_damping_the_arm_keeps_its_energy() -> None:
    """Frictionless, on the springs of its controller alone, swinging by 50 mrad about the target, gravity included."""
    times = [0.0, 0.1, 0.2, 0.35, 0.5]
    kp = PDGains(kp=50.0, kd=0.0)
    simulation = simulation_of(REGULATION, times, friction=FRICTIONLESS, gains=kp, control_dt=2e-4)
    state = simulation.get_state()
    plant = replace(state.plant, q=state.plant.q + 0.05, theta=state.plant.theta + 0.05)
    simulation.set_state(replace(state, plant=plant))
    truth = [simulation.truth()]
    for _ in range(2600):
        simulation.step(np.zeros((len(times), 7)))
        truth.append(simulation.truth())
    ticks = {name: np.array([each[name] for each in truth]) for name in NAMES}
    ticks |= {"theta_n": ticks["theta"], "theta_n_dot": ticks["theta_dot"]}
    energy = stored_energy(simulation, ticks)
    assert energy[0] > 0.2
    assert np.ptp(ticks["theta"][:, 0, 1]) > 0.05
    np.testing.assert_allclose(energy, energy[0], rtol=0.02)
