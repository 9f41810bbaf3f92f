"""Put the published tables' summaries into the README: `python docs/readme_tables.py`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pandas as pd

from fo_gym.evaluation.tables import Ranking, markdown, summary
from fo_gym.reproduction.report import PLACES, counts, tolerance
from fo_gym.reproduction.run import FAILS, HOLDS

ROOT = Path(__file__).parent.parent


def leaderboard() -> str:
    """The summary of leaderboard/leaderboard.csv as Markdown."""
    return markdown(summary(pd.read_csv(ROOT / "leaderboard" / "leaderboard.csv")))


def _published(name: str) -> pd.DataFrame:
    return pd.read_csv(ROOT / "leaderboard" / f"{PLACES[name]}.csv").fillna({"unit": ""})


def claims() -> str:
    """How many claims of the paper hold, and those that do not."""
    table = _published("claims")
    cells = [
        [row["statement"], f"{row['number']:.3g} {row['unit']}".strip(), tolerance(row["low"], row["high"])]
        for row in table[table["verdict"] == FAILS].to_dict("records")
    ]
    failed = markdown(Ranking("", ["what does not hold", "measured", "it would hold at"], cells))
    return f"What the paper says: {counts(table)}.\n\n{failed}"


def fidelity() -> str:
    """The certificate, by what the plant is held against."""
    table = _published("fidelity")
    held = table["verdict"] == HOLDS
    cells = [
        [str(source), str(len(rows)), str(int(held[rows.index].sum()))]
        for source, rows in table.groupby("source", sort=False)
    ]
    return f"The physics: {counts(table)}.\n\n" + markdown(Ranking("", ["held against", "statements", "hold"], cells))


BLOCKS: dict[str, Callable[[], str]] = {"leaderboard": leaderboard, "claims": claims, "fidelity": fidelity}
"""What stands between the marks of each name in the README."""


def readme() -> str:
    """The README with every block as the published tables have it."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for name, block in BLOCKS.items():
        begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = before + begin + "\n" + block() + "\n" + end + after
    return text


if __name__ == "__main__":
    (ROOT / "README.md").write_text(readme(), encoding="utf-8", newline="\n")
