"""The documentation is built without a warning, and has all that is public."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from test_docstrings import offers, public

import fo_gym

pytestmark = pytest.mark.looks

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The pages, built from a copy of what they are made of, as a workflow builds them."""
    copy = tmp_path_factory.mktemp("docs") / "copy"
    shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".*", "_build", "__pycache__", "build", "site"))
    server = {"GITHUB_SERVER_URL": "https://example.org", "GITHUB_REPOSITORY": "some/one"}
    command = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet"]
    command += ["docs", "docs/_build/html"]
    environment = os.environ | server | {"PYTHONPATH": str(copy)}
    done = subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return copy / "docs" / "_build" / "html"


@pytest.mark.slow
def test_the_reference_has_all_that_is_public(built: Path) -> None:
    page = (built / "api.html").read_text(encoding="utf-8")
    here = {where for name, thing in public() if name != "Reference" for where, *_ in offers(name, thing)}
    assert {f"fo_gym.{where}" for where in here} - set(re.findall(r'id="([\w.]+)"', page)) == set()


@pytest.mark.slow
@pytest.mark.parametrize("env_id", fo_gym.ENVIRONMENTS)
def test_every_environment_has_a_page_with_its_picture_and_its_tables(built: Path, env_id: str) -> None:
    page = (built / "environments" / f"{env_id}.html").read_text(encoding="utf-8")
    assert f"_images/{env_id}.png" in page
    assert (built / "_images" / f"{env_id}.png").is_file()
    assert [f'id="{part}"' in page for part in ("action", "observation", "reward", "version-history")] == [True] * 4


@pytest.mark.slow
def test_every_registered_compensator_has_its_row(built: Path) -> None:
    page = (built / "compensators.html").read_text(encoding="utf-8")
    shown = set(re.findall(r'<span class="pre">([\w-]+)</span>', page))
    assert set(fo_gym.list_compensators()) - {"none", "ideal", "bound"} - shown == set()


@pytest.mark.slow
def test_links_out_of_the_pages_lead_to_the_repository(built: Path) -> None:
    page = (built / "protocol.html").read_text(encoding="utf-8")
    assert 'href="https://example.org/some/one/blob/main/fo_gym/protocols/full.toml"' in page
    assert "file-of-repository" not in page
