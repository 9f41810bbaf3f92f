"""Put the published tables' summaries into the README and the pages of docs/: `python docs/tables.py`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from learning.tables import LEARNING  # beside this file

from baselines.rl.study.summary import page as how_far
from fo_gym.bench.report import write_page
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.metrics.registry import HEADLINE
from fo_gym.evaluation.results.laws import finding as over_laws
from fo_gym.evaluation.results.tables import Ranking, explained, finding, markdown, summary
from fo_gym.evaluation.runs.episodes import SET
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.files import read_csv
from fo_gym.reproduction.report import PLACES, counts
from fo_gym.reproduction.wording import FAILS, HOLDS, tolerance

ROOT = Path(__file__).parent.parent


def leaderboard() -> str:
    """The summary of leaderboard/leaderboard.csv as Markdown, with what its marks mean."""
    table = _csv("leaderboard/leaderboard.csv")
    marks = explained(table)
    return markdown(summary(table)) + (f"\n{marks}\n" if marks else "")


def one_variant() -> str:
    """The same for the variant that comes closest to a robot alone."""
    table = _csv("leaderboard/leaderboard.csv")
    return markdown(summary(table[table["variant"] == "hardware"]))


def hardware() -> str:
    """What the leaderboard says about robots as they are, in two sentences."""
    return finding(_csv("leaderboard/leaderboard.csv"), "hardware") + "\n"


def laws() -> str:
    """Which conclusions survive a change of the friction law, in two sentences."""
    return over_laws(load_protocol("laws"), _csv("leaderboard/laws/leaderboard.csv")) + "\n"


def _csv(name: str) -> pd.DataFrame:
    return read_csv((ROOT / name).read_text(encoding="utf-8"))


def _published(name: str) -> pd.DataFrame:
    return _csv(f"leaderboard/{PLACES[name]}.csv").fillna({"unit": ""})


def claims() -> str:
    """How many claims of the paper hold, and those that do not."""
    table = _published("claims")
    cells = [
        [row["statement"], f"{row['number']:.3g} {row['unit']}".strip(), tolerance(row["low"], row["high"])]
        for row in table[table["verdict"] == FAILS].to_dict("records")
    ]
    failed = markdown(Ranking("", ["what does not hold", "measured", "it would hold at"], cells))
    return f"What the paper says: {counts(table)}.\n\n{failed}"


def panels() -> str:
    """What the paper's simulation shows, as it was measured."""
    table = _published("claims")
    table = table[table["id"].str.startswith("panel-")]
    cells = [
        [row["statement"], row["measured"].partition(";")[0], f"{row['number']:.3g} {row['unit']}".strip()]
        for row in table.to_dict("records")
    ]
    return markdown(Ranking("", ["what happens", "measured as", "number"], cells))


def fidelity() -> str:
    """The certificate, by what the plant is held against."""
    table = _published("fidelity")
    held = table["verdict"] == HOLDS
    cells = [
        [str(source), str(len(rows)), str(int(held[rows.index].sum()))]
        for source, rows in table.groupby("source", sort=False)
    ]
    return f"The physics: {counts(table)}.\n\n" + markdown(Ranking("", ["held against", "statements", "hold"], cells))


def speed() -> str:
    """What docs/bench/bench.csv says of everything that has a bar."""
    table = _csv("docs/bench/bench.csv").dropna(subset=["ratio", "bar"])
    columns = ["env", "measured", "beside", "num_envs", "ratio", "bar", "verdict"]
    cells = [[_cell(row[column]) for column in columns] for row in table.to_dict("records")]
    return markdown(Ranking("", ["environment", "measured", "beside", "environments", *columns[4:]], cells))


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.3g}"
    return str(value)


def _differences() -> pd.DataFrame:
    """docs/processors/differences.csv, with the variants of exact sensors counted as one."""
    table = _csv("docs/processors/differences.csv")
    return table.assign(kind=table["variant"].where(table["variant"] == "hardware", "exact"))


def tolerances() -> str:
    """Each metric's tolerance beside the largest difference between instruction sets, where that was measured."""
    largest = _differences().groupby(["metric", "kind"])[["calm_largest", "chaotic_largest"]].max()
    cells = []
    for name, metric in METRICS.items():
        if metric.share:
            continue  # 1 or 0: no digits that could differ
        exact, hardware = (largest["calm_largest"].get((name, kind)) for kind in ("exact", "hardware"))
        both = largest[largest.index.get_level_values("metric") == name]["chaotic_largest"]
        numbers = (
            exact,
            metric.tolerance.exact,
            hardware,
            metric.tolerance.hardware,
            both.max() if len(both) else None,
        )
        cells.append([name, metric.unit_text, *("" if each is None else f"{each:.1e}" for each in numbers)])
    headings = ["metric", "unit", "exact sensors", "tolerance", "hardware", "tolerance", "chaotic episodes"]
    return markdown(Ranking("", headings, cells))


def chaotic() -> str:
    """How many episodes are chaotic, by environment, variant and instruction set."""
    table = _differences()
    table = table[table["metric"] == HEADLINE]
    sets = list(dict.fromkeys(table["instruction_set"]))
    cells = []
    for (env, _, variant), rows in table.groupby(SET, sort=False):
        counts = rows.set_index("instruction_set")["chaotic"]
        cells.append([str(env), str(variant), str(rows["episodes"].iloc[0]), *(str(counts[name]) for name in sets)])
    return markdown(Ranking("", ["environment", "variant", "episodes", *(f"chaotic, {name}" for name in sets)], cells))


def measured(page: str, name: str) -> str:
    """A table of a page's folder, as it was measured."""
    table = _csv(f"docs/{page}/{name}.csv")
    cells = [[_cell(value) for value in row] for row in table.itertuples(index=False)]
    return markdown(Ranking("", list(table), cells))


def study() -> str:
    """The study of RL algorithms, as far as it went."""
    return how_far(_csv("docs/agents/table.csv"))


PAGES: dict[str, dict[str, Callable[[], str]]] = {
    "README.md": {"leaderboard": one_variant},
    "docs/leaderboard.md": {"leaderboard": leaderboard, "hardware": hardware},
    "docs/theory/hunting.md": {"panels": panels},
    "docs/reproduction.md": {"claims": claims, "fidelity": fidelity},
    "docs/performance.md": {"speed": speed},
    "docs/arm.md": {name: partial(measured, "arm", name) for name in ("verdicts", "randomized", "sensitivity")},
    "docs/baselines.md": {name: partial(measured, "baselines", name) for name in ("drift", "shares", "adaptive")},
    "docs/processors.md": {"tolerances": tolerances, "chaotic": chaotic},
    "docs/friction.md": {"laws": laws},
    "docs/learning.md": LEARNING,
    "docs/agents.md": {"study": study},
}
"""What stands between the marks of each name in each page."""


def page(name: str) -> str:
    """The page with every block as the published tables have it."""
    text = (ROOT / name).read_text(encoding="utf-8")
    for block, content in PAGES[name].items():
        begin, end = f"<!-- {block}: begin -->\n", f"<!-- {block}: end -->\n"
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = before + begin + "\n" + content() + "\n" + end + after
    return text


if __name__ == "__main__":
    for name in PAGES:
        (ROOT / name).write_text(page(name), encoding="utf-8", newline="\n")
    write_page(ROOT / "docs/bench")
