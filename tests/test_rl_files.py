"""The learned compensator's files: back as they were, and refused where they are something else."""

from __future__ import annotations

import hashlib
import json

import numpy as np
import pytest
from policies import DIRECT, network
from safetensors.numpy import load_file, save_file

import fo_gym
from baselines.rl.loop import FEATURES
from baselines.rl.network import Network
from baselines.rl.storage import load_policy, save_policy


class TestFiles:
    @pytest.fixture
    def path(self, tmp_path):
        save_policy(tmp_path / "p.safetensors", DIRECT, network(squash="tanh"), {"note": 1})
        return tmp_path / "p.safetensors"

    def rewrite(self, path, tensors=None, metadata=None):
        """Change what the file holds, and have the card vouch for it."""
        design, net = load_policy(path)
        description = {"design": vars(design), "squash": net.squash, "features": FEATURES} | (metadata or {})
        save_file(tensors or net.tensors(), path, metadata={"fo-gym policy": json.dumps(description)})
        card = {"sha256": hashlib.sha256(path.read_bytes()).hexdigest()}
        path.with_suffix(".json").write_text(json.dumps(card))

    def test_back_as_it_was(self, path):
        design, net = load_policy(path)
        assert design == DIRECT
        assert net.squash == "tanh"
        for mine, theirs in zip(net.weights, network().weights, strict=True):
            np.testing.assert_array_equal(mine, theirs)
        assert json.loads(path.with_suffix(".json").read_text())["note"] == 1

    def test_the_memory_layout_does_not_matter(self, tmp_path):
        transposed = Network(tuple(np.asfortranarray(weight) for weight in network().weights), "clip")
        save_policy(tmp_path / "p.safetensors", DIRECT, transposed, {})
        for mine, theirs in zip(load_policy(tmp_path / "p.safetensors")[1].weights, network().weights, strict=True):
            np.testing.assert_array_equal(mine, theirs)

    def test_the_same_bytes_for_the_same_policy(self, path, tmp_path):
        for name in "qrs":
            save_policy(tmp_path / f"{name}.safetensors", DIRECT, network(squash="tanh"), {"note": 1})
            assert (tmp_path / f"{name}.safetensors").read_bytes() == path.read_bytes()

    def test_weights_that_were_changed(self, path):
        content = bytearray(path.read_bytes())
        content[-1] ^= 1
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"hash .* its card says"):
            load_policy(path)

    def test_a_missing_file(self, path):
        path.with_suffix(".json").unlink()
        with pytest.raises(ValueError, match="the model card of these weights"):
            load_policy(path)
        with pytest.raises(ValueError, match=r"no .*nowhere\.safetensors"):
            fo_gym.make_compensator("rl-residual", weights="nowhere.safetensors")

    @pytest.mark.parametrize("text", ["", "[]", "{}", "\xff"])
    def test_a_card_that_is_none(self, path, text):
        path.with_suffix(".json").write_bytes(text.encode("latin-1"))
        with pytest.raises(ValueError, match="is no model card"):
            load_policy(path)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda t: {**t, "layer0": t["layer0"][:-1].copy()}, "this policy has 9 inputs"),
            (lambda t: {**t, "layer1": t["layer1"][:-1].copy()}, "what the one before gives"),
            (lambda t: {**t, "layer0": np.full_like(t["layer0"], np.nan)}, "layer0 has weights that are not finite"),
            (lambda t: {**t, "layer0": t["layer0"].astype(np.float64)}, "expected float32"),
            (lambda t: {"layer0": t["layer0"], "head": t["layer1"]}, "expected layer0, layer1"),
        ],
    )
    def test_tensors_of_something_else(self, path, change, message):
        self.rewrite(path, tensors=change(load_file(path)))
        with pytest.raises(ValueError, match=message):
            load_policy(path)

    @pytest.mark.parametrize(
        ("metadata", "message"),
        [
            ({"features": ["rate"]}, "this version computes"),
            ({"squash": "relu"}, "allowed are"),
            ({"design": {"gain": 1.0}}, "gain"),
            ({"design": {"bound": -1.0}}, "Design.bound is -1"),
        ],
    )
    def test_a_description_of_something_else(self, path, metadata, message):
        self.rewrite(path, metadata=metadata)
        with pytest.raises(ValueError, match=message):
            load_policy(path)

    def test_a_file_that_is_no_safetensors(self, path):
        path.write_bytes(b"PK nonsense")
        path.with_suffix(".json").write_text(json.dumps({"sha256": hashlib.sha256(b"PK nonsense").hexdigest()}))
        with pytest.raises(ValueError, match="no policy that can be used"):
            load_policy(path)
