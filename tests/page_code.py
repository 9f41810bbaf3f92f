"""The programs and commands in the pages of the project, and a process that runs them."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
_FENCED = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_COMMAND = re.compile(r"^(?: {4})?((?:make|python|\.venv/bin/\w[\w-]*|fo-gym) [^\n]+)$", re.MULTILINE)

# Runs the steps of each page in a folder of its own, all pages in one process, and writes what each raised.
PROGRAM = """
import json, os, shlex, sys, tomllib, traceback
from pathlib import Path

import gymnasium as gym
import fo_gym
from fo_gym.cli import app

job = json.load(sys.stdin)
if job["short"]:
    register = gym.register
    for env_id in fo_gym.ENVIRONMENTS:
        gym.spec(env_id).kwargs["duration"] = 0.1
    gym.register = lambda *args, kwargs, **others: register(*args, kwargs={**kwargs, "duration": 0.1}, **others)


def take(kind, text, names):
    path = text.partition("\\n")[0].removeprefix("# ")
    if kind == "sh":
        app(shlex.split(text, comments=True)[1:], standalone_mode=False)
    elif text.startswith("# ") and " " not in path and path.endswith((".py", ".toml")):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        Path(path).write_text(text)
    elif kind == "toml":
        tomllib.loads(text)
    else:
        exec(text, names)


raised = {}
for page, folder, steps in job["pages"]:
    os.chdir(folder)
    names = {"__name__": "page"}
    try:
        for kind, text in steps:
            take(kind, text, names)
        exec(job["after"], names)
    except BaseException:
        raised[page] = f"{kind}: {text}\\n{traceback.format_exc()}"
Path(job["out"]).write_text(json.dumps(raised))
"""


class Step(NamedTuple):
    """A block of Python or TOML, or one command."""

    kind: str
    text: str


def languages(text: str) -> set[str]:
    """Those of the fenced blocks of a page, and directives."""
    return {language for language, _ in _FENCED.findall(text)}


def steps(text: str) -> list[Step]:
    """What is to be run of a page, in its order: blocks, and commands, fenced or indented."""
    blocks = (match for match in _FENCED.finditer(text) if match[1] in ("python", "toml"))
    found = {match.start(): Step(match[1], match[2]) for match in blocks}
    fences = [(match.start(), match.end(), match[1]) for match in _FENCED.finditer(text)]
    for match in _COMMAND.finditer(text):
        within = next((language for start, end, language in fences if start < match.start() < end), None)
        if within == "sh" or (within is None and match[0].startswith(" ")):
            found[match.start()] = Step("sh", match[1].partition(" #")[0].strip())
    return [found[place] for place in sorted(found)]


def run_pages(
    folder: Path, pages: dict[str, list[Step]], *, short: bool, after: str = ""
) -> tuple[str, dict[str, str]]:
    """Output, and what each page raised, run in one process, each beside a copy of the examples and a `mine.py`.

    Args:
        folder: where a folder for each page is made.
        pages: what is to be run of each.
        short: whether environments last 0.1 s.
        after: a program that sees the names of each page.
    """
    jobs = []
    for number, (page, chosen) in enumerate(pages.items()):
        here = folder / str(number)
        shutil.copytree(ROOT / "examples", here / "examples")
        shutil.copytree(ROOT / "examples", here / "leaderboard" / "submissions")
        mine = (ROOT / "examples" / "bang_bang.py").read_text(encoding="utf-8").replace("BangBang", "Mine")
        (here / "mine.py").write_text(mine, encoding="utf-8")
        jobs.append((page, str(here), chosen))
    out = folder / "raised.json"
    job = {"short": short, "pages": jobs, "after": after, "out": str(out)}
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "160", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-c", PROGRAM]
    options = {"env": environment, "capture_output": True, "text": True, "input": json.dumps(job)}
    done = subprocess.run(command, check=False, **options)  # type: ignore[call-overload]
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    return str(done.stdout), json.loads(out.read_text(encoding="utf-8"))
