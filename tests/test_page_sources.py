"""What the page takes from elsewhere: maps as `fo-gym map` writes them, and the documentation that it links to."""

from __future__ import annotations

import re
from email.message import Message
from pathlib import Path

import pytest
from pages import write_map
from tables import STICTION

from fo_gym import ENVIRONMENTS
from fo_gym.files import read_csv
from fo_gym.page import documentation as documentation_module
from fo_gym.page.documentation import documentation
from fo_gym.page.maps import maps_in
from fo_gym.page.stories import stories

ROOT = Path(__file__).parents[1]


def test_pages_of_the_documentation_that_are_linked_exist() -> None:
    table = read_csv((ROOT / "leaderboard" / "leaderboard.csv").read_text(encoding="utf-8"))
    links = [story.more for story in stories(table)]
    for template in (ROOT / "fo_gym" / "page" / "templates").iterdir():
        links += re.findall(r"\{\{ documentation \}\}/([^\"{]+)\"", template.read_text(encoding="utf-8"))
    assert len(links) >= 9
    for link in links:
        page, _, heading = link.partition("#")
        if page.startswith("environments/"):  # made from the registry when the documentation is built
            assert Path(page).stem in ENVIRONMENTS
            continue
        text = (ROOT / "docs" / page).with_suffix(".md").read_text(encoding="utf-8")
        headings = [re.sub(r"[^a-z]+", "-", line.lower()).strip("-") for line in re.findall(r"^#+ (.*)$", text, re.M)]
        assert not heading or heading in headings


def test_the_projects_own_documentation_is_the_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Message()
    told["Project-URL"] = "Paper, https://arxiv.org/abs/1907.00553"
    monkeypatch.setattr(documentation_module, "metadata", lambda name: told)
    assert documentation() == ""
    told["Project-URL"] = "Documentation, https://some.github.io/one/docs/"
    assert documentation() == "https://some.github.io/one/docs"


def test_maps_are_read_as_they_are(tmp_path: Path) -> None:
    assert maps_in(tmp_path / "nowhere") == []
    write_map(tmp_path / "one", [("10", "1", "ok", "0.5"), ("20", "1", "failed", ""), ("10", "5", "ok", "0.25")])
    (found,) = maps_in(tmp_path)
    assert (found.name, found.compensator, found.place) == ("one", "pid", f"{STICTION}, nominal")
    assert (found.x.title, found.x.values, found.y.values) == ("L [1/s]", [10.0, 20.0], [1.0, 5.0])
    (layer,) = found.layers
    assert (layer.title, layer.values) == ("1 - FRR, what is left of friction's effect", [[0.5, None], [0.75, None]])
    assert (found.refused, found.marks.points, found.marks.line) == (1, [("low", 10.0, 5.0)], [])


@pytest.mark.parametrize(
    ("rows", "drawing", "told"),
    [
        ([("10", "1", "ok", "0.5")] * 2, {}, "has a cell of L and Li twice"),
        ([("10", "1", "ok", "0.5")], {"metric": "frrr"}, "has no column frrr"),
        ([("10", "1", "failed", "")], {}, "has no number in frr"),
        ([("10", "1", "ok", "0.5")], {"points": 1}, "does not say what is drawn"),
        ([], {}, "has a map.json, but no map.csv"),
    ],
)
def test_a_map_of_something_else_is_refused(
    rows: list[tuple[str, str, str, str]], drawing: dict[str, object], told: str, tmp_path: Path
) -> None:
    write_map(tmp_path / "one", rows, **drawing)
    with pytest.raises(ValueError, match=f"{told}.*write (it|both) again with `fo-gym map`"):
        maps_in(tmp_path)
