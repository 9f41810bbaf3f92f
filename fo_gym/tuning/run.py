"""All studies of a compensator, in parallel, and what they leave."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from joblib import Parallel, delayed

from fo_gym.files import atomic, csv
from fo_gym.tuning.entry import entry_text
from fo_gym.tuning.study import Case, Outcome, run_study

__all__ = ["tune"]


def tune(
    cases: Sequence[Case], name: str, out: Path, *, jobs: int = 1, on_case: Callable[[str], None] | None = None
) -> tuple[list[Outcome], list[Path]]:
    """Run the studies of one compensator; write its entry and the tables of its trials.

    Args:
        cases: what is tuned, all of one compensator.
        name: of the entry.
        out: folder; NAME.toml, NAME/ENV-VARIANT.csv, and the journals of the studies.
        jobs: worker processes; the result does not depend on it.
        on_case: called with a label after every study.

    Returns:
        What the studies found; the files.
    """
    outcomes: list[Outcome] = []
    parallel = Parallel(n_jobs=jobs, return_as="generator", inner_max_num_threads=1)
    for outcome in parallel(delayed(run_study)(case, out / name / "journals") for case in cases):
        outcomes.append(outcome)
        if on_case is not None:
            finals = outcome.trials["frr_validation"]
            case = outcome.case
            on_case(f"{case.env_id} {case.variant}: {finals[0]:.4f} -> {finals.max():.4f}")
    written = []
    for outcome in outcomes:
        written.append(out / name / f"{outcome.case.env_id}-{outcome.case.variant}.csv")
        atomic(written[-1], csv(outcome.trials))
    case = cases[0]
    command = f"fo-gym tune {case.spec} --name {name} --trials {case.trials} --episodes {case.episodes}"
    written.append(out / f"{name}.toml")
    atomic(written[-1], entry_text(case.spec, outcomes, f"{command} --seed {case.seed}"))
    return outcomes, written
