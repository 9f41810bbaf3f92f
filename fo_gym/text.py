r"""Text that others wrote (names, error messages) made safe to show: on a screen, in Markdown, in a CSV file.

What cannot be printed is shown as Python would write it, such as `\n`, `\x1b` or `\u202e`: line ends, control
characters, marks that turn the direction of writing around, and halves of characters that no file can hold.
"""

from __future__ import annotations

import re

NAME_LIMIT, MESSAGE_LIMIT, CELL_LIMIT = 60, 300, 1000
"""How many characters are shown of a name and of a message, and kept of a text in a CSV file."""

# What Markdown takes for markup within a line: of "<" not "less than", of "_" not that inside a word, of "]" only that
# before "(", and what would make a link of a bare address.
_MARKUP = re.compile(r"[\\`*|~$&]|<(?!=? )|(?<![^\W_])_|_(?![^\W_])|\](?=\()|:(?=//)|(?<=www)\.", re.IGNORECASE)
# What spreadsheets take for a formula, also in full width or after spaces; "'" tells them that it is text.
_FORMULA = re.compile("'* *[=+\\-@\uff1d\uff0b\uff0d\uff20]")

__all__ = [
    "CELL_LIMIT",
    "MESSAGE_LIMIT",
    "NAME_LIMIT",
    "csv_cell",
    "from_csv_cell",
    "markdown_code",
    "markdown_table",
    "markdown_text",
    "one_line",
    "printable",
]


def printable(text: str) -> str:
    """The text with everything that cannot be printed, line ends excepted, written as an escape."""
    return "".join(char if char.isprintable() or char == "\n" else _escape(char) for char in text)


def _escape(char: str) -> str:
    return char.encode("unicode_escape").decode("ascii")


def one_line(text: str, limit: int = CELL_LIMIT) -> str:
    """The text in one printable line of at most `limit` characters, without its middle where it is longer.

    The end stays, since names may differ only there: the paths of two files in one folder.
    """
    line = printable(text).replace("\n", "\\n")
    if len(line) <= limit:
        return line
    end = (limit - 1) // 2
    return f"{line[: limit - 1 - end]}…{line[-end:]}"


def csv_cell(text: str) -> str:
    """The text for a cell of a CSV file: in one line, and no spreadsheet takes it for a formula.

    Where it would begin as a formula does (= + - @), it gets a "'" in front, and so do those that have one already, so
    that `from_csv_cell` gives back every line of at most `CELL_LIMIT` characters. Quotes and commas are for who writes
    the file.
    """
    line = one_line(text)
    return f"'{line}" if _FORMULA.match(line) else line


def from_csv_cell(cell: str) -> str:
    """The line from which `csv_cell` made this cell."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell


def markdown_text(text: str) -> str:
    """The text in one line of Markdown that shows it as it is: no markup, no HTML, no links, no end of a table's cell.

    It must not stand at the beginning of a line, where other characters would have a meaning.
    """
    return _MARKUP.sub(lambda found: f"\\{found[0]}", one_line(text))


def markdown_code(text: str) -> str:
    """The text in one line of Markdown as code, not for tables: "|" ends their cells in code, too."""
    line = one_line(text)
    fence = "`" * (1 + max((len(run) for run in re.findall("`+", line)), default=0))
    space = " " if line.startswith("`") or line.endswith("`") else ""
    return f"{fence}{space}{line}{space}{fence}"


def markdown_table(headings: list[str], rows: list[list[str]]) -> str:
    """A table of cells that are Markdown already."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"
