"""What publishes the results: workflows, citation, hooks, and the page about the protocol say what is there."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest
import typer
import yaml
from typer.testing import CliRunner

import fo_gym
from fo_gym.cli import app
from fo_gym.evaluation.competitors.entry import load_entry
from fo_gym.evaluation.results.leaderboard import STANDING
from fo_gym.evaluation.runs import seeds
from fo_gym.evaluation.runs.protocol import shipped_protocols
from fo_gym.reproduction import run
from fo_gym.reproduction.claims import CLAIMS
from fo_gym.tasks.variants import VARIANTS

ROOT = Path(__file__).parents[1]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
PAGE = (ROOT / "docs" / "protocol.md").read_text(encoding="utf-8")
TARGETS = set(re.findall(r"^([\w$()./-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
TARGETS |= {target.replace("$(VENV)", ".venv") for target in TARGETS}
PROTOCOL = """
name = "one"
split = "validation"
seeds = 1
environments = ["FJRSquare-v0"]
variants = ["nominal"]
compensators = ["pd-low"]
"""
COMMANDS = set(typer.main.get_command(app).commands)


def read(path: Path) -> Any:
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def steps(workflow: Path) -> list[dict[str, Any]]:
    """All steps of all jobs."""
    return [step for job in read(workflow)["jobs"].values() for step in job["steps"]]


def check_command(command: str) -> None:
    """Whether a command line of ours names what there is: a target of make, a command of fo-gym, or pip."""
    program, first, *_ = command.split()
    if program == "make":
        assert first in TARGETS, command
    elif program.endswith("fo-gym"):
        assert first in COMMANDS, command
    else:
        assert command.startswith(".venv/bin/python -m pip install "), command


def test_there_are_five_workflows() -> None:
    assert [path.stem for path in WORKFLOWS] == ["leaderboard", "packages", "page", "release", "test"]
    wanted = {
        "packages": {"make test-robots"},
        "leaderboard": {"make leaderboard", "make quick", ".venv/bin/fo-gym verify"},
        "page": {"make site"},
        "release": {"make dist TAG=${GITHUB_REF_NAME}"},
        "test": {"make check", "make docs", "make test", "make test-portable"},
    }
    for path in WORKFLOWS:
        assert wanted[path.stem] <= {step.get("run") for step in steps(path)}


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_runs_what_there_is_with_the_least_rights(workflow: Path) -> None:
    content = read(workflow)
    assert content["permissions"] == {"contents": "read"}
    assert "pull_request_target" not in content[True]  # YAML 1.1 takes the key `on` for a truth value
    for step in steps(workflow):
        if "run" in step:
            check_command(step["run"])
        else:
            assert re.fullmatch(r"(actions/[a-z-]+|pypa/gh-action-pypi-publish)@[0-9a-f]{40}", step["uses"]), step
        if step.get("uses", "").startswith("actions/checkout"):
            assert step["with"] == {"persist-credentials": False}
    assert all("timeout-minutes" in job for job in content["jobs"].values())


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.stem)
def test_a_job_that_may_write_runs_no_code_of_the_repository(workflow: Path) -> None:
    for name, job in read(workflow)["jobs"].items():
        if job.get("permissions"):
            assert name == "publish"
            assert not any("run" in step or step["uses"].startswith("actions/checkout") for step in job["steps"])


def test_the_oldest_python_is_tested() -> None:
    pythons = read(ROOT / ".github" / "workflows" / "test.yml")["jobs"]["test"]["strategy"]["matrix"]["python"]
    oldest = re.search(r'requires-python = ">=([\d.]+)"', (ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert oldest
    assert pythons[0] == oldest.group(1)


def test_artifacts_are_where_the_commands_write() -> None:
    uploads = [step["with"] for step in steps(WORKFLOWS[0]) if "upload-artifact" in step.get("uses", "")]
    assert [each["path"] for each in uploads] == ["build/leaderboard/", "build/quick/"]


def test_only_what_is_told_to_publish_changes_what_is_published() -> None:
    """Targets of make that name a folder, or a script of docs/, name one in build/, or are called publish."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    recipes = dict(re.findall(r"^([a-z-]+):.*\n((?:\t.*\n)+)", makefile, re.MULTILINE))
    writers = {name: re.findall(r"--out(?:dir)? (\S+)|python (docs/\S+)", text) for name, text in recipes.items()}
    targets = {name: [out or script for out, script in each] for name, each in writers.items()}
    assert targets.pop("test-portable") == ["docs/processors/elsewhere.py"]  # writes nothing itself
    assert targets["publish"] == ["leaderboard", "leaderboard"]
    assert targets.pop("dist") == ["dist"]  # is not committed
    assert {"leaderboard", "reproduce", "bench", "train", "tune"} <= set(targets)
    others = {name: each for name, each in targets.items() if not name.startswith("publish")}
    assert {name: each for name, each in others.items() if not all(path.startswith("build/") for path in each)} == {}


@pytest.mark.slow
def test_commands_write_into_build_where_nothing_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("one.toml").write_text(PROTOCOL, encoding="utf-8")
    monkeypatch.setattr(run, "TABLES", {"claims": {"riccati-pid": CLAIMS["riccati-pid"]}})
    for command in (["leaderboard", "--protocol", "one.toml"], ["reproduce", "--only", "claims"]):
        assert CliRunner().invoke(app, [*command, "--jobs", "1"]).exit_code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["build", "one.toml"]
    written = {"leaderboard/episodes.csv", "leaderboard/processor.json", "reproduce/paper/claims.csv"}
    assert all((tmp_path / "build" / name).is_file() for name in written)


def test_citation() -> None:
    citation = read(ROOT / "CITATION.cff")
    assert citation["cff-version"] == "1.2.0"
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert citation["version"] == project["version"] == fo_gym.__version__
    assert citation["authors"] == [{"name": "The fo-gym authors"}]
    assert citation["license"] == "MIT"
    assert {"message", "title", "type"} <= set(citation)
    (paper,) = citation["references"]
    assert paper["identifiers"][0]["description"] == "arXiv:1907.00553"
    names = [author["family-names"] for author in paper["authors"]]
    assert names == ["Kim", "Beck", "Ott", "Albu-Schäffer"]


def test_the_package_says_where_the_project_is(tmp_path: Path) -> None:
    shutil.copytree(
        ROOT, tmp_path / "source", ignore=shutil.ignore_patterns(".*", "__pycache__", "build", "_build", "site")
    )
    options = {"GITHUB_SERVER_URL": "https://github.com", "GITHUB_REPOSITORY": "Some/one"}
    program = "from hatchling.builders.wheel import WheelBuilder; print(*WheelBuilder('.').build(directory='dist'))"
    command = [sys.executable, "-c", program]
    subprocess.run(command, cwd=tmp_path / "source", env=os.environ | options, check=True, capture_output=True)
    (wheel,) = (tmp_path / "source" / "dist").glob("*.whl")
    with ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith("/METADATA")]
        told = archive.read(name).decode()
    for line in ("Documentation, https://some.github.io/one/docs/", "Repository, https://github.com/Some/one"):
        assert f"Project-URL: {line}\n" in told
    assert "](https://github.com/Some/one/raw/main/docs/images/square.gif)" in told
    assert re.findall(r"\]\((?!https://|#)[^)]*\)", told) == []


def test_hooks_are_the_tools_of_make_check() -> None:
    hooks = [hook for repo in read(ROOT / ".pre-commit-config.yaml")["repos"] for hook in repo["hooks"]]
    tools = [hook["entry"].split()[0] for hook in hooks]
    assert tools == [".venv/bin/ruff", ".venv/bin/ruff", ".venv/bin/mypy"]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for tool in tools:
        assert tool.replace(".venv/bin", "$(BIN)") in makefile


def test_the_page_names_what_exists() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []
    files = re.findall(r"`((?:fo_gym|baselines|tests|examples)/[\w./]+)`", PAGE)
    files += re.findall(r"`([\w-]+\.(?:txt|md))`", PAGE)
    assert len(files) >= 4
    assert [name for name in files if not (ROOT / name).exists()] == []
    commands = [line.partition("#")[0] for line in re.findall(r"^    ((?:make|\.venv/bin/fo-gym) .*)$", PAGE, re.M)]
    commands += re.findall(r"`((?:make|fo-gym) [^`]*)`", PAGE)
    assert len(commands) >= 7
    for command in commands:
        check_command(command)
        environments = re.findall(r"--env (\S+)", command)
        assert set(environments) <= set(fo_gym.ENVIRONMENTS)


def test_the_page_tells_all_environments_variants_protocols_and_columns() -> None:
    named = set(re.findall(r"`([\w-]+)`", PAGE))
    assert {*fo_gym.ENVIRONMENTS, *VARIANTS, *STANDING} - {"verdict"} <= named
    assert all(f"fo_gym/protocols/{name}.toml" in PAGE for name in shipped_protocols())


def test_the_page_tells_the_seeds() -> None:
    table = re.sub(r"(?<=\d) (?=\d{3}\b)", "", PAGE)
    ranges = [value for value in vars(seeds).values() if isinstance(value, range)]
    assert len(ranges) >= 3
    for each in ranges:
        assert f"| {each[0]} ... {each[-1]} |" in table


def test_the_entry_of_the_page_is_one(tmp_path: Path) -> None:
    (entry,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "mine.toml").write_text(entry, encoding="utf-8")
    shutil.copy(ROOT / "examples" / "bang_bang.py", tmp_path)
    competitor = load_entry(tmp_path / "mine.toml")
    assert (competitor.name, competitor.authors) == ("mine", ("A. Author",))
    assert competitor.make("FJRStiction-v0", "nominal").feedback == "measured"
