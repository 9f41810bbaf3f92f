"""Measure how far results differ between instruction sets: `python docs/processors/measure.py`.

Runs docs/processors/protocol.toml as each instruction set of elsewhere.py computes (to build/processors/; what is there
in the store is not computed again), holds all against "native" as `fo-gym verify` does, perturbed twins included, and
writes docs/processors/differences.csv: how many episodes there are and how many of them are chaotic, and the 99th
percentile and the largest difference of each metric, of calm episodes and of chaotic ones.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from elsewhere import environment, instruction_sets

from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.results.published import contests_of, published
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.comparison import CHAOTIC, MISMATCH, Comparison, compared
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.evaluation.runs.run import run_protocol
from fo_gym.evaluation.runs.store import Store
from fo_gym.evaluation.runs.verify import key_of_row, rows_of, twin_contests, with_twins
from fo_gym.files import atomic, csv

HERE = Path(__file__).parent
PROTOCOL = HERE / "protocol.toml"
BUILD = Path("build/processors")


def compute(name: str) -> None:
    """Run the protocol in this process, which computes as the instruction set of this name; all digits are written."""
    store = Store(Path("build/store"), notice=print)
    episodes = run_protocol(load_protocol(PROTOCOL), jobs=-1, store=store).episodes
    atomic(BUILD / name / "episodes.csv", episodes.to_csv(index=False))


def run(name: str) -> pd.DataFrame:
    """The rows of the protocol as an instruction set computes them, every cell as its text."""
    subprocess.run([sys.executable, __file__, name], env=environment(name), check=True)
    return published(BUILD / name)


def comparisons(native: pd.DataFrame, other: pd.DataFrame) -> list[Comparison]:
    """Every row of another instruction set beside ours, and beside its twins where it asks for them."""
    ours = {key_of_row(row): row for row in rows_of(native)}
    found = [compared(key_of_row(row), row, ours[key_of_row(row)]) for row in rows_of(other)]
    twins = twin_contests(found, contests_of(native, protocol=PROTOCOL))
    return with_twins(found, twins, backend=Processes(-1))


def differences(found: Sequence[Comparison]) -> pd.DataFrame:
    """How far every metric of every episode differs, with the key of its row."""
    table = []
    for each in found:
        told = {cell.column: cell.size for cell in each.differences}
        for name in METRICS:
            table.append([*each.row, each.verdict == CHAOTIC, name, told.get(name, 0.0)])
    return pd.DataFrame(
        table, columns=["env", "robot", "variant", "compensator", "seed", "chaotic", "metric", "difference"]
    )


def check(name: str, found: Sequence[Comparison]) -> None:
    """Tell what is beyond tolerance. Raises SystemExit where twins do not explain it."""
    for each in found:
        if each.beyond:
            print(name, each.verdict, *each.row, "; ".join(map(str, each.beyond)))
    wrong = [" ".join(each.row) for each in found if each.verdict == MISMATCH]
    if wrong:
        sys.exit(f"{name}: neither within tolerance nor chaotic: {'; '.join(wrong)}; see docs/processors.md")


def summary(name: str, found: Sequence[Comparison]) -> pd.DataFrame:
    """The rows of differences.csv for one instruction set."""
    table = []
    for (metric, env, robot, variant), rows in differences(found).groupby(
        ["metric", "env", "robot", "variant"], sort=False
    ):
        calm, chaotic = rows.loc[~rows["chaotic"], "difference"], rows.loc[rows["chaotic"], "difference"]
        table.append(
            {
                "instruction_set": name,
                "metric": metric,
                "env": env,
                "robot": robot,
                "variant": variant,
                "episodes": len(rows),
                "chaotic": len(chaotic),
                "calm_p99": np.nanpercentile(calm, 99.0),
                "calm_largest": calm.max(),
                "chaotic_largest": chaotic.max(),
            }
        )
    return pd.DataFrame(table)


def main() -> None:
    """All instruction sets of this machine."""
    native, *others = instruction_sets()
    ours = run(native)
    parts = []
    for name in others:
        found = comparisons(ours, run(name))
        check(name, found)
        parts.append(summary(name, found))
    atomic(HERE / "differences.csv", csv(pd.concat(parts)))


if __name__ == "__main__":
    compute(sys.argv[1]) if len(sys.argv) > 1 else main()
