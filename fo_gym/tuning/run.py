"""All studies of a compensator, in parallel, and what they leave."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from fo_gym.checks import shown
from fo_gym.evaluation.competitors.entry import check_authors, check_name
from fo_gym.evaluation.runs.backends import Processes
from fo_gym.evaluation.runs.store import Store
from fo_gym.files import atomic, csv
from fo_gym.tuning.entry import authors_of, entry_text, spec_beside
from fo_gym.tuning.space import default_gains
from fo_gym.tuning.study import Case, Outcome, run_study

__all__ = ["check_tuning", "tune"]


def check_tuning(cases: Sequence[Case], name: str, authors: Sequence[str] = ()) -> tuple[str, ...]:
    """Who made the compensator, as `tune` credits them. Raises ValueError for what cannot be tuned so."""
    check_name("name", name)
    sets = [(case.env_id, case.variant) for case in cases]
    if len(set(sets)) < len(sets):
        raise ValueError(f"environments and variants are {shown(sets)}; name each environment and variant once")
    return check_authors("authors", authors or authors_of(cases[0].spec))


def tune(
    cases: Sequence[Case],
    name: str,
    out: Path,
    *,
    store: Store,
    command: str,
    authors: Sequence[str] = (),
    jobs: int = 1,
    on_case: Callable[[str], None] | None = None,
) -> tuple[list[Outcome], list[Path]]:
    """Run the studies of one compensator; write its entry and the tables of its trials.

    Args:
        cases: what is tuned, all of one compensator.
        name: of the entry.
        out: folder; NAME.toml and NAME/ENV-VARIANT.csv.
        store: keeps the trials of the studies, so that a search that was killed goes on.
        command: what the entry says it was made by.
        authors: who made the compensator; by default the project for its own, "unnamed" for others.
        jobs: worker processes; the result does not depend on it.
        on_case: called with a label after every study.

    Returns:
        What the studies found; the files.

    Raises:
        ValueError: the name or an author cannot stand in an entry, a case is there twice, the compensator declares no
            gains, or it took its process down.
    """
    spec, credited = cases[0].spec, check_tuning(cases, name, authors)
    default_gains(spec)  # what cannot be tuned is told before there are workers
    found: dict[int, Outcome] = {}
    for place, outcome in Processes(jobs).run(run_study, [(case, store) for case in cases]):
        if outcome is None:
            raise ValueError(f"compensator {spec!r} ended the process that it ran in")
        found[place] = outcome
        if on_case is not None:
            finals = outcome.trials["frr_validation"]
            case = outcome.case
            on_case(f"{case.env_id} {case.variant}: {finals[0]:.4f} -> {finals.max():.4f}")
    outcomes = [found[place] for place in range(len(cases))]
    written = []
    for outcome in outcomes:
        written.append(out / name / f"{outcome.case.env_id}-{outcome.case.variant}.csv")
        atomic(written[-1], csv(outcome.trials))
    written.append(out / f"{name}.toml")
    atomic(written[-1], entry_text(spec_beside(spec, out), credited, outcomes, command))
    return outcomes, written
