"""Pages that are made when the documentation is built, from what the code says of itself.

One page for each registered environment, one of all compensators, and the repository's own CHANGELOG and CONTRIBUTING.
They are not committed: what a docstring says is said there alone. Links that leave docs/ lead to the repository.
"""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

import gymnasium as gym
import pandas as pd

import fo_gym
from fo_gym.evaluation.runs.contest import competitors_of
from fo_gym.evaluation.runs.protocol import load_protocol
from fo_gym.files import read_csv

DOCS = Path(__file__).parent
ROOT = DOCS.parent
BUILT = DOCS / "_build" / "html"
WHOLE = {"changelog.md": "CHANGELOG.md", "contributing.md": "CONTRIBUTING.md"}
"""Pages of docs/ that are a file of the repository."""

_LINK = re.compile(r"(?<!!)(\[[^\]]*\]\()([^)\s#:]+)((?:#[^)\s]*)?\))")
_SECTION = re.compile(r"^(Args|Attributes|Returns|Raises):$")
_ENTRY = re.compile(r"^    (\w[\w, ]*): (.*)$")


def address(target: Path, page: Path) -> str:
    """Where a file of the repository is read: on its server, where a workflow builds, else beside what is built."""
    name = os.environ.get("GITHUB_REPOSITORY")
    if name:
        return f"{os.environ['GITHUB_SERVER_URL']}/{name}/blob/main/{target.relative_to(ROOT).as_posix()}"
    return f"file-of-repository:{os.path.relpath(target, BUILT / page.parent.relative_to(DOCS))}"


def relinked(text: str, origin: Path, page: Path) -> str:
    """Markdown of a page, whose links are meant from the folder `origin`, as it is read at `page`.

    Raises:
        ValueError: a link leads to a file that is not there.
    """

    def told(found: re.Match[str]) -> str:
        start, name, end = found.groups()
        target = (origin / name).resolve()
        made = next((DOCS / made for made, source in WHOLE.items() if target == ROOT / source), target)
        if made.suffix == ".md" and made.is_relative_to(DOCS):
            return f"{start}{os.path.relpath(made, page.parent)}{end}"  # Sphinx says so where it is not there
        if not target.exists():
            raise ValueError(f"{page.relative_to(ROOT)} links to {name}, which is not there")
        return f"{start}{address(target, page)}{end}"

    return _LINK.sub(told, text)


def markdown(doc: str) -> str:
    """A docstring in Google's style as Markdown: sections become lists, indented equations stay as they are."""
    lines, section = [], ""
    for line in inspect.cleandoc(doc).splitlines():
        if found := _SECTION.match(line):
            section = found[1]
            lines += [f"*{section}*", ""]
        elif section and (entry := _ENTRY.match(line)):
            lines.append(f"* `{entry[1]}`: {entry[2]}")
        elif section:
            lines.append(f"  {line.strip()}")
            section = section if line.startswith("    ") or not line else ""
        else:
            lines.append(line if line.startswith("    ") else line.replace("_*", r"_\*"))
    return "\n".join(line.rstrip() for line in lines)


def environment(env_id: str) -> str:
    """Picture, spaces and docstring of an environment."""
    env = gym.make(env_id).unwrapped
    row = fo_gym.ENVIRONMENTS[env_id]
    facts = {
        "made by": f'`gym.make("{env_id}")`',
        "many at once": f'`gym.make_vec("{env_id}", num_envs=256)`',
        "robot": f"`{row.robot_name}`" + (", or any other arm: `robot=`" if "arm" in row.tags else ""),
        "action": f"`Box(shape={env.action_space.shape}, {env.action_space.dtype})`",
        "observation": f"`Box(shape={env.observation_space.shape}, {env.observation_space.dtype})`",
        "variants": "`nominal`, `randomized`, `hardware`",
    }
    table = "\n".join(f"| {name} | {value} |" for name, value in facts.items())
    picture = f"![{env_id} under the PID-type observer](../images/{env_id}.png)"
    return f"# {env_id}\n\n{picture}\n\n|   |   |\n| --- | --- |\n{table}\n\n{markdown(type(env).__doc__ or '')}\n"


def compensators() -> str:
    """One section for each file of `baselines`: equation, source, gains, and the scores of its rows."""
    families: dict[str, list[EntryPoint]] = {}
    ours = (entry for entry in entry_points(group="fo_gym.compensators") if entry.value.startswith("baselines."))
    order = load_protocol("full").compensators
    for entry in sorted(ours, key=lambda entry: order.index(entry.name) if entry.name in order else len(order)):
        families.setdefault(entry.module, []).append(entry)
    scores = read_csv((ROOT / "leaderboard" / "leaderboard.csv").read_text(encoding="utf-8"))
    sections = [section for module, entries in families.items() for section in family(module, entries, scores)]
    return "\n\n".join([_HEAD.strip(), *sections]) + "\n"


_HEAD = """
# Compensators

The rows of the leaderboard, family by family: what each computes, where it is published, its gains, and how it scores.
B theta'' + tau_j = tau_m + tau_f throughout; tau_f_hat is the estimate, theta_n the friction-free nominal motor. FRR is
the interquartile mean over 20 episodes, in `nominal` / `randomized` / `hardware`; 1 is as good as no friction. Rows
`-tuned` have gains that `fo-gym tune` found. Which rows are tied, and what else was measured:
[the leaderboard](leaderboard.md). Why friction models do harm on the arm: [baselines](baselines.md). One of your own:
[how](own-compensator.md).
"""


def family(module: str, entries: list[EntryPoint], scores: pd.DataFrame) -> Iterator[str]:
    """A section: the module's docstring, those of its classes, and a table of its rows."""
    found = import_module(module)
    title, _, rest = inspect.cleandoc(found.__doc__ or "").partition("\n")
    path = Path(inspect.getfile(found)).relative_to(ROOT)
    yield f"## {title.rstrip('.')}"
    yield markdown(rest.strip("\n"))
    for name in dict.fromkeys(made_class(entry) for entry in entries):
        yield f"### {name.__name__}\n\n{markdown(name.__doc__ or '')}"
    yield f"### Scores of this family: {', '.join(entry.name for entry in entries)}"
    yield rows(entries, scores)
    yield f"Source: [{path}](../{path})."


def made_class(entry: EntryPoint) -> type:
    """The class of a registered compensator."""
    return type(fo_gym.make_compensator(entry.name))


def rows(entries: list[EntryPoint], scores: pd.DataFrame) -> str:
    """A table: each row of the leaderboard with its gains and its FRR on each environment; then who has no row."""
    environments = list(dict.fromkeys(scores["env"]))
    lines = [f"| row | gains | {' | '.join(environments)} |", "| --- | --- |" + " --- |" * len(environments)]
    defaults = {entry.name: gains_of(entry.load()) for entry in entries}
    for competitor in competitors_of(load_protocol("full")):
        if competitor.spec not in defaults:
            continue
        mine = scores[scores["compensator"] == competitor.name]
        cells = [" / ".join(f"{frr:.3f}" for frr in mine[mine["env"] == env]["frr"]) for env in environments]
        gains = defaults[competitor.spec] if competitor.name == competitor.spec else f"tuned, from `{competitor.spec}`"
        lines.append(f"| `{competitor.name}` | {gains} | {' | '.join(cells)} |")
    ranked = {competitor.spec for competitor in competitors_of(load_protocol("full"))}
    lines += [
        f"| `{name}` | {own} |{' no row |' * len(environments)}" for name, own in defaults.items() if name not in ranked
    ]
    return "\n".join(lines)


def gains_of(factory: Any) -> str:
    """The numbers that a registered compensator has where none are given."""
    defaults = ((name, each.default) for name, each in inspect.signature(factory).parameters.items())
    return ", ".join(f"{name} = {value:g}" for name, value in defaults if isinstance(value, int | float)) or "-"


def write(app: Any) -> None:
    """Write every page whose text is another one than before."""
    texts = {DOCS / "environments" / f"{env_id}.md": environment(env_id) for env_id in fo_gym.ENVIRONMENTS}
    texts[DOCS / "compensators.md"] = compensators()
    texts |= {DOCS / name: (ROOT / source).read_text(encoding="utf-8") for name, source in WHOLE.items()}
    for path, text in texts.items():
        path.parent.mkdir(exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _relink(app: Any, docname: str, source: list[str]) -> None:
    page = DOCS / f"{docname}.md"
    origin = ROOT if page.name in WHOLE else page.parent
    source[0] = relinked(source[0], origin, page)


def setup(app: Any) -> dict[str, bool]:
    """Make the pages before Sphinx looks which there are."""
    app.connect("builder-inited", write)
    app.connect("source-read", _relink)
    return {"parallel_read_safe": True}
