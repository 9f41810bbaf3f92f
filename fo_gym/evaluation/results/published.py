"""Published results: what they say, and what has to be run to compute some of them again."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fo_gym.checks import choice, instance, shown
from fo_gym.envs.registry import environment_of, known_environments
from fo_gym.evaluation.competitors.competitor import Competitor
from fo_gym.evaluation.competitors.entry import check_names, competitor_of
from fo_gym.evaluation.runs.contest import Contest, law_of_robot, laws_by_name, under_law
from fo_gym.evaluation.runs.episodes import KEY, SET, EpisodeSet
from fo_gym.evaluation.runs.protocol import Protocol, load_protocol, shipped_protocols
from fo_gym.files import read_csv
from fo_gym.friction import LAWS
from fo_gym.robots import robot_of, shipped_robots
from fo_gym.specs import BUILT_IN
from fo_gym.tasks.variants import VARIANTS

_ROW = [*KEY, "seed"]

__all__ = ["contests_of", "features_of", "published", "sampled"]


def _command(folder: Path) -> str:
    """What writes the files that are looked for."""
    return f"`fo-gym leaderboard --out {folder}`"


def published(folder: Path) -> pd.DataFrame:
    """The rows of episodes.csv, every cell as its text.

    Rows of before there was a column `processor` have "" in it: where they were computed is not known.

    Raises:
        ValueError: there is no such file, or it does not hold such rows.
    """
    file = folder / "episodes.csv"
    if not os.path.isfile(file):
        raise ValueError(f"there is no {file}; write one with {_command(folder)}")
    try:
        table = read_csv(file.read_text(encoding="utf-8"), numbers=False)
    except (ValueError, OSError) as error:  # pandas' own errors are ValueErrors
        raise ValueError(
            f"{file} cannot be read ({' '.join(str(error).split())}); write it again with {_command(folder)}"
        ) from error
    missing = [column for column in (*_ROW, "protocol", "competitor_hash") if column not in table]
    if missing or not len(table):
        raise ValueError(
            f"{file} has {len(table)} rows and lacks the columns {missing}; write it again with {_command(folder)}"
        )
    for column, allowed in (("env", known_environments()), ("variant", VARIANTS)):
        for value in table[column].unique():
            choice(f"{file}: {column}", value, allowed)
    for value in table["seed"][~table["seed"].str.fullmatch(r"\d{1,38}")]:
        raise ValueError(f"{file}: seed is {shown(value)}; it must be a whole number of at least 0")
    return table if "processor" in table else table.assign(processor="")


def features_of(folder: Path) -> Mapping[str, Mapping[str, str]]:
    """What processor.json says of the processors that computed the rows, by their names; nothing without the file.

    Raises:
        ValueError: it does not hold that.
    """
    file = folder / "processor.json"
    if not os.path.isfile(file):
        return {}
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        instance("what it holds", content, dict)
        for name, told in content.items():
            instance(f"{shown(name)} in it", told, dict)
        return {str(name): {str(key): str(value) for key, value in told.items()} for name, told in content.items()}
    except (ValueError, RecursionError, OSError) as error:
        raise ValueError(f"{file} cannot be read ({error}); remove it, or write it again with the rows") from error


def sampled(table: pd.DataFrame, sample: int, seed: int) -> pd.DataFrame:
    """The runs that a random sample of rows belongs to, whole: a run is what can be run again.

    Args:
        table: as `published` gives it.
        sample: number of rows that are drawn; all where there are not so many.
        seed: of the draw.
    """
    chosen = np.random.default_rng(seed).choice(len(table), size=min(sample, len(table)), replace=False)
    runs = table.iloc[chosen][KEY].drop_duplicates()
    return table.merge(runs, on=KEY)


def _protocol_of(table: pd.DataFrame, protocol: str | Path | None) -> Protocol | None:
    """The protocol of these rows: the one that is named, or the shipped one of their name."""
    stamp = str(table["protocol"].iloc[0]).partition("@")[0]
    file = protocol if protocol is not None else stamp if stamp in shipped_protocols() else None
    return None if file is None else load_protocol(file)


def _arguments(env_id: str, robot: str, protocol: Protocol | None) -> dict[str, Any]:
    """Arguments of the environment that bring it the robot of a row, under the law that its name tells.

    Args:
        env_id: of the environment.
        robot: as the row calls it.
        protocol: that of the rows, whose robots and laws are known besides the project's own.

    Raises:
        ValueError: the robot is not known here.
    """
    environment = environment_of(env_id)
    robots = {} if protocol is None else protocol.robots
    if robot == environment.robot_name:
        return {}
    if robot in robots or robot in shipped_robots():
        return {"robot": replace(robot_of(robots.get(robot, robot)), name=robot)}
    laws = {name: name for name in LAWS} | ({} if protocol is None else laws_by_name(protocol))
    own, law = law_of_robot(robot, laws)
    if own != robot:
        given = _arguments(env_id, own, protocol)
        return {"robot": under_law(given.get("robot", environment.robot), laws[law])}
    raise ValueError(
        f"robot {shown(robot)} is not known here; name the protocol that lists it, or run this where its file is"
    )


def _known(submissions: Sequence[Competitor], protocol: Protocol | None) -> dict[str, Competitor]:
    """Competitors by the names that the rows give them: submissions, and entries that the protocol names by path."""
    named = [] if protocol is None else [competitor_of(name) for name in protocol.compensators]
    everybody = [*(each for each in named if each.name not in BUILT_IN), *submissions]
    check_names(everybody)
    return {each.name: each for each in everybody}


def _hash_of(rows: pd.DataFrame, name: str) -> str:
    return str(rows.loc[rows["compensator"] == name, "competitor_hash"].iloc[0])


def contests_of(
    table: pd.DataFrame, submissions: Sequence[Competitor] = (), protocol: str | Path | None = None
) -> list[Contest]:
    """What has to be run to compute these rows again.

    Args:
        table: whole runs, as `sampled` gives them.
        submissions: competitors that are not known by their name.
        protocol: that of the rows; by default the shipped one of their name.

    Raises:
        ValueError: the protocol or an entry cannot be read, or a competitor is nowhere.
    """
    source = _protocol_of(table, protocol)
    known = _known(submissions, source)
    contests = []
    for key, rows in table.groupby(SET, sort=False):
        env_id, robot, variant = (str(part) for part in key)
        seeds = tuple(int(seed) for seed in rows["seed"].unique())
        names = [str(name) for name in rows["compensator"].unique() if name not in BUILT_IN]
        competitors = tuple(known.get(name) or competitor_of(name) for name in names)
        for each, content in zip(competitors, (_hash_of(rows, name) for name in names), strict=True):
            if content and not each.content.files:
                raise ValueError(
                    f"competitor {shown(each.name)} is not known here; install its package, run this where its file "
                    "is, or name its entry: the folder of submissions, or the protocol that lists it"
                )
        contests.append(Contest(EpisodeSet(env_id, variant, seeds, _arguments(env_id, robot, source)), competitors))
    return contests
