"""The adaptive compensator: its observer, what it reads from a loop, its files."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from dataclasses import fields

import gymnasium as gym
import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

import fo_gym
from baselines.rl.adaptive import AdaptiveCompensator, AdaptiveDesign, rl_adaptive
from baselines.rl.adaptive.compensator import SHIPPED
from baselines.rl.adaptive.course import described
from baselines.rl.adaptive.readings import ControllerStiffness, DelayedTorque
from baselines.rl.adaptive.rows import COLUMNS
from baselines.rl.adaptive.storage import load_weights, save_weights
from baselines.rl.adaptive.weights import SHAPES, Weights
from fo_gym import JointInfo, Signals


def weights(seed=0, scale=0.1):
    rng = np.random.default_rng(seed)
    made = {name: (scale * rng.normal(size=shape)).astype(np.float32) for name, shape in SHAPES.items()}
    return Weights.from_tensors(made)


def played(compensator, env_id="FJRRegulation-v0", ticks=400, seeds=(1, 2), sign=1.0, **kwargs):
    """Estimates on episodes of the variant hardware; `sign` turns all that is measured, and the answer, round."""
    env = gym.make_vec(env_id, len(seeds), variant="hardware", feedback="measured", **kwargs)
    obs, _ = env.reset(seed=list(seeds))
    joints = env.unwrapped.joint_info
    compensator.reset(joints, len(seeds))
    estimates = []
    for _ in range(ticks):
        signals = Signals.from_observation(sign * obs, joints.dof)
        estimates.append(sign * compensator.estimate(signals))
        obs, *_ = env.step(estimates[-1])
    return np.array(estimates), joints, env


class TestObserver:
    def test_directions_are_alike(self):
        """Friction knows no direction: where all is turned round, so is the estimate; what is learned is, too."""
        one, other = AdaptiveCompensator(AdaptiveDesign(), weights()), AdaptiveCompensator(AdaptiveDesign(), weights())
        there, *_ = played(one)
        back, *_ = played(other, sign=-1.0)
        np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(one.zero, -other.zero, rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(one.error, other.error, rtol=1e-6, atol=1e-9)
        assert (one.error != 0.0).any()

    def test_neighbours_do_not_matter(self):
        together, *_ = played(AdaptiveCompensator(AdaptiveDesign(), weights()), seeds=(1, 2))
        alone, *_ = played(AdaptiveCompensator(AdaptiveDesign(), weights()), seeds=(2,))
        np.testing.assert_allclose(together[:, 1], alone[:, 0], rtol=1e-9, atol=1e-9)

    def test_what_is_learned_stays_within_its_bounds(self):
        wild = AdaptiveCompensator(AdaptiveDesign(), weights(scale=3.0))
        _, joints, _ = played(wild, ticks=300)
        assert (np.abs(wild.zero) <= 0.02 * joints.torque_limit).all()
        assert (np.abs(wild.error) <= 0.18).all()

    @pytest.mark.parametrize("scale", [0.1, 3.0])
    def test_what_is_learned_never_raises_the_gains(self, scale):
        """Neither above B L nor above B^ L, whatever was learned."""
        compensator = AdaptiveCompensator(AdaptiveDesign(), weights(scale=scale))
        _, joints, _ = played(compensator)
        believed = compensator.design.L * joints.motor_inertia
        assert (compensator.error < 0.0).any()
        assert (compensator.error > 0.0).any()
        assert (compensator._gain <= believed * np.minimum(1.0, 1.0 - compensator.error) * (1.0 + 1e-12)).all()

    def test_the_correction_is_what_was_learned(self):
        compensator = AdaptiveCompensator(AdaptiveDesign(), weights())
        played(compensator)
        bound = np.abs(compensator.zero) + 0.18 * 1e3
        assert (np.abs(compensator.correction) <= bound).all()
        assert AdaptiveCompensator(AdaptiveDesign(), None).learned

    def test_without_weights_it_is_nominal_feedback(self):
        """The PID-type observer with nominal feedback and the same gains, up to how tau_j is averaged over a period."""
        design = AdaptiveDesign(L=100.0, Lp=20.0, Li=100.0)
        ours = fo_gym.evaluate(AdaptiveCompensator(design, None), "FJRStiction-v0", duration=3.0)
        theirs = fo_gym.evaluate("pid-high", "FJRStiction-v0", duration=3.0)
        assert ours["frr"][0] == pytest.approx(theirs["frr"][0], abs=0.005)

    def test_what_does_not_suit_the_sampling(self):
        joints = JointInfo(1, np.ones((1, 1)), np.ones((1, 1)), np.ones((1, 1)), 3e-3)
        with pytest.raises(ValueError, match=r"it learns every 0\.01 s, .* control_dt = 0\.003 s; .* at most 0\.001 s"):
            AdaptiveCompensator(AdaptiveDesign(), weights()).reset(joints, 1)

    @pytest.mark.parametrize("name", [each.name for each in fields(AdaptiveDesign)])
    def test_designs_that_are_none(self, name):
        for value in (0.0, -1.0, np.nan, "1", None):
            with pytest.raises(ValueError, match=rf"AdaptiveDesign\.{name} is"):
                AdaptiveDesign(**{name: value})


class TestReadings:
    @pytest.mark.parametrize("delay", [0, 1, 3, 7])
    def test_the_delay_of_commands(self, delay):
        rng = np.random.default_rng(0)
        late, torques, commands = DelayedTorque(8, (2, 3), 1000), [], [np.zeros((2, 3))] * 20
        for _ in range(100):
            torques.append(rng.normal(size=(2, 3)))
            now = late.now(torques[-1], commands[-1 - delay])
            commands.append(torques[-1] - 0.5)
            late.commanded(commands[-1])
        assert (late.delay == delay).all()
        np.testing.assert_array_equal(now, torques[-1 - delay])

    def test_the_stiffness_of_a_controller(self):
        """Exactly where each joint has its own gains; none where joints are coupled, or before they move."""
        rng = np.random.default_rng(0)
        own, coupled = ControllerStiffness((1, 2)), ControllerStiffness((1, 2))
        for _ in range(30):
            theta, theta_dot, target = rng.normal(size=(1, 2)), rng.normal(size=(1, 2)), np.full((1, 2), 0.3)
            tau_c = -50.0 * (theta - target) - 4.0 * theta_dot + 7.0
            own.block(theta, theta_dot, tau_c, target)
            coupled.block(theta, theta_dot, tau_c + 20.0 * theta[:, ::-1], target)
        np.testing.assert_allclose(own.kp, 50.0, rtol=1e-9)
        np.testing.assert_allclose(own.kd, 4.0, rtol=1e-9)
        assert (coupled.kp == 0.0).all()
        assert (coupled.kd == 0.0).all()
        assert (ControllerStiffness((1, 2)).kp == 0.0).all()


class TestFiles:
    @pytest.fixture
    def path(self, tmp_path):
        save_weights(tmp_path / "p.safetensors", AdaptiveDesign(), weights(), {"note": 1})
        return tmp_path / "p.safetensors"

    def test_back_as_they_were(self, path):
        design, found = load_weights(path)
        assert design == AdaptiveDesign()
        for name in SHAPES:
            np.testing.assert_array_equal(getattr(found, name), getattr(weights(), name))
        assert json.loads(path.with_suffix(".json").read_text())["note"] == 1

    def test_weights_that_were_changed(self, path):
        content = bytearray(path.read_bytes())
        content[-1] ^= 1
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"hash .* its card says"):
            load_weights(path)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"mean": np.zeros(3, np.float32)}, "mean has shape"),
            ({"mean": np.full(COLUMNS - 2, np.nan, np.float32)}, "not finite"),
            ({"mean": np.zeros(COLUMNS - 2)}, "mean is float64"),
            ({"more": np.zeros(1, np.float32)}, "tensors are"),
        ],
    )
    def test_what_they_cannot_be(self, change, message):
        with pytest.raises(ValueError, match=message):
            Weights.from_tensors({**weights().tensors(), **change})

    def test_a_policy_is_no_such_file(self, path):
        save_file(load_file(path), path, metadata={"fo-gym policy": "{}"})
        path.with_suffix(".json").write_text(json.dumps({"sha256": _hash(path)}))
        with pytest.raises(ValueError, match="holds no adaptive weights"):
            load_weights(path)


class TestShipped:
    def test_what_the_card_says(self):
        card = json.loads((SHIPPED / "policy.json").read_text())
        assert card["plan"]["adaptive"]["design"] == vars(AdaptiveDesign())
        assert card["course"] == json.loads(json.dumps(described()))

    @pytest.mark.slow
    def test_it_learns_what_is_not_friction(self):
        """On validation episodes of the arm, which it was not trained on: half of the zeros' squares, once it moved."""
        env = gym.make_vec("FJRTracking-v0", 3, variant="hardware", feedback="measured", duration=6.0)
        obs, _ = env.reset(seed=[1_000_000_500, 1_000_000_501, 1_000_000_502])
        simulation, compensator = env.unwrapped.simulation, rl_adaptive()
        compensator.reset(simulation.joint_info, 3)
        zero = simulation.get_state().hardware.memory[simulation.robot.hardware.sensors.torque.name]["zero"]
        for _ in range(5990):
            obs, *_ = env.step(compensator.estimate(Signals.from_observation(obs, simulation.dof)))
        assert np.mean((compensator.zero - zero) ** 2) <= 0.5 * np.mean(zero**2)

    @pytest.mark.slow
    def test_it_beats_the_observer_beneath(self):
        """On unseen validation episodes of robots as they are: 1 - FRR at most 0.8 times; measured about half."""
        seeds, own = range(1_000_000_500, 1_000_000_506), rl_adaptive()
        learned, observer = (
            fo_gym.evaluate(
                AdaptiveCompensator(own.design, weights), "FJRStiction-v0", variant="hardware", seeds=seeds
            )["frr"]
            for weights in (own.weights, None)
        )
        assert (1 - learned).mean() <= 0.8 * (1 - observer).mean()

    @pytest.mark.slow
    def test_scoring_needs_no_torch(self):
        program = (
            "import sys, fo_gym\n"
            "from baselines.rl.adaptive import rl_adaptive\n"
            "rows = fo_gym.evaluate(rl_adaptive(), 'FJRStiction-v0', duration=0.1)\n"
            "assert rows['status'][0] == 'ok'\n"
            "print([name for name in ('torch', 'stable_baselines3') if name in sys.modules])"
        )
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == "[]"


def _hash(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()
