"""The protocol over friction laws, its page and its figure; and the page of the documentation."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from fo_gym.evaluation.results.laws import conclusions, finding, laws_page
from fo_gym.evaluation.results.laws_figure import laws_figure
from fo_gym.evaluation.runs.contest import episodes_in, under_law
from fo_gym.evaluation.runs.protocol import Protocol, load_protocol
from fo_gym.friction import LAWS
from fo_gym.modules import import_file

ROOT = Path(__file__).parents[1]
OWN = ROOT / "tests" / "outside" / "own_laws.py"
LAW_NAMES = ("LuGre", "MaxwellSlip", "Dahl")
SMALL = Protocol("s", "validation", 2, ("FJRStiction-v0",), ("randomized",), ("pd-low",), laws=LAW_NAMES)


def table(**columns: list[tuple[str, float, int, str]]) -> pd.DataFrame:
    """Rows of a leaderboard: (name, frr, rank, letters) of each law's competitors, best first."""
    rows: list[dict[str, Any]] = []
    for law, entries in columns.items():
        robot = "single_link" if law == "LuGre" else f"single_link with {law}"
        common = {"env": "FJRStiction-v0", "robot": robot, "variant": "randomized"}
        for name, frr, rank, letters in entries:
            verdict = "best" if rank == 1 else "tied" if "a" in letters else "behind"
            rows.append(
                {**common, "compensator": name, "frr": frr, "rank": rank, "tied_group": letters, "verdict": verdict}
            )
        rows.append({**common, "compensator": "none", "frr": 0.0, "rank": None, "tied_group": None, "verdict": None})
    return pd.DataFrame(rows)


TABLE = table(
    LuGre=[("a", 0.9, 1, "a"), ("b", 0.8, 2, "b"), ("c", 0.7, 3, "c"), ("d", 0.69, 4, "c")],
    MaxwellSlip=[("a", 0.9, 1, "a"), ("b", 0.8, 2, "b"), ("c", 0.79, 3, "b"), ("d", 0.5, 4, "c")],
    Dahl=[("b", 0.9, 1, "a"), ("a", 0.8, 2, "b"), ("c", 0.7, 3, "c"), ("d", 0.6, 4, "d")],
)


def test_conclusions_are_the_pairs_that_the_first_law_tells_apart() -> None:
    found = {(each.better, each.worse): each.under for each in conclusions(SMALL, TABLE)}
    assert set(found) == {("a", "b"), ("a", "c"), ("a", "d"), ("b", "c"), ("b", "d")}
    assert found["a", "b"] == {"MaxwellSlip": 1, "Dahl": -1}
    assert found["b", "c"] == {"MaxwellSlip": 0, "Dahl": 1}
    assert found["b", "d"] == {"MaxwellSlip": 1, "Dahl": 1}


def test_the_finding_counts_what_survives() -> None:
    said = finding(SMALL, TABLE)
    assert said.count(". ") == 1, "it is two sentences"
    assert "Of 5 pairs of competitors that LuGre tells apart, 3 (60 %)" in said
    assert "1 is turned round under at least one (a is better than b on FJRStiction-v0, randomized, but not" in said
    assert "80 % under MaxwellSlip, 80 % under Dahl" in said
    assert "on 0 of 1 sets of episodes" in said


def test_nothing_told_apart_is_said() -> None:
    tied = table(LuGre=[("a", 0.9, 1, "a"), ("b", 0.9, 2, "a")], Dahl=[("a", 0.9, 1, "a"), ("b", 0.5, 2, "b")])
    assert finding(SMALL, tied).startswith("Under LuGre no two competitors are told apart.")


def test_page_and_figure_have_every_competitor_under_every_law(tmp_path: Path) -> None:
    page = laws_page(SMALL, TABLE)
    assert re.search(r"\| *compensator *\| *LuGre *\| *MaxwellSlip *\| *Dahl *\|", page)
    assert re.search(r"\| *c *\| *0\.7000 c *\| *0\.7900 b *\| *0\.7000 c *\|", page)
    assert laws_figure(SMALL, TABLE, tmp_path).read_bytes().startswith(b"\x89PNG")


def test_a_protocol_runs_each_set_under_each_law() -> None:
    shipped = load_protocol("laws")
    assert set(shipped.laws) == set(LAWS)
    assert shipped.laws[0] == "LuGre"
    sets = episodes_in(SMALL)
    assert [episodes.robot.name for episodes in sets] == [
        "single_link",
        "single_link with MaxwellSlip",
        "single_link with Dahl",
    ]
    assert sets[0].env_kwargs == {}
    assert sets[0] == episodes_in(Protocol("s", "validation", 2, ("FJRStiction-v0",), ("randomized",), ("x",)))[0]
    assert [type(episodes.robot.friction).__name__ for episodes in sets] == list(LAW_NAMES)


@pytest.mark.parametrize(
    ("name", "law"), [("arm", "Dahl"), ("arm with gripper", "LuGre"), ("arm", f"{OWN}:SmoothCoulomb")]
)
def test_a_robot_under_its_own_law_is_on_the_page(name: str, law: str, tmp_path: Path) -> None:
    file = tmp_path / "robot.toml"
    under_law("miro_like", law).to_toml(file)
    protocol = Protocol("s", "validation", 2, ("FJRSquare-v0",), ("nominal",), ("x",), {name: str(file)}, laws=(law,))
    (episodes,) = episodes_in(protocol)
    rows = table(LuGre=[("a", 0.9, 1, "a")]).assign(env=episodes.env_id, robot=episodes.robot.name, variant="nominal")
    page = laws_page(protocol, rows)
    assert f"## FJRSquare-v0 on {name}, nominal" in page
    assert f"| compensator | {law.rpartition(':')[2]} |" in page


def test_laws_that_there_are_not_are_refused() -> None:
    for laws, told in (
        (("Coulomb",), "protocol 's': law is 'Coulomb'; known are LuGre"),
        (("Dahl", "Dahl"), "names one of them twice"),
        (("math:sqrt",), "give a class derived from"),
    ):
        with pytest.raises(ValueError, match=told):
            Protocol("s", "validation", 2, ("FJRStiction-v0",), ("nominal",), ("pd-low",), laws=laws)


def test_a_protocol_without_laws_is_the_one_it_was() -> None:
    plain = Protocol("s", "validation", 2, ("FJRStiction-v0",), ("nominal",), ("pd-low",))
    assert plain.stamp != SMALL.stamp
    assert "laws" not in load_protocol("full").stamp


def test_the_examples_of_the_page_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """The law of the page is one of a user's file, and does what the page says."""
    page = (ROOT / "docs" / "friction.md").read_text(encoding="utf-8")
    first, law, certified = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    (tmp_path / "page.py").write_text(f"{first}\n{law}\n{certified}", encoding="utf-8")
    env: Any = import_file(tmp_path / "page.py").env
    assert type(env.unwrapped.simulation.scenarios[0].friction).__name__ == "MaxwellSlip"
    assert [line.split()[:2] for line in capsys.readouterr().out.splitlines()] == [
        ["solver", "True"],
        ["steady", "True"],
        ["creep", "True"],
    ]
