"""Put the published leaderboard's summary into the README: `python docs/readme_table.py`."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from fo_gym.evaluation.tables import markdown, summary

ROOT = Path(__file__).parent.parent
BEGIN, END = "<!-- leaderboard: begin -->\n", "<!-- leaderboard: end -->\n"


def table() -> str:
    """The summary of leaderboard/leaderboard.csv as Markdown."""
    return markdown(summary(pd.read_csv(ROOT / "leaderboard" / "leaderboard.csv")))


def readme_with(text: str) -> str:
    """The README with `text` between its two marks."""
    before, _, rest = (ROOT / "README.md").read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    return before + BEGIN + "\n" + text + "\n" + END + after


if __name__ == "__main__":
    (ROOT / "README.md").write_text(readme_with(table()), encoding="utf-8", newline="\n")
