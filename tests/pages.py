"""A small leaderboard that was really run, its page, and a browser to look at it, for the tests of the page."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright
from tables import SQUARE, STICTION
from typer.testing import CliRunner

from fo_gym.cli import app
from fo_gym.evaluation.results.report import write_results
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.evaluation.runs.run import run_protocol

NAMES = ("pid-low", "pid-high", "pd-low", "letien-high", "rl-adaptive")
LINK, SQUARES = f"{STICTION}/nominal", f"{SQUARE}/randomized"


def run(*arguments: str | Path) -> str:
    """What a command printed; it must not fail."""
    done = CliRunner().invoke(app, [str(each) for each in arguments], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.output


def write_leaderboard(folder: Path) -> None:
    """Publish five competitors on two environments in two variants, with claims and a map."""
    protocol = Protocol("small", "validation", 2, (STICTION, SQUARE), ("nominal", "randomized"), NAMES)
    write_results(protocol, run_protocol(protocol), folder)
    cells = [(f"{low}", f"{high}", "ok", f"{low * high / 250}") for low in (10, 20, 40) for high in (1, 5)]
    write_map(folder / "maps" / "pid over gains", cells)
    published = Path(__file__).parents[1] / "leaderboard"
    (folder / "paper").mkdir()
    shutil.copy(published / "paper" / "claims.csv", folder / "paper" / "claims.csv")
    shutil.copy(published / "fidelity.csv", folder / "fidelity.csv")


def write_map(folder: Path, cells: Iterable[tuple[str, str, str, str]], **drawing: object) -> None:
    """Publish a map of FRR over L and Li, as `fo-gym map` writes it.

    Args:
        folder: of the map.
        cells: L, Li, status and FRR of each; without any there is no table.
        drawing: what is told otherwise of what is drawn.
    """
    folder.mkdir(parents=True)
    told = {"x": "L", "y": "Li", "metric": "frr", "points": {"low": [10, 5]}, "line": [], "line_name": "", **drawing}
    (folder / "map.json").write_text(json.dumps(told), encoding="utf-8")
    lines = [f"{STICTION},single_link,nominal,pid,{L},{Li},{status},{frr},m\n" for L, Li, status, frr in cells]
    head = "env,robot,variant,compensator,L,Li,status,frr,joint_unit\n"
    if lines:
        (folder / "map.csv").write_text(head + "".join(lines), encoding="utf-8")


@contextmanager
def chromium() -> Iterator[Browser]:
    """The system's own browser, without a window."""
    found = shutil.which("chromium") or shutil.which("google-chrome")
    assert found, "there is no chromium; sh .ci/system-packages installs it"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield browser
        browser.close()


class Visit:
    """A page that was opened, what it complained about, and the files that it asked for."""

    def __init__(
        self, browser: Browser, site: Path, address: str = "", width: int = 1280, scheme: str = "light"
    ) -> None:
        self.site = site
        self.complaints: list[str] = []
        self.asked: list[str] = []
        self.page: Page = browser.new_page(viewport={"width": width, "height": 600}, color_scheme=scheme)  # type: ignore[arg-type]
        self.page.on("console", lambda message: self.complaints.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.open(address)

    def open(self, address: str) -> None:
        """Go to another address of the page, as a reader who was sent it."""
        self.page.goto("about:blank")
        self.page.goto(f"{(self.site / 'index.html').as_uri()}{address}")

    def names(self) -> list[str]:
        """Who stands in the table that is shown, from top to bottom."""
        rows = self.page.locator("section.ranking:not([hidden]) tbody tr:not([hidden])")
        return [str(name) for name in rows.evaluate_all("rows => rows.map((row) => row.dataset.name)")]

    def wait_for_traces(self, *names: str) -> None:
        """Wait until the charts show just these."""
        self.page.wait_for_selector(f"#charts[data-shown='{','.join(names)}'] .uplot canvas")

    def hash(self) -> str:
        """What the address says after the page."""
        return str(self.page.evaluate("decodeURIComponent(location.hash)"))


Open = Callable[..., Visit]


@contextmanager
def visits(browser: Browser, site: Path) -> Iterator[Open]:
    """Opens the page; at the end it must not have complained, nor asked for anything outside its folder."""
    opened: list[Visit] = []

    def open_page(address: str = "", **screen: object) -> Visit:
        opened.append(Visit(browser, site, address, **screen))  # type: ignore[arg-type]
        return opened[-1]

    yield open_page
    for each in opened:
        assert each.complaints == []
        assert [url for url in each.asked if not url.startswith((site.as_uri(), "data:", "blob:", "about:"))] == []
        each.page.close()
