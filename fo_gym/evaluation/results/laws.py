"""What a change of the friction law does to a ranking: competitors over laws, and which conclusions survive."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import pandas as pd

from fo_gym.evaluation.runs.contest import law_of_robot, laws_by_name
from fo_gym.evaluation.runs.episodes import label_of
from fo_gym.evaluation.runs.protocol import Protocol
from fo_gym.text import markdown_table, markdown_text

__all__ = ["Conclusion", "conclusions", "finding", "laws_page", "over_laws"]


class Conclusion(NamedTuple):
    """That one competitor is better than another, as the first law tells them apart.

    Attributes:
        place: the episodes.
        better, worse: names.
        under: of every other law: 1 where it says so too, 0 where it does not tell them apart, -1 where it says the
            opposite.
    """

    place: str
    better: str
    worse: str
    under: dict[str, int]


def over_laws(protocol: Protocol, table: pd.DataFrame) -> Iterator[tuple[str, dict[str, pd.DataFrame]]]:
    """Every set of episodes of a leaderboard's table, with its rows by law; the laws in the protocol's order.

    Args:
        protocol: whose laws they are.
        table: as `leaderboard` gives it.
    """
    laws = laws_by_name(protocol)
    pairs = [law_of_robot(name, laws) for name in table["robot"]]
    split = table.assign(robot=[robot for robot, _ in pairs], law=[law for _, law in pairs])
    for (env, robot, variant), rows in split.groupby(["env", "robot", "variant"], sort=False):
        found = {str(law): group.set_index("compensator") for law, group in rows.groupby("law", sort=False)}
        yield label_of(env, robot, variant), {law: found[law] for law in laws if law in found}


def conclusions(protocol: Protocol, table: pd.DataFrame) -> list[Conclusion]:
    """All pairs that the protocol's first law tells apart, and what the others say of them."""
    found = []
    for place, by_law in over_laws(protocol, table):
        first, *others = by_law
        for a, b in combinations(map(str, by_law[first].index), 2):
            if said := _order(by_law[first], a, b):
                better, worse = (a, b) if said > 0 else (b, a)
                under = {law: _order(by_law[law], better, worse) for law in others}
                found.append(Conclusion(place, better, worse, under))
    return found


def _order(rows: pd.DataFrame, a: str, b: str) -> int:
    """1 where a is better than b, -1 where it is worse, 0 where they are tied, or one has no rank, as references."""
    if rows["rank"].reindex([a, b]).isna().any() or set(rows["tied_group"][a]) & set(rows["tied_group"][b]):
        return 0
    return 1 if rows["rank"][a] < rows["rank"][b] else -1


def finding(protocol: Protocol, table: pd.DataFrame) -> str:
    """Two sentences on which conclusions survive a change of the law."""
    first, *others = laws_by_name(protocol)
    pairs = conclusions(protocol, table)
    if not pairs or not others:
        return f"Under {first} no two competitors are told apart. There is nothing that another law could change."
    whole = [pair for pair in pairs if all(said == 1 for said in pair.under.values())]
    turned = [pair for pair in pairs if any(said == -1 for said in pair.under.values())]
    share = f"{len(whole)} ({100 * len(whole) / len(pairs):.0f} %)"
    against = "none is turned round"
    if turned:
        law = next(law for law, said in turned[0].under.items() if said == -1)
        example = f"{turned[0].better} is better than {turned[0].worse} on {turned[0].place}, but not under {law}"
        against = f"{len(turned)} {'is' if len(turned) == 1 else 'are'} turned round under at least one ({example})"
    kept = {law: 100 * sum(pair.under[law] == 1 for pair in pairs) / len(pairs) for law in others}
    laws = ", ".join(f"{kept[law]:.0f} % under {law}" for law in others)
    return (
        f"Of {len(pairs)} pairs of competitors that {first} tells apart, {share} are told apart in the same order by "
        f"every other law, and {against}. One law at a time, these survive: {laws}; {_best(protocol, table)}."
    )


def _best(protocol: Protocol, table: pd.DataFrame) -> str:
    """Whether the best competitor stays the best, or tied with it."""
    stays, sets = 0, 0
    for _, by_law in over_laws(protocol, table):
        first, *others = by_law.values()
        best = first.index[first["rank"] == 1]
        if len(best):
            sets += 1
            stays += all(rows["verdict"].get(best[0]) in ("best", "tied") for rows in others)
    return f"who is best is best, or tied with the best, under every law on {stays} of {sets} sets of episodes"


def laws_page(protocol: Protocol, table: pd.DataFrame) -> str:
    """The page on laws: the finding, then a table of competitors over laws for each set of episodes."""
    parts = [
        "# Friction laws\n",
        f"{markdown_text(finding(protocol, table))}\n",
        "The same competitors on the same episodes, under laws that have the same steady friction and, as far as each "
        "can, the same presliding. FRR, interquartile mean over the episodes, and the letters of those who are not "
        "told apart under that law; best first under the first law. docs/friction.md says what each law can show.\n",
    ]
    for place, by_law in over_laws(protocol, table):
        first = next(iter(by_law.values()))
        order = map(str, first.sort_values("frr", ascending=False).index)
        cells = [[markdown_text(name), *(_cell(rows, name) for rows in by_law.values())] for name in order]
        parts += [f"## {markdown_text(place)}\n", markdown_table(["compensator", *by_law], cells) + "\n"]
    return "\n".join(parts)


def _cell(rows: pd.DataFrame, name: str) -> str:
    if name not in rows.index or pd.isna(rows["frr"][name]):
        return ""
    letters = rows["tied_group"].fillna("")[name]
    return f"{rows['frr'][name]:.4f} {letters}".rstrip()
