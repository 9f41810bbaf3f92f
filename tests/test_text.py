"""Names and messages of strangers are text in every output, whatever is in them."""

from __future__ import annotations

import csv as csv_module
import io
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from markdown_it.token import Token
from rich.console import Console
from tables import SQUARE, synthetic

from fo_gym.console import Stop, errors, progress_bar, say, text_table
from fo_gym.evaluation.competitors.competitor import SUBMISSION, YOURS, Competitor
from fo_gym.evaluation.competitors.entry import check_names
from fo_gym.evaluation.results.leaderboard import leaderboard
from fo_gym.evaluation.results.report import markdown_page
from fo_gym.evaluation.results.tables import explained, finding, markdown, marked, rankings, summary
from fo_gym.evaluation.runs.contest import Results
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.files import csv, read_csv
from fo_gym.text import (
    CELL_LIMIT,
    NAME_LIMIT,
    csv_cell,
    from_csv_cell,
    markdown_code,
    markdown_table,
    markdown_text,
    one_line,
    printable,
)

HOSTILE = (
    *("two\nlines", "carriage\rreturn", "a\x0bb\x0cc\x85d\u2028e", "a | b", r"a \| b", "| --- |", "back\\", r"\\\|"),
    *("<img src=x onerror=alert(1)>", "<!-- a", "<https://e.org>", "<=@e.org>", "&lt;b&gt;", "a < b <= c"),
    *(
        "# heading",
        "- item",
        "1. item",
        "> quote",
        "    code",
        "***",
        "===",
        "~~no~~",
        "*b* _e_ __b__ a_b_c",
        "_hidden",
    ),
    *("`code`", "``", "[link](https://e.org)", "![i](j)", "[a]: b", "https://e.org", "WWW.e.org", "a@e.org"),
    *("[bold red]x[/]", "[/]", r"\[b]", ":smile:", "[link=https://e.org]x[/link]"),
    *("\x1b[31mred\x1b[0m", "\x07\x00\x7f\x9b31m", "\u202egnp.exe", "\u2066a\u2069", "\ufeff", "z\u200bero", "\ud800"),
    *(
        "=1+1",
        "+1",
        "-1",
        "@SUM(A1)",
        "\t=1",
        "\r=1",
        "  =1",
        "'=1",
        "''-1",
        "'quoted'",
        "\uff1d1",
        '"q", r',
        "1,2",
        ";",
    ),
    *(
        "$x$",
        r"$\frac{",
        "$$",
        "a$b",
        r"\$",
        "\u89b3\u6e2c\u5668",
        "\U0001f600",
        "x" * 5000,
        "NA",
        "nan",
        "None",
        "true",
    ),
)
MARKUP = r"\`*_[]()<>|~$&:/w.=+-@' !#;12xh" + "\n\x1b"
MARKDOWN = MarkdownIt("commonmark", {"html": True}).enable(["table", "strikethrough"])


@pytest.fixture(scope="module")
def episodes() -> pd.DataFrame:
    """Episodes of competitors with these names, who failed with these messages."""
    frr = {name: [-0.5 - 0.001 * i] for i, name in enumerate(HOSTILE)}
    return synthetic(frr, "nominal").assign(status="failed", error=list(HOSTILE), origin="baseline")


@pytest.fixture(scope="module")
def table(episodes: pd.DataFrame) -> pd.DataFrame:
    """The leaderboard of these."""
    return leaderboard(episodes)


def cells_of(page: str) -> list[list[Token]]:
    """The rows of all tables of a page, as its reader's inline tokens; what is no table must be text, too."""
    rows: list[list[Token]] = []
    inside = False
    for token in MARKDOWN.parse(page):
        assert token.type not in ("html_block", "html_inline"), token.content
        inside = inside or token.type in ("th_open", "td_open")
        if token.type == "tr_open":
            rows.append([])
        if token.type == "inline" and inside:
            rows[-1].append(token)
            inside = False
    return rows


def shown(token: Token, *allowed: str) -> str:
    """The text of a cell, in which there is nothing else."""
    children = token.children or []
    assert {child.type for child in children} <= {"text", *allowed}, token.content
    return "".join(child.content for child in children)


def test_a_line_is_printable_and_bounded() -> None:
    wrong = [text for text in HOSTILE if not one_line(text).isprintable() or len(one_line(text, 40)) > 40]
    assert wrong == []
    assert one_line("a\nb\t\x1b\u202e\ud800") == r"a\nb\t\x1b\u202e\ud800"
    assert printable("a\nb\r") == "a\nb\\r"
    assert one_line("0123456789", 5) == "01…89"
    assert [text for text in HOSTILE if one_line(one_line(text)) != one_line(text)] == []


def test_cells_of_a_csv_file_start_no_formula_and_come_back() -> None:
    for text in HOSTILE:
        cell = csv_cell(text)
        assert cell.lstrip()[:1] not in tuple("=+-@\t\r\uff1d"), text
        assert from_csv_cell(cell) == one_line(text)
    assert (csv_cell("-0.5"), csv_cell("a-b"), csv_cell("'a"), csv_cell("'=")) == ("'-0.5", "a-b", "'a", "''=")


def test_a_csv_file_is_read_back(episodes: pd.DataFrame) -> None:
    """Numbers, below zero or none, stay numbers; texts come back as the lines that they are."""
    text = csv(episodes)
    lines = [one_line(name) for name in HOSTILE]
    read = read_csv(text)
    assert read["compensator"].tolist() == read["error"].tolist() == lines
    pd.testing.assert_series_equal(read["frr"], episodes["frr"])
    assert read["steady_state_error_ju"].isna().all()
    assert csv(read) == text
    as_text = read_csv(text, numbers=False)
    assert as_text["compensator"].tolist() == lines
    assert as_text["frr"].tolist()[:3] == ["-0.5", "-0.501", "-0.502"]
    # And anybody else's reader gets as many rows and cells as there are.
    rows = list(csv_module.reader(io.StringIO(text)))
    assert {len(row) for row in rows} == {episodes.shape[1]}
    assert len(rows) == len(HOSTILE) + 1 == len(text.splitlines())


@pytest.mark.parametrize("origin", ["baseline", SUBMISSION, YOURS])
def test_tables_in_markdown_show_names_and_messages_as_they_are(
    episodes: pd.DataFrame, table: pd.DataFrame, origin: str
) -> None:
    (ranking,) = rankings(episodes.assign(origin=origin), table.assign(origin=origin))
    headings, *rows = cells_of(markdown(ranking))
    assert [shown(cell) for cell in headings] == ranking.headings
    own = ("strong_open", "strong_close") if origin == YOURS else ()
    found = {tuple(shown(cell, *own) for cell in row) for row in rows}
    assert found == {tuple(cell.strip() for cell in row) for row in ranking.cells}
    names = {marked(name, origin).strip() for name in HOSTILE}
    assert {row[1] for row in found} == names
    assert max(map(len, names)) <= NAME_LIMIT + 2
    assert {shown(row[0], *own) for row in cells_of(markdown(summary(table.assign(origin=origin))))[1:]} == names


def test_the_page_is_the_tables_and_nothing_else(episodes: pd.DataFrame, table: pd.DataFrame) -> None:
    """Every heading, picture and link of the page is ours; protocol, authors and alternative texts are text."""
    title = "# x `y` <b> | z\n## w"
    protocol = Protocol(title, "validation", 1, (SQUARE,), ("nominal",), ("pd-low",))
    competitors = [Competitor("mine", "x:X", SUBMISSION, authors=HOSTILE, link="https://example.org/a")]
    episodes, table = episodes.assign(origin=SUBMISSION), table.assign(origin=SUBMISSION)
    page = markdown_page(protocol, Results(episodes, pd.DataFrame(), [], tuple(competitors)), table, [Path("a_b.png")])
    tokens = MARKDOWN.parse(page)
    inline = [child for token in tokens for child in token.children or [token]]
    assert [token.tag for token in tokens if token.type == "heading_open"] == ["h1", "h2", "h2", "h2"]
    assert [child.attrs["href"] for child in inline if child.type == "link_open"] == ["https://example.org/a"]
    assert [child.attrs["src"] for child in inline if child.type == "image"] == ["figures/a_b.png"]
    assert one_line(title) in "".join(child.content for child in inline)
    assert not {"html_block", "html_inline", "code_block", "fence", "hr", "s_open"} & {child.type for child in inline}
    assert explained(episodes) == "† submission"


def test_text_and_code_in_a_paragraph() -> None:
    for text in HOSTILE:
        (paragraph,) = (token for token in MARKDOWN.parse(f"x {markdown_text(text)} y") if token.type == "inline")
        assert shown(paragraph) == f"x {one_line(text)} y"
        (paragraph,) = (token for token in MARKDOWN.parse(f"x {markdown_code(text)} y") if token.type == "inline")
        assert [child.type for child in paragraph.children or []] == ["text", "code_inline", "text"], text
        assert (paragraph.children or [])[1].content == one_line(text)
    assert "`pid-low` is best" in finding(leaderboard(synthetic({"pid-low": [0.5]})), "randomized")


@given(st.text(st.sampled_from(MARKUP), max_size=12))
@settings(max_examples=300, deadline=None, derandomize=True)
def test_whatever_is_put_together_stays_text(text: str) -> None:
    assert from_csv_cell(csv_cell(text)) == one_line(text)
    _, row = cells_of(markdown_table(["a", "b"], [[markdown_text(text), "end"]]))
    assert [shown(cell) for cell in row] == [one_line(text).strip(), "end"]


def test_the_terminal_gets_what_can_be_printed(episodes: pd.DataFrame, table: pd.DataFrame) -> None:
    (ranking,) = rankings(episodes, table)
    wide = Console(width=4 * CELL_LIMIT, file=io.StringIO())
    with wide.capture() as captured:
        wide.print(text_table(*ranking))
        for text in HOSTILE:
            say(text, wide)
    lines = captured.get().splitlines()
    assert all(line.isprintable() for line in lines)
    assert sum(line.startswith("│") for line in lines) == len(HOSTILE)
    printed = "\n".join(lines)
    assert [name for name in HOSTILE if marked(name, "").strip() not in printed] == []
    assert [text for text in HOSTILE if printable(text).rstrip() not in printed] == []


def test_progress_and_errors_are_text_too() -> None:
    with errors.capture() as captured:
        with progress_bar(len(HOSTILE)) as advance:
            for text in HOSTILE:
                advance(text, 1)
        for text in HOSTILE:
            Stop(text)
    printed = captured.get()
    assert [text for text in HOSTILE if f"error: {printable(text)}".rstrip() not in printed] == []
    assert [text for text in HOSTILE if one_line(text).rstrip() not in printed] == []
    assert not {"\x1b", "\u202e", "\x07", "\x00", "\x9b", "\ud800"} & set(printed)


def test_two_names_that_look_the_same_are_refused() -> None:
    with pytest.raises(ValueError, match="two competitors are called"):
        check_names([Competitor("a\nb", "x:X"), Competitor(r"a\nb", "y:Y")])
