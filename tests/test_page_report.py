"""`fo-gym evaluate --report` and `fo-gym page` as commands: what they write, and what they refuse."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from commands import MINE
from pages import LINK, Open, chromium, run, visits
from playwright.sync_api import Browser
from tables import STICTION
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.page import vendor

pytestmark = pytest.mark.looks


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory, short_episodes: None) -> Path:
    folder = tmp_path_factory.mktemp("report")
    (folder / "mine.py").write_text(MINE, encoding="utf-8")
    run(
        "evaluate", f"{folder / 'mine.py'}:Mine", "--env", STICTION, "--baselines", "pid-high,pd-low", "--name", "mine",
        "--report", folder / "site", "--store", folder / "store", "--jobs", "1",
    )  # fmt: skip
    return folder / "site"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as found:
        yield found


@pytest.fixture
def visit(browser: Browser, report: Path) -> Iterator[Open]:
    with visits(browser, report) as found:
        yield found


def test_a_report_tells_of_ones_own_beside_others(visit: Open) -> None:
    opened = visit()
    page = opened.page
    assert page.locator("h1").inner_text() == f"mine on {STICTION}, nominal"
    best = page.locator("tr.best").get_attribute("data-name") or ""
    opened.wait_for_traces(*dict.fromkeys([best, "mine"]))
    assert page.locator("tr.own").evaluate_all("all => all.map((each) => each.dataset.name)") == ["mine"]
    assert page.locator("#summary .lead").inner_text().startswith("Friction keeps joints")
    page.click(".episodes a")
    assert f"set={LINK}" in opened.hash()
    assert page.locator("#claims").count() == 0


# What a reader does with the tables of any page


def test_sorting_changes_the_order(visit: Open) -> None:
    opened = visit(f"#set={LINK}")
    header = opened.page.locator("[data-sort='torque_roughness_ratio'] >> visible=true")
    header.click()
    column = opened.page.locator("section.ranking:not([hidden]) tbody tr td:last-child")
    up = [float(text) for text in column.evaluate_all("all => all.map((each) => each.dataset.value)")]
    assert up == sorted(up)
    header.focus()
    opened.page.keyboard.press("Enter")
    down = [float(text) for text in column.evaluate_all("all => all.map((each) => each.dataset.value)")]
    assert down == sorted(down, reverse=True)
    assert opened.page.locator("[aria-sort='descending'] >> visible=true").count() == 1
    ranked = visit(f"#set={LINK}").names()
    assert opened.names() != ranked
    assert sorted(opened.names()) == sorted(ranked)


def test_filters_leave_who_fits(visit: Open) -> None:
    opened = visit(f"#set={LINK}")
    everybody = opened.names()
    opened.page.select_option("#family", "kim2019")
    assert sorted(opened.names()) == ["pd-low", "pid-high"]
    opened.page.fill("#search", "pid")
    assert opened.names() == ["pid-high"]
    opened.page.fill("#search", "nobody")
    assert opened.names() == []
    assert opened.page.locator("#empty").is_visible()
    opened.page.fill("#search", "")
    opened.page.select_option("#family", "")
    assert opened.names() == everybody


def test_views_are_reached_by_keyboard(visit: Open) -> None:
    opened = visit(f"#set={LINK}&show=pid-high,pd-low")
    opened.page.focus("#tab-traces")
    opened.page.keyboard.press("ArrowRight")
    opened.page.wait_for_selector("#pareto svg circle")
    opened.page.keyboard.press("ArrowRight")
    opened.page.wait_for_selector("#numbers-table td")
    heads = opened.page.locator("#numbers-table thead th").all_inner_texts()
    assert heads == ["number", "pid-high", "pd-low"]


def test_the_theme_is_the_systems_until_it_is_changed(visit: Open) -> None:
    opened = visit(scheme="dark")
    background = "getComputedStyle(document.body).backgroundColor"
    dark = opened.page.evaluate(background)
    opened.page.click("#theme")
    assert opened.page.evaluate(background) == "rgb(255, 255, 255)" != dark


# The commands


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["page", "--from", "nowhere"], "there is no nowhere"),
        (["evaluate", "pid-high", "pd-low", "--report", "out"], "--report is about one compensator; 2 were given"),
        (["evaluate", "none", "--baselines", "none", "--report", "out"], "none"),
    ],
)
def test_what_cannot_be_shown_is_refused_at_once(
    arguments: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert told in done.output
    assert list(tmp_path.iterdir()) == []


def test_a_library_that_is_not_there_is_named_with_the_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(vendor, "UPLOT", {"uplot.js": ("youplot/nothing.js", "")})
    done = CliRunner().invoke(app, ["evaluate", "pid-high", "--report", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert "has no youplot/nothing.js; install what pages are made of with" in " ".join(done.output.split())
