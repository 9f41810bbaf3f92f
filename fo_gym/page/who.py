"""Who the competitors are, for a reader: the family that they belong to, and a line about each."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.entry import shipped_entries
from fo_gym.evaluation.runs.trial import REFERENCES
from fo_gym.specs import BUILT_IN, is_ours, plug_in, spec_of

REFERENCE_FAMILY = "references"
_ABOUT = {
    "none": "No compensation: what friction does when nothing is done about it.",
    "ideal": "The same joint without friction and without anything else that disturbs it.",
    "bound": "The true disturbance as the estimate, one control period late: what no observer can beat.",
}

__all__ = ["REFERENCE_FAMILY", "Who", "everybody"]


@dataclass(frozen=True)
class Who:
    """A competitor, for a reader.

    Attributes:
        name: what the tables call it.
        family: the file of baselines/ that it is from, the file or package of somebody's own, or "references".
        about: one line, or "".
        link: where it is described, or "".
    """

    name: str
    family: str
    about: str
    link: str


def everybody(competitors: Iterable[Competitor]) -> Mapping[str, Who]:
    """The references and these competitors, by name."""
    return {each.name: _who(each) for each in (*REFERENCES, *competitors)}


def _who(competitor: Competitor) -> Who:
    if competitor.name in BUILT_IN:
        return Who(competitor.name, REFERENCE_FAMILY, _ABOUT[competitor.name], "")
    about = _about(competitor)
    if competitor.authors and not is_ours(competitor.spec):
        about = f"By {', '.join(competitor.authors).removesuffix('.')}."
    return Who(competitor.name, _family(competitor.spec), about, competitor.link)


def _family(spec: str) -> str:
    """The last part of the module, or the name of the file, in which it is."""
    named, entry = spec_of(spec), plug_in(spec)
    if entry is not None:
        return entry.module.removeprefix("baselines.").partition(".")[0]
    return Path(named.where).stem if named.kind == "file" else named.where.rpartition(".")[2] or spec


def _about(competitor: Competitor) -> str:
    """The first line of what it says of itself; of a stranger's code, which is not imported here, nothing."""
    entry = plug_in(competitor.spec)
    if entry is None or not is_ours(competitor.spec):
        return ""
    line = (inspect.getdoc(entry.load()) or "").partition("\n")[0]
    return f"{line.removesuffix('.')}, with tuned gains." if competitor.name in shipped_entries() else line
