"""Every program and every command in README and docs/ runs as it stands there, with episodes of 0.1 s."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from page_code import ROOT, Step, languages, run_pages, steps

MADE = {"compensators.md", "changelog.md", "contributing.md"}  # when the documentation is built
PAGES = {
    str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
    for path in (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md")))
    if not {"_build", "environments"} & set(path.parts) and path.name not in MADE
}
LANGUAGES = {"python", "sh", "toml", "ini", "text", "{toctree}", "{eval-rst}"}

# What takes minutes or hours, and who runs it instead.
LONG = {
    r"make (leaderboard|page|quick|reproduce|test-portable|docs|test|\.venv/\.run)": "the workflows",
    r"make bench": "fo-gym bench: tests/test_bench.py",
    r"make train|\S+fo-gym train|\S+fo-gym evaluate build/mine/compensator.py": "tests/test_rl_training.py",
    r"make study": "baselines/rl/study: tests/test_study.py",
    r"python -m rl_zoo3\.train": "make test-zoo, and the workflow packages",
    r"\S+fo-gym page --from build/leaderboard": "tests/test_page.py",
    r"make tune": "fo-gym tune: tests/test_tuning.py",
    r"\S*fo-gym verify": "tests/test_verify.py, and the workflow leaderboard",
    r"\S*fo-gym leaderboard --protocol laws": "tests/test_protocol.py",
    r"(\.venv/bin/)?python docs/\S+\.py": "whoever publishes; the script is there",
}
# What is made smaller before it runs.
SMALLER = {
    "L=20:400:10": "L=20:400:2",
    "Lp=15:80:10": "Lp=15:80:2",
    "L=20:200:6": "L=20:200:2",
    "Li=10:200:6": "Li=10:200:2",
    "jobs=-1": "jobs=1",
    "n_steps=128": "n_steps=4",
    "learn(8192)": "learn(256)",
}


def is_long(step: Step) -> bool:
    return step.kind == "sh" and any(re.match(pattern, step.text) for pattern in LONG)


def smaller(step: Step) -> Step:
    text = step.text
    for whole, part in SMALLER.items():
        text = text.replace(whole, part)
    in_one = step.kind == "sh" and re.search(r"fo-gym (evaluate|sweep|leaderboard)", text)
    return Step(step.kind, f"{text} --jobs 1" if in_one else text)


@pytest.fixture(scope="module")
def raised(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    chosen = {page: [smaller(step) for step in steps(text) if not is_long(step)] for page, text in PAGES.items()}
    run = {page: each for page, each in chosen.items() if each}
    return run_pages(tmp_path_factory.mktemp("pages"), run, short=True)[1]


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page, text in PAGES.items() if steps(text)])
def test_its_code_runs(page: str, raised: dict[str, str]) -> None:
    assert raised.get(page, "") == ""


def test_every_block_says_its_language() -> None:
    assert {page: other for page, text in PAGES.items() if (other := languages(text) - LANGUAGES)} == {}


def test_every_pattern_is_of_use() -> None:
    commands = [step.text for text in PAGES.values() for step in steps(text) if step.kind == "sh"]
    assert [pattern for pattern in LONG if not any(re.match(pattern, command) for command in commands)] == []
    code = "\n".join(step.text for text in PAGES.values() for step in steps(text))
    assert [whole for whole in SMALLER if whole not in code] == []


def test_what_is_not_run_is_there() -> None:
    for text in PAGES.values():
        for step in filter(is_long, steps(text)):
            program, name, *_ = step.text.split()
            if program == "make":
                subprocess.run(["make", "--dry-run", name], cwd=ROOT, check=True, capture_output=True)
            elif name.endswith(".py"):
                assert Path(ROOT, name).is_file(), step.text
