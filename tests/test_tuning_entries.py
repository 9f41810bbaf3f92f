"""Tuning a stranger's class: the entry that the command writes, and what it refuses."""

from __future__ import annotations

import shlex
import shutil
from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.evaluation.competitors.entry import load_entry
from fo_gym.tuning.space import search_space

STICTION = "FJRStiction-v0"
MINE = """
class Mine:
    feedback = "measured"
    search_space = {"gain": (5.0, 50.0)}

    def __init__(self, gain=10.0):
        self.gain = gain

    def reset(self, joints, num_envs):
        self.scale = self.gain * joints.motor_inertia

    def estimate(self, signals):
        return -self.scale * (signals.theta_n_dot - signals.theta_dot)
"""
PROTOCOL = f"""
name = "mine"
split = "validation"
seeds = 1
environments = ["{STICTION}"]
variants = ["randomized"]
compensators = ["results/it's mine.toml"]
"""


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A stranger's file, in a folder of its own beside the one that commands run in."""
    for folder in ("sources", "here"):
        (tmp_path / folder).mkdir()
    (tmp_path / "sources" / "mine.py").write_text(MINE, encoding="utf-8")
    monkeypatch.chdir(tmp_path / "here")
    return "../sources/mine.py:Mine"


class TestOfAStranger:
    EFFORT = ("--trials", "1", "--episodes", "1", "--final-episodes", "1", "--seed", "3")

    def tuned(self, mine, *options):
        """The entry's text; what is tuned lies outside the folder of results."""
        command = ["tune", mine, "--env", STICTION, "--variant", "randomized", *self.EFFORT, "--out", "results"]
        done = CliRunner().invoke(app, [*command, "--jobs", "1", *options])
        assert done.exit_code == 0, done.output
        (written,) = Path("results").glob("*.toml")
        return written.read_text(encoding="utf-8")

    @pytest.mark.usefixtures("short_episodes")
    def test_the_entry_is_accepted_where_it_lies(self, mine):
        text = self.tuned(mine, "--name", "mine-tuned")
        assert 'spec = "../../sources/mine.py:Mine"' in text
        Path("results/mine-tuned.toml").rename("results/it's mine.toml")
        Path("results/it's mine.toml").write_text('name = "mine-tuned"\n' + text, encoding="utf-8")
        Path("protocol.toml").write_text(PROTOCOL, encoding="utf-8")
        options = ("--jobs", "1", "--out")
        where = ("--env", STICTION, "--variant", "randomized", "--seeds", "1", "--baselines", "none")
        for command in (
            ["evaluate", "results/it's mine.toml", *where, *options, "evaluated"],
            ["leaderboard", "--protocol", "protocol.toml", *options, "scored"],
        ):
            done = CliRunner().invoke(app, command)
            assert done.exit_code == 0, done.output
        scores = [pd.read_csv(f"{folder}/episodes.csv").set_index("compensator") for folder in ("evaluated", "scored")]
        assert scores[0].loc["mine-tuned", "frr"] == scores[1].loc["mine-tuned", "frr"]
        assert scores[0].loc["mine-tuned", "status"] == "ok"

    @pytest.mark.usefixtures("short_episodes")
    def test_the_entry_credits_its_author_and_repeats_its_command(self, mine):
        text = self.tuned(mine, "--name", "mine tuned", "--author", 'A. "Ace" Author', "--author", "Élise Müller")
        assert load_entry(Path("results/mine tuned.toml")).authors == ('A. "Ace" Author', "Élise Müller")
        again = shlex.split(text.splitlines()[0].removeprefix("# Tuned by: "))
        assert again[:2] == ["fo-gym", "tune"]
        Path("results/mine tuned.toml").unlink()
        shutil.rmtree("results/mine tuned")
        shutil.rmtree("results/store")
        assert CliRunner().invoke(app, [*again[1:], "--jobs", "1"]).exit_code == 0
        assert Path("results/mine tuned.toml").read_text(encoding="utf-8") == text

    @pytest.mark.usefixtures("short_episodes")
    def test_without_an_author_nobody_is_credited(self, mine):
        self.tuned(mine)
        entry = load_entry(Path("results/mine-Mine-tuned.toml"))
        assert (entry.name, entry.authors) == ("mine-Mine-tuned", ("unnamed",))

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (("--name", "a|b"), "name is 'a|b'; give letters"),
            (("--name", "none"), "name is 'none'; give letters"),
            (("--author", "two\nlines"), "each a line of text"),
            (("--author", " "), "each a line of text"),
            (("--env", "FJRNothing-v0"), "unknown environment 'FJRNothing-v0'; known are FJRStiction-v0"),
            (("--variant", "wild"), "variant is 'wild'; allowed are 'nominal', 'randomized', 'hardware'"),
            (("--seed", "-1"), "seed is -1; give a whole number from 0 to "),
        ],
    )
    def test_what_cannot_stand_in_an_entry_is_refused_before_the_search(self, mine, options, message):
        done = CliRunner().invoke(app, ["tune", mine, *options, "--jobs", "1"])
        assert done.exit_code == 2
        assert message in done.stderr.replace("\n", " ")
        assert not list(Path().iterdir())


class TestErrors:
    def test_a_compensator_without_gains_to_tune(self):
        with pytest.raises(ValueError, match=r"'none' declares no gains to tune; give its class an attribute"):
            search_space("none")

    def test_a_range_that_makes_no_sense(self, tmp_path):
        file = tmp_path / "mine.py"
        file.write_text(
            "class Mine:\n"
            "    feedback = 'measured'\n"
            "    search_space = {'k': (2.0, 1.0)}\n"
            "    def reset(self, joints, num_envs): ...\n"
            "    def estimate(self, signals): ...\n"
        )
        with pytest.raises(ValueError, match=r"search_space\['k'\] is \(2.0, 1.0\); give 0 < low < high"):
            search_space(f"{file}:Mine")
        file.write_text(file.read_text().replace("(2.0, 1.0)", "(1.0, 2.0)"))

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (["pid-high", "--trials", "0"], "trials is 0"),
            (["pid-high", "--variant", "nominal"], "'nominal' is one episode"),
            (["none"], "declares no gains"),
            (["nobody"], "unknown compensator 'nobody'"),
            (["pid-high", "--jobs", "0"], "--jobs is 0"),
        ],
    )
    def test_the_command_says_what_is_wrong(self, arguments, message, tmp_path):
        done = CliRunner().invoke(app, ["tune", *arguments, "--out", str(tmp_path), "--env", STICTION])
        assert done.exit_code == 2
        assert message in done.output.replace("\n", " ")
