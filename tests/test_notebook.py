"""The notebook: it runs, and it is published as it ran, without a trace of whoever ran it."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import gettempdir

import nbformat
import pytest
from nbclient import NotebookClient

pytestmark = pytest.mark.looks

ROOT = Path(__file__).parents[1]
FILE = ROOT / "examples" / "train_a_policy.ipynb"


def outputs(notebook: nbformat.NotebookNode) -> list[str]:
    """What its cells of code have printed or shown, as text."""
    shown = [each for cell in notebook.cells if cell.cell_type == "code" for each in cell.outputs]
    return [each.get("text") or each["data"]["text/plain"] for each in shown]


def test_it_is_published_with_its_outputs() -> None:
    notebook = nbformat.read(FILE, as_version=4)
    nbformat.validate(notebook)
    counts = [cell.execution_count for cell in notebook.cells if cell.cell_type == "code"]
    assert counts == list(range(1, len(counts) + 1))
    text = "\n".join(outputs(notebook))
    assert "our policy" in text
    assert "pid-high" in text
    whole = FILE.read_text(encoding="utf-8")
    assert [word for word in (str(ROOT), gettempdir(), "Traceback", "Warning") if word in whole] == []
    assert all(cell.metadata == {} for cell in notebook.cells)
    assert len(whole) < 50_000


@pytest.mark.slow
def test_it_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]))
    notebook = nbformat.read(FILE, as_version=4)
    NotebookClient(notebook, timeout=1800, resources={"metadata": {"path": str(tmp_path)}}).execute()
    told = outputs(notebook)
    assert told[-1].startswith("ok ")
    returns = [
        float(line.rsplit(maxsplit=1)[1]) for text in told for line in text.splitlines() if "last episodes" in line
    ]
    assert returns[-1] > returns[0]
