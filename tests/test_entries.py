"""Entries of competitors, what is refused in them, and submissions among them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from entries import ENTRY, MINE, Write
from tables import SQUARE, STICTION
from typer.testing import CliRunner

import fo_gym
from fo_gym.cli import app
from fo_gym.evaluation.competitors import entry
from fo_gym.evaluation.competitors.competitor import BASELINE, REFERENCE, SUBMISSION, YOURS, Competitor
from fo_gym.evaluation.competitors.entry import check_names, competitor_of, handed_over, load_entry, submissions_in
from fo_gym.evaluation.competitors.guard.readable import readable
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.run import run_protocol

pytestmark = pytest.mark.usefixtures("short_episodes")

# Entries


def test_an_entry_is_read(write: Write) -> None:
    path = write(theirs_toml=ENTRY, mine_py=MINE)
    found = load_entry(path)
    assert (found.name, found.authors, found.link) == ("tuned", ("A. Author", "B. Author"), "https://example.org/paper")
    assert found.spec == f"{path.parent / 'mine.py'}:Mine"
    assert found.origin == BASELINE
    assert found.gains_on(SQUARE, "randomized") == {"L": 60.0}
    assert found.gains_on(SQUARE, "nominal") == found.gains_on(STICTION, "randomized") == {"L": 80.0}
    made: Any = fo_gym.make_compensator(found.spec, **found.gains_on(SQUARE, "randomized"))
    assert made.L == 60.0


def test_what_is_optional_may_be_missing(write: Write) -> None:
    found = load_entry(write(theirs_toml='spec = "pid-high"\nauthors = ["A"]\nlink = ""\n'))
    assert (found.name, found.spec, found.gains_on(SQUARE, "nominal")) == ("theirs", "pid-high", {})


def test_a_gain_that_names_a_file_beside_the_entry_is_that_file(write: Write) -> None:
    path = write(theirs_toml=ENTRY.replace("L = 80.0", 'weights = "w.npz"\nmode = "fast"'), w_npz="1 2 3")
    assert load_entry(path).gains == {"weights": str(path.parent / "w.npz"), "mode": "fast"}


def test_a_gain_may_be_a_text_that_no_file_can_have_for_its_name(write: Write) -> None:
    note = 5000 * "a"
    path = write(theirs_toml=ENTRY.replace("L = 80.0", f'note = "{note}"'), mine_py=MINE)
    mine = load_entry(path)
    assert mine.gains == {"note": note}
    assert mine.hash_on(STICTION, "nominal") != Competitor(mine.name, mine.spec).hash_on(STICTION, "nominal")
    assert note not in readable(mine.spec, mine.gains)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'spec = "mine.py:Mine"\n',
            "",
            r"missing keys \['spec'\], unknown keys \[\]; it needs spec, authors, link, and",
        ),
        ("[gains]", "[gain]", r"unknown keys \['gain'\].*may have name, gains, sets"),
        ('spec = "mine.py:Mine"', "spec = 7", "spec is 7; it must be a text"),
        ('spec = "mine.py:Mine"', 'spec = "ideal"', "spec is 'ideal'; name a compensator of your own"),
        ('spec = "mine.py:Mine"', 'spec = ""', "spec is ''; name a compensator"),
        ('name = "tuned"', 'name = "none"', "name is 'none'; give letters.*neither of the references none, ideal"),
        ('name = "tuned"', 'name = "a|b"', r"name is 'a\|b'; give letters"),
        ('["A. Author", "B. Author"]', '"A. Author"', "authors is 'A. Author'; it must be a list"),
        ('["A. Author", "B. Author"]', "[]", r"authors is \[\]; give at least one name"),
        ('"B. Author"', r'"B\nAuthor"', "each a line of text"),
        ("https://", "javascript:", "link is 'javascript:.*give an address https://"),
        ("L = 80.0", "L = ", r"theirs\.toml: "),
        ("L = 80.0", "L = " + 10_000 * "[", r"theirs\.toml: "),
        ('"FJRSquare-v0"', '"FJRNothing-v0"', "set 1: env is 'FJRNothing-v0'; allowed are FJRStiction-v0"),
        ('"randomized"', '"wild"', "set 1: variant is 'wild'; allowed are nominal, randomized"),
        ('variant = "randomized"\n', "", r"set 1: missing keys \['variant'\].*it needs env, variant, gains"),
        ("gains = { L = 60.0 }", "gains = 60.0", r"set 1: gains is 60\.0; it must be a table"),
        ("gains = { L = 60.0 }", "gains = { L = 60.0 }\nextra = 1", r"set 1: .*unknown keys \['extra'\]"),
    ],
)
def test_a_bad_entry_is_named(write: Write, old: str, new: str, message: str) -> None:
    assert old in ENTRY
    path = write(theirs_toml=ENTRY.replace(old, new, 1))
    with pytest.raises(ValueError, match=rf"entry .*theirs\.toml: .*{message}|{message}"):
        load_entry(path)


def test_the_same_set_twice_is_refused(write: Write) -> None:
    path = write(theirs_toml=ENTRY + ENTRY[ENTRY.index("[[sets]]") :])
    with pytest.raises(ValueError, match=r"set 2: FJRSquare-v0 randomized is there twice; keep one"):
        load_entry(path)


def test_what_a_name_means(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(theirs_toml=ENTRY)
    assert competitor_of(str(path)).name == "tuned"
    assert competitor_of("pid-low") == Competitor("pid-low", "pid-low")
    assert competitor_of("ideal").origin == REFERENCE
    with pytest.raises(ValueError, match=r"there is no entry nothing\.toml"):
        competitor_of("nothing.toml")
    monkeypatch.setattr(entry, "shipped_entries", lambda: {"theirs": path})
    assert competitor_of("theirs").name == "tuned"


def test_shipped_entries_can_be_made() -> None:
    for name in entry.shipped_entries():
        competitor = competitor_of(name)
        assert (competitor.name, competitor.origin) == (name, BASELINE)
        assert competitor.hash_on(STICTION, "nominal")
        competitor.make(STICTION, "nominal")


def test_evaluate_takes_an_entry(write: Write) -> None:
    path = write(theirs_toml=ENTRY, mine_py=MINE)
    row = fo_gym.evaluate(str(path), STICTION, duration=0.1).iloc[0]
    assert (row["compensator"], row["origin"]) == ("tuned", "")
    assert row["competitor_hash"] == load_entry(path).hash_on(STICTION, "nominal")


def test_two_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match=r"two competitors are called 'a': x:X and y:Y; give one of them another name"):
        check_names([Competitor("a", "x:X"), Competitor("b", "x:X"), Competitor("a", "y:Y")])


# Submissions

PROTOCOL = Protocol("small", "validation", 1, (SQUARE,), ("nominal",), ("pd-low",))


def test_submissions_are_the_entries_of_a_folder(write: Write) -> None:
    folder = write(b_toml=ENTRY, a_toml=ENTRY.replace("tuned", "first"), notes_txt="no entry").parent
    assert [(each.name, each.origin) for each in submissions_in(folder)] == [
        ("first", SUBMISSION),
        ("tuned", SUBMISSION),
    ]
    with pytest.raises(ValueError, match=r"there is no folder nowhere; name one"):
        submissions_in(Path("nowhere"))


def test_submissions_take_part(write: Write, tmp_path: Path) -> None:
    """They lie beside where the command runs, whatever its folder; rows and ranks are among everybody's, marked."""
    write(small_toml=TOML)
    theirs = tmp_path / "here" / "leaderboard" / "submissions"
    theirs.mkdir(parents=True)
    (theirs / "theirs.toml").write_text(ENTRY, encoding="utf-8")
    (theirs / "mine.py").write_text(MINE, encoding="utf-8")
    result = CliRunner().invoke(app, ["leaderboard", "--protocol", "../small.toml", "--out", "out", "--jobs", "1"])
    assert result.exit_code == 0, result.stderr
    board = pd.read_csv("out/leaderboard.csv").set_index("compensator")
    assert board["origin"].to_dict() == {
        "none": "reference", "ideal": "reference", "bound": "reference", "pd-low": "baseline", "tuned": "submission"
    }  # fmt: skip
    assert board["rank"].dropna().tolist() == [2, 1]
    page = Path("out/leaderboard.md").read_text(encoding="utf-8")
    assert "\nMarks: † submission.\n" in page
    assert [page.count(f"\n| {row} | ") for row in ("1 | tuned †", "2 | pd-low", "tuned †")] == [1, 1, 1]
    assert "\n* tuned †: A. Author, B. Author, <https://example.org/paper>\n" in page
    assert "│ tuned † " in result.stdout
    assert "\n† submission\n" in result.stdout


TOML = """
name = "small"
split = "validation"
seeds = 1
environments = ["FJRSquare-v0"]
variants = ["nominal"]
compensators = ["pd-low"]
"""


def test_submissions_leave_the_rows_of_the_others_alone(write: Write) -> None:
    write(theirs_toml=ENTRY, mine_py=MINE)
    with_them = run_protocol(PROTOCOL, submissions=submissions_in(Path(".."))).episodes
    others = with_them[with_them["origin"] != SUBMISSION]
    pd.testing.assert_frame_equal(others, run_protocol(PROTOCOL).episodes, check_exact=True)


# What a user hands over


def test_what_a_user_hands_over_is_theirs_unless_it_ships_as_it_is(write: Write) -> None:
    path = write(theirs_toml=ENTRY, mine_py=MINE)
    spec = f"{path.parent / 'mine.py'}:Mine"
    origins = {text: handed_over(text, {}).origin for text in ("none", "pid-high", "pid-tuned", str(path), spec)}
    assert list(origins.values()) == [REFERENCE, BASELINE, BASELINE, YOURS, YOURS]
    for text in ("pid-high", "pid-tuned"):
        changed = handed_over(text, {"L": 70, "Li": 49.0})
        assert (changed.name, changed.origin) == (f"{text} L=70 Li=49", YOURS)
    entry = handed_over(str(path), {"L": 70.0}, "mine")
    assert entry.name == "mine"
    for reference in ("none", "ideal"):
        with pytest.raises(ValueError, match=f"--name is 'mine'; the reference {reference} keeps its own"):
            handed_over(reference, {}, "mine")
    assert entry.gains_on(SQUARE, "randomized") == entry.gains_on(SQUARE, "nominal") == {"L": 70.0}


def test_gains_that_there_are_not_are_told(write: Write) -> None:
    spec = f"{write(mine_py=MINE).parent / 'mine.py'}:Mine"
    for name, there in ((spec, "L, gain"), ("pid-high", "L, Lp, Li"), ("baselines.kim2019:PDObserver", "L, Lp")):
        with pytest.raises(TypeError, match=rf"{name!r} has no gain 'x'; it takes {there}$"):
            fo_gym.make_compensator(name, x=1.0)
    with pytest.raises(TypeError, match=r"'pid-high' has no gain 'spec'; it takes L, Lp, Li$"):
        fo_gym.make_compensator("pid-high", spec=1.0)
    (Path("nothing.py")).write_text("class Nothing:\n    pass\n", encoding="utf-8")
    with pytest.raises(TypeError, match="has no gain 'x'; it takes none"):
        fo_gym.make_compensator("nothing.py:Nothing", x=1.0)
