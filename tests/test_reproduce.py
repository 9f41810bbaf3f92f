"""The run that fills the tables, the files that it writes, and `fo-gym reproduce`."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from fo_gym.certificate.statement import Finding, Statement, at_most
from fo_gym.certificate.subject import Subject
from fo_gym.cli import app
from fo_gym.reproduction import run
from fo_gym.reproduction.claims import CLAIMS
from fo_gym.reproduction.figures import FIGURES, FigureSpec
from fo_gym.reproduction.report import PLACES, page, write_reproduction
from fo_gym.reproduction.run import PARTS, TABLES, reproduce, size, surprises
from fo_gym.reproduction.wording import tolerance

QUICK = Subject(control_dt=1e-3, quick=True)
ROOT = Path(__file__).parents[1]


def _breaks(subject: Subject) -> Finding:
    raise ArithmeticError("nothing to divide by")


def _statement(id: str, number: float, fails: str = "") -> Statement:
    return Statement(id, "nobody", "One is at most two.", fails, lambda subject: at_most(number, 2.0, "m", "a number"))


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> dict[str, Statement]:
    """Tables of a few statements: one that holds, one known to fail, one that raises."""
    claims = {
        "holds": _statement("holds", 1.0),
        "known": _statement("known", 3.0, "Three is more than two."),
        "broken": Statement("broken", "nobody", "It can be measured.", "", _breaks),
    }
    monkeypatch.setattr(run, "TABLES", {"claims": claims, "fidelity": {"riccati-pid": CLAIMS["riccati-pid"]}})
    return claims


def _silence(name: str, done: int) -> None:
    """Nobody listens."""


def test_rows(small: dict[str, Statement], tmp_path: Path) -> None:
    found = reproduce(("claims", "fidelity"), QUICK, tmp_path, on_unit=_silence)
    table = found.tables["claims"].set_index("id")
    assert table["verdict"].to_dict() == {"holds": "holds", "known": "fails", "broken": "not measured"}
    assert table.loc["known", "explanation"] == "Three is more than two."
    assert table.loc["holds", ["number", "high", "unit"]].tolist() == [1.0, 2.0, "m"]
    assert table["low"].isna().all()
    assert "ArithmeticError: nothing to divide by" in table.loc["broken", "measured"]
    assert {"version_mujoco", "version_numba", "version_pin", "version_fo_gym"} <= set(table.columns)
    assert found.tables["fidelity"]["verdict"].tolist() == ["holds"]
    assert surprises(found) == ["broken"]


def test_a_statement_that_holds_against_expectation_is_a_surprise(small: dict[str, Statement], tmp_path: Path) -> None:
    small["known"] = _statement("known", 1.0, "Three is more than two.")
    del small["broken"]
    found = reproduce(("claims",), QUICK, tmp_path, on_unit=_silence)
    assert surprises(found) == ["known"]
    assert found.tables["claims"].set_index("id").loc["known", "explanation"] == ""


def test_a_crash_of_a_known_failure_is_a_surprise(small: dict[str, Statement], tmp_path: Path) -> None:
    """Its explanation explains something else."""
    small.clear()
    small["known"] = Statement("known", "nobody", "It can be measured.", "Because.", _breaks)
    found = reproduce(("claims",), QUICK, tmp_path, on_unit=_silence)
    assert surprises(found) == ["known"]
    assert found.tables["claims"].loc[0, ["verdict", "explanation"]].tolist() == ["not measured", ""]


def test_a_figure_that_cannot_be_drawn_loses_nothing_else(
    small: dict[str, Statement], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    del small["broken"]
    spec = FigureSpec("nothing", "Nothing.", _breaks)  # type: ignore[arg-type]
    monkeypatch.setattr(run, "FIGURES", {"nothing": spec})
    monkeypatch.setitem(FIGURES, "nothing", spec)
    found = reproduce(PARTS, QUICK, tmp_path, on_unit=_silence)
    assert list(found.tables) == ["claims", "fidelity"]
    assert found.errors == {"nothing": "ArithmeticError: nothing to divide by"}
    assert surprises(found) == ["nothing"]


def test_unknown_parts_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"unknown parts \['claim'\]; allowed are 'claims', 'fidelity', 'figures'"):
        reproduce(("claim",), QUICK, tmp_path, on_unit=_silence)


def test_files(small: dict[str, Statement], tmp_path: Path) -> None:
    found = reproduce(("claims", "fidelity"), QUICK, tmp_path, on_unit=_silence)
    written = write_reproduction(found, tmp_path)
    names = ["paper/claims.csv", "paper/claims.md", "fidelity.csv", "fidelity.md"]
    assert [path.relative_to(tmp_path).as_posix() for path in written] == names
    with (tmp_path / "paper" / "claims.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["id"] for row in rows] == ["holds", "known", "broken"]
    page = (tmp_path / "paper" / "claims.md").read_text(encoding="utf-8")
    assert "3 statements: 1 hold" in page
    assert "* `known`: Three is more than two." in page
    assert "**fails**" in page
    before = [path.read_bytes() for path in written]
    again = write_reproduction(reproduce(("claims", "fidelity"), QUICK, tmp_path, jobs=1, on_unit=_silence), tmp_path)
    assert [path.read_bytes() for path in again] == before


def test_tolerances_as_text() -> None:
    nan = float("nan")
    assert tolerance(nan, 1e-5) == "≤ 1e-05"
    assert tolerance(0.5, nan) == "≥ 0.5"
    assert tolerance(-1.05, -0.95) == "-1.05 to -0.95"


def test_everything_belongs_to_a_part() -> None:
    assert size(PARTS) == sum(size((part,)) for part in PARTS)
    assert size(("claims",)) == len(TABLES["claims"]) >= 20
    assert size(("fidelity",)) == len(TABLES["fidelity"]) >= 15
    assert size(("figures",)) == 7


def test_command(small: dict[str, Statement], tmp_path: Path) -> None:
    """Tables are printed, files are written, and then the surprise makes it fail."""
    answer = CliRunner().invoke(
        app, ["reproduce", "--only", "claims", "--quick", "--jobs", "1", "--out", str(tmp_path)]
    )
    assert answer.exit_code == 2
    assert "3 statements: 1 hold" in answer.output
    assert "not as it is known to be: broken" in answer.output
    assert (tmp_path / "paper" / "claims.csv").is_file()
    del small["broken"]
    options = ["reproduce", "--only", "claims", "--jobs", "1", "--out", str(tmp_path)]
    assert CliRunner().invoke(app, options).exit_code == 0


def test_command_refuses() -> None:
    answer = CliRunner().invoke(app, ["reproduce", "--only", "claim"])
    assert answer.exit_code == 2
    assert "claims" in answer.output
    answer = CliRunner().invoke(app, ["reproduce", "--jobs", "0"])
    assert answer.exit_code == 2
    assert "--jobs is 0" in answer.output


@pytest.mark.parametrize("table", TABLES)
def test_published_tables_are_of_today(table: str) -> None:
    """The committed tables have the statements that the code has, with the known verdicts, and the pages show them."""
    path = ROOT / "leaderboard" / f"{PLACES[table]}.csv"
    published = pd.read_csv(path, dtype={"unit": str, "explanation": str}).fillna({"unit": "", "explanation": ""})
    assert list(published["id"]) == list(TABLES[table])
    assert np.isfinite(published["number"]).all()
    assert published["measured"].str.len().gt(0).all()
    for row in published.to_dict("records"):
        statement = TABLES[table][row["id"]]
        assert (row["source"], row["statement"]) == (statement.source, statement.text)
        assert (row["verdict"] == "fails") == bool(statement.fails)
        assert row["explanation"] == statement.fails
    assert path.with_suffix(".md").read_text(encoding="utf-8") == page(table, published, FIGURES)
