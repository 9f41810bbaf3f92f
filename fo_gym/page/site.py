"""Write the page: one folder that works from a web server and from a disk, with no network."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib import import_module
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
import pandas as pd

from fo_gym.envs.registry import environment_of
from fo_gym.evaluation.episode.trace import Trace
from fo_gym.evaluation.metrics import METRICS
from fo_gym.evaluation.runs.provenance import is_provenance, is_reference
from fo_gym.files import atomic, csv, read_csv
from fo_gym.page.board import Ranking, key_of, overview, rankings, slug
from fo_gym.page.maps import Map
from fo_gym.page.packing import script, trace_script
from fo_gym.page.statements import Statements
from fo_gym.page.stories import stories
from fo_gym.page.summary import Summary
from fo_gym.page.vendor import plotly, uplot
from fo_gym.page.who import REFERENCE_FAMILY, Who
from fo_gym.text import NAME_LIMIT, one_line

_STATIC = Path(str(files("fo_gym.page") / "static"))
_PARTS = ("data", "files", "vendor")
"""Folders of a page, which the next one replaces."""
_SCRIPTS = ("vendor/uplot.js", "core.js", "data/index.js", "table.js", "panel.js", "path.js", "traces.js", "pareto.js")

__all__ = ["Content", "write_site"]


@dataclass(frozen=True)
class Content:
    """What a page shows.

    Attributes:
        table: rows as `leaderboard` gives them.
        who: everybody by name.
        gains: of everybody by (env, robot, variant, name), as text.
        traces: of everybody in the same episodes.
        statements: claims and certificate, where they are at hand.
        maps: maps, where there are some.
        summary: in a report, what it says of the reader's own.
        files: what can be downloaded, by name.
        documentation: address of the project's documentation, without a slash at its end; "" where there is none.
    """

    table: pd.DataFrame
    who: Mapping[str, Who]
    gains: Mapping[tuple[str, str, str, str], str]
    traces: Sequence[Trace] = ()
    statements: Sequence[Statements] = ()
    maps: Sequence[Map] = ()
    summary: Summary | None = None
    files: Mapping[str, bytes] = field(default_factory=dict)
    documentation: str = ""


def write_site(content: Content, out: Path) -> Path:
    """Write the page into a folder, of which only what an earlier page left is removed.

    Args:
        content: what it shows.
        out: the folder.

    Returns:
        The page.

    Raises:
        MissingPackageError: a chart library is not at hand.
        ValueError: the folder holds what no page left there.
    """
    vendored = {f"vendor/{name}": data for name, data in uplot().items()}
    if content.maps:
        vendored["vendor/plotly.js"] = plotly()
    shown = list(rankings(content.table, content.who))
    _clear(out)
    for path in sorted(_STATIC.iterdir()):
        atomic(out / path.name, path.read_bytes())
    for name, data in {**vendored, **{f"files/{name}": data for name, data in content.files.items()}}.items():
        atomic(out / name, data)
    for name, text in _data(content, shown).items():
        atomic(out / name, text)
    page = out / "index.html"
    atomic(page, _html(content, shown))
    return page


def _clear(out: Path) -> None:
    """Remove what an earlier page left. Raises ValueError for a folder that is not empty and has no page."""
    if out.is_dir() and any(out.iterdir()) and not (out / "data" / "index.js").is_file():
        raise ValueError(f"{out} is not empty, and what is in it is no page; name another folder")
    for part in _PARTS:
        shutil.rmtree(out / part, ignore_errors=True)


def _html(content: Content, shown: Sequence[Ranking]) -> str:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("fo_gym.page"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"shown": _shown, "slug": slug, "listed": _listed}
    told = _places(shown)
    ranked = content.table[~is_reference(content.table)]
    return environment.get_template("page.html").render(
        title=content.summary.title if content.summary else "fo-gym: which friction compensator is best?",
        sections=_sections(content),
        rankings=shown,
        overview=overview(content.table, content.who),
        spans=[(place, len(list(group))) for place, group in groupby(shown, key=lambda ranking: ranking.place)],
        places=[(slug(place), place) for place in told],
        variants=list(dict.fromkeys(ranking.variant for ranking in shown)),
        families=_families(content.who.values()),
        about={ranking.env: _about(ranking.env) for ranking in shown},
        descriptions={name: metric.description for name, metric in METRICS.items()},
        competitors=ranked["compensator"].nunique(),
        stories=stories(content.table),
        summary=content.summary,
        certificates=content.statements,
        maps=content.maps,
        provenance=_provenance(content.table),
        files=list(content.files),
        documentation=content.documentation,
        scripts=[*_SCRIPTS, *(["maps.js"] if content.maps else []), "start.js"],
    )


def _shown(name: str) -> str:
    return one_line(name, NAME_LIMIT)


def _listed(names: Iterable[str]) -> str:
    """Names as an address has them: each on its own, with commas between, and all together once more."""
    return quote(",".join(quote(name, safe="") for name in names), safe=",")


def _places(shown: Iterable[Ranking]) -> list[str]:
    return list(dict.fromkeys(ranking.place for ranking in shown))


def _sections(content: Content) -> list[tuple[str, str]]:
    """The links at the top."""
    maps = [("maps", "Maps")] if content.maps else []
    statements = [(each.id, each.id.capitalize()) for each in content.statements]
    return [("board", "Ranking"), *maps, *statements, ("provenance", "Provenance")]


def _families(who: Iterable[Who]) -> list[str]:
    """In alphabetical order, the references last."""
    return sorted({each.family for each in who}, key=lambda family: (family == REFERENCE_FAMILY, family))


def _about(env_id: str) -> str:
    """What happens in an environment: the first paragraph of what it says of itself."""
    environment = environment_of(env_id)
    if environment.task is not None:
        return ""
    module, _, name = environment.entry_point.partition(":")
    kind = getattr(import_module(module), f"{name}Env")
    return re.sub(r"\s+", " ", (kind.__doc__ or "").strip().partition("\n\n")[0])


def _provenance(table: pd.DataFrame) -> list[tuple[str, str]]:
    """Which protocol, processors and versions the rows name."""
    told = []
    for column in (name for name in map(str, table) if is_provenance(name)):
        values = sorted({str(value) for value in table[column] if not pd.isna(value) and str(value)})
        if column.startswith(("protocol", "processor", "version_")) and values:
            told.append((column.removeprefix("version_").replace("_", "-"), ", ".join(values)))
    return told


def _data(content: Content, shown: Sequence[Ranking]) -> dict[str, str]:
    """The scripts in data/, by name."""
    found = {"data/numbers.js": script("fg.numbers_are", _numbers(content, shown))}
    episodes: dict[str, list[tuple[str, str]]] = {}
    places: dict[str, str] = {}
    for trace in content.traces:
        ranking = key_of(trace.env, trace.robot, trace.variant)
        key = f"{ranking}/{trace.seed}/{trace.compensator}"
        places[key] = f"data/traces/{ranking}/{trace.seed}/{len(places)}-{slug(trace.compensator)[:40]}.js"
        found[places[key]] = trace_script(key, trace)
        entry = (str(trace.seed), f"seed {trace.seed}")
        if entry not in episodes.setdefault(ranking, []):
            episodes[ranking].append(entry)
    for each in content.maps:
        found[f"data/maps/{slug(each.name)}.js"] = script("fg.map", each.name, asdict(each))
    index = {
        "start": "" if len(shown) > 1 else shown[0].key,
        "first": {ranking.key: _first(ranking) for ranking in shown},
        "units": {ranking.key: ranking.unit for ranking in shown},
        "episodes": episodes,
        "traces": places,
    }
    return {**found, "data/index.js": script("fg.receive", index)}


def _first(ranking: Ranking) -> list[str]:
    """Whose traces are shown before anybody is chosen: the best beside the reader's own, or beside no compensation."""
    best = [row.who.name for row in ranking.rows if row.standing == "best"]
    own = [row.who.name for row in ranking.rows if row.own]
    return list(dict.fromkeys([*best[:1], *own[:1]] if own else ["none", *best[:1]]))


def _numbers(content: Content, shown: Sequence[Ranking]) -> dict[str, Any]:
    """The table as it is published, cell by cell as text, with what its columns mean."""
    lines = read_csv(csv(content.table), numbers=False)
    columns = list(map(str, lines))
    keys = {(ranking.env, ranking.robot, ranking.variant): ranking.key for ranking in shown}
    rows: dict[str, dict[str, list[str]]] = {key: {} for key in keys.values()}
    gains: dict[str, dict[str, str]] = {key: {} for key in keys.values()}
    for (env, robot, variant, name), line in zip(
        content.table[["env", "robot", "variant", "compensator"]].itertuples(index=False, name=None),
        lines.to_numpy(),
        strict=True,
    ):
        key = keys[env, robot, variant]
        rows[key][name] = list(line)
        gains[key][name] = content.gains.get((env, robot, variant, name), "")
    told = [
        name for name in columns if name in METRICS or name.startswith(("frr", "rank", "tied", "verdict", "episodes"))
    ]
    return {
        "columns": columns,
        "told": [*told, "status", "error", "competitor_hash"],
        "references": [str(name) for name in content.table.loc[is_reference(content.table), "compensator"].unique()],
        "metrics": {
            name: {"unit": metric.unit, "better": metric.better, "description": metric.description}
            for name, metric in METRICS.items()
            if name in columns
        },
        "rows": rows,
        "gains": gains,
    }
