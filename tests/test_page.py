"""The page in a real browser: what it shows is what was published and recorded, on any screen, for every reader."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from axe_playwright_python.sync_playwright import Axe
from pages import LINK, SQUARES, Open, chromium, run, visits, write_leaderboard
from playwright.sync_api import Browser

from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.store import Store
from fo_gym.files import read_csv
from fo_gym.page.build import plan_of
from fo_gym.page.recording import everybodys

pytestmark = pytest.mark.looks

HOW = ("--jobs", "1", "--documentation", "docs/")
VIEWS = ("", f"#set={LINK}&show=pid-low,pd-low", f"#set={SQUARES}&view=pareto", f"#set={SQUARES}&view=numbers")


@pytest.fixture(scope="module")
def published(tmp_path_factory: pytest.TempPathFactory, short_episodes: None) -> Path:
    folder = tmp_path_factory.mktemp("published")
    write_leaderboard(folder)
    return folder


@pytest.fixture(scope="module")
def site(published: Path, short_episodes: None) -> Path:
    folder = published.parent / "site"
    run("page", "--from", published, "--out", folder, "--store", published.parent / "store", *HOW)
    return folder


@pytest.fixture(scope="module")
def traces(published: Path, site: Path, short_episodes: None) -> dict[tuple[str, str, str], Trace]:
    """What the page was made of, out of the store."""
    store = Store(published.parent / "store", notice=print)
    found = everybodys(plan_of(published).traced, Processes(1), store)
    return {(trace.env, trace.variant, trace.compensator): trace for trace in found}


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as found:
        yield found


@pytest.fixture
def visit(browser: Browser, site: Path) -> Iterator[Open]:
    with visits(browser, site) as found:
        yield found


# What it shows


def test_every_number_of_the_tables_is_that_of_the_csv(visit: Open, published: Path) -> None:
    table = read_csv((published / "leaderboard.csv").read_text(encoding="utf-8"))
    page = visit().page
    for key in (LINK, SQUARES):
        env, variant = key.split("/")
        section = page.locator(f"section.ranking[data-key='{key}']")
        columns = section.locator("thead [data-sort]").evaluate_all("all => all.map((each) => each.dataset.sort)")
        rows = section.locator("tbody tr").evaluate_all(
            "rows => rows.map((row) => [row.dataset.name, [...row.cells].map((cell) => cell.dataset.value)])"
        )
        expected = table[(table["env"] == env) & (table["variant"] == variant)].set_index("compensator")
        assert {name for name, _ in rows} == set(expected.index)
        numbers = [column for column in columns if column in expected and column != "tied_group"]
        assert {"frr", "torque_roughness_ratio"} <= set(numbers)
        for name, cells in rows:
            told = {column: cells[columns.index(column)] for column in numbers}
            shown = [float(text) if text else np.nan for text in told.values()]
            assert shown == pytest.approx(list(expected.loc[name, numbers].astype(float)), rel=1e-12, nan_ok=True)


def test_the_table_can_be_downloaded_as_it_was_published(visit: Open, published: Path) -> None:
    opened = visit(f"#set={LINK}&search=pid")
    with opened.page.expect_download() as download:
        opened.page.click("#table-csv")
    rows = list(csv.DictReader(io.StringIO(Path(download.value.path()).read_text(encoding="utf-8"))))
    table = read_csv((published / "leaderboard.csv").read_text(encoding="utf-8"), numbers=False)
    env, variant = LINK.split("/")
    here = table[(table["env"] == env) & (table["variant"] == variant) & table["compensator"].str.contains("pid")]
    assert sorted(rows, key=lambda row: row["compensator"]) == here.sort_values("compensator").to_dict("records")


def test_a_click_shows_the_trace_that_was_recorded(visit: Open, traces: dict[tuple[str, str, str], Trace]) -> None:
    opened = visit(f"#set={LINK}")
    opened.wait_for_traces("none", opened.names()[0])
    for name in ("none", opened.names()[0]):
        opened.page.click(f"[aria-label='Take {name} out']")
    opened.page.click("tr[data-name='rl-adaptive'] >> visible=true")
    opened.wait_for_traces("rl-adaptive")
    assert "show=rl-adaptive" in opened.hash()
    with opened.page.expect_download() as download:
        opened.page.click("#traces-csv")
    shown = pd.read_csv(download.value.path())
    signals = traces[(*LINK.split("/"), "rl-adaptive")].signals  # type: ignore[index]
    assert set(shown["compensator"]) == {"rl-adaptive"}
    assert np.allclose(shown["time_s"], signals["time"], atol=1e-5)
    start = float(signals["theta_d"][0, 0])
    for column, name in (("theta", "theta"), ("ideal", "theta_ideal"), ("target", "theta_d")):
        expected = 1e3 * (signals[name][:, 0] - start)  # shown in mm from the first target
        assert np.allclose(shown[column], expected, atol=1e-4 * float(np.ptp(1e3 * signals["theta"])) + 1e-6)
    for name in ("tau_f", "tau_f_hat"):
        assert np.allclose(shown[name], signals[name][:, 0], atol=1e-4 * float(np.ptp(signals[name])) + 1e-6)


def test_what_a_compensator_says_besides_has_a_chart_of_its_own(visit: Open) -> None:
    opened = visit(f"#set={LINK}&show=pid-low,rl-adaptive")
    opened.wait_for_traces("pid-low", "rl-adaptive")
    chart = opened.page.locator("[data-chart='diagnostics']")
    assert "zero correction" in " ".join(chart.locator("figcaption").inner_text().split())
    opened.page.click("[aria-label='Take rl-adaptive out']")
    opened.wait_for_traces("pid-low")
    assert chart.count() == 0


def test_the_path_of_the_tool_is_shown_on_the_square(visit: Open) -> None:
    opened = visit(f"#set={SQUARES}&show=pid-low,none")
    opened.wait_for_traces("pid-low", "none")
    lines = opened.page.locator("svg.path .bright")
    before = lines.evaluate_all("all => all.map((each) => [each.dataset.name, each.getAttribute('d')])")
    assert [name for name, _ in before] == ["pid-low", "none"]
    opened.page.select_option("#magnified", "20")
    after = lines.evaluate_all("all => all.map((each) => each.getAttribute('d'))")
    assert all(old != new for (_, old), new in zip(before, after, strict=True))


def test_the_first_view_is_light(visit: Open, site: Path) -> None:
    opened = visit()
    opened.page.wait_for_load_state("networkidle")
    asked = {Path(url.removeprefix("file://").partition("#")[0]) for url in opened.asked if url.startswith("file:")}
    assert site / "vendor" / "uplot.js" in asked
    assert sum(path.stat().st_size for path in asked) < 1_500_000


def test_claims_and_provenance_are_told(visit: Open, published: Path) -> None:
    page = visit().page
    for name, file in (("claims", "paper/claims.csv"), ("certificate", "fidelity.csv")):
        table = read_csv((published / file).read_text(encoding="utf-8"))
        section = page.locator(f"#{name}")
        assert section.locator("li").count() == len(table)
        assert section.locator("li.fails").count() == int((table["verdict"] != "holds").sum())
        assert set(section.locator("li > p:first-child").all_text_contents()) == set(table["statement"])
    assert "small@" in page.locator("#provenance").inner_text()
    links = page.locator("#provenance a").evaluate_all("all => all.map((each) => each.getAttribute('href'))")
    assert "files/leaderboard.csv" in links


def test_maps_are_drawn_where_they_are_looked_at(visit: Open, site: Path) -> None:
    opened = visit()
    plotly = (site / "vendor" / "plotly.js").as_uri()
    opened.page.wait_for_load_state("networkidle")
    assert plotly not in opened.asked
    opened.page.locator("#maps").scroll_into_view_if_needed()
    opened.page.wait_for_selector("figure.map[data-drawn] .plot-container")
    assert plotly in opened.asked
    shown = opened.page.evaluate(
        "document.querySelector('figure.map .chart').data.map(({ z, x, text }) => [z, x, text])"
    )
    cells, marks = shown
    assert np.allclose(10.0 ** np.array(cells[0]), [[0.96, 0.92, 0.84], [0.8, 0.6, 0.2]])
    assert marks[1:] == [[10], ["low"]]


# What a reader does


def test_four_are_overlaid_and_the_first_goes(visit: Open) -> None:
    opened = visit(f"#set={LINK}&show=none")
    for name in ("pid-low", "pid-high", "pd-low", "rl-adaptive"):
        opened.page.click(f"tr[data-name='{name}'] button.name >> visible=true")
    opened.wait_for_traces("pid-low", "pid-high", "pd-low", "rl-adaptive")
    pressed = opened.page.locator("section.ranking:not([hidden]) [aria-pressed='true']")
    assert pressed.count() == 4


def test_all_charts_follow_a_zoom_and_the_address_keeps_it(visit: Open) -> None:
    opened = visit(f"#set={SQUARES}&show=pid-low")
    opened.wait_for_traces("pid-low")
    chart = opened.page.locator(".u-over").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    assert box
    middle = box["y"] + box["height"] / 2
    opened.page.mouse.move(box["x"] + 0.25 * box["width"], middle)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + 0.5 * box["width"], middle, steps=4)
    opened.page.mouse.up()
    opened.page.wait_for_function("location.hash.includes('&t=')")
    start, end = map(float, opened.hash().partition("&t=")[2].partition("&")[0].split("-"))
    assert (start, end) == pytest.approx((0.25, 0.5), abs=0.01)  # of an episode of 1 s
    line = opened.page.locator("svg.path .bright").get_attribute("d")
    again = visit(opened.hash())
    again.wait_for_traces("pid-low")
    assert again.page.locator("svg.path .bright").get_attribute("d") == line
    again.page.click("[data-time='all']")
    assert again.page.locator("svg.path .bright").get_attribute("d") != line
    assert "&t=" not in again.hash()


def test_a_question_leads_to_its_traces_with_the_answer(visit: Open) -> None:
    opened = visit()
    first = opened.page.locator(".story").first
    shown = first.get_attribute("href") or ""
    question = first.locator("strong").inner_text()
    first.click()
    names = shown.partition("show=")[2].partition("&")[0].split(",")
    opened.wait_for_traces(*names)
    assert opened.page.locator("#answer").inner_text().startswith(question)
    opened.page.wait_for_function("document.getElementById('answer').getBoundingClientRect().top < innerHeight / 2")
    more = opened.page.locator("#answer a").get_attribute("href") or ""
    assert more.startswith("docs/theory/hunting.html#why-the-")


# For every reader


@pytest.mark.parametrize("address", VIEWS)
def test_nothing_is_wider_than_a_phone(visit: Open, address: str) -> None:
    opened = visit(address, width=390)
    opened.page.wait_for_load_state("networkidle")
    assert opened.page.evaluate("document.documentElement.scrollWidth") == 390


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (390, "dark")])
def test_contrast_labels_and_roles_are_in_order(visit: Open, width: int, scheme: str) -> None:
    """By axe, on every view; whatever it finds is told."""
    for address in VIEWS:
        opened = visit(address, width=width, scheme=scheme)
        opened.page.wait_for_load_state("networkidle")
        found = Axe().run(opened.page, options={"preload": False}).response["violations"]
        told = [(each["id"], [node["html"][:100] for node in each["nodes"][:3]]) for each in found]
        assert told == [], json.dumps(told, indent=1)


# The files


def test_the_same_results_give_the_same_bytes(published: Path, site: Path, short_episodes: None) -> None:
    again = published.parent / "again"
    run("page", "--from", published, "--out", again, "--store", published.parent / "store", *HOW)
    files = {path.relative_to(site): path.read_bytes() for path in site.rglob("*") if path.is_file()}
    assert {path.relative_to(again): path.read_bytes() for path in again.rglob("*") if path.is_file()} == files
    assert not any(str(published) in data.decode(errors="replace") for data in files.values())
