"""The figures of the reproduction: that they are drawn, the same each time, and show what the paper shows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fo_gym.certificate.cases import FRICTION
from fo_gym.certificate.subject import Subject
from fo_gym.reproduction.figures import FIGURES, draw
from fo_gym.reproduction.figures.motivating import VIEWS, break_away
from fo_gym.reproduction.figures.style import KINDS, LINES
from fo_gym.reproduction.runs import GAINS, panels

pytestmark = [pytest.mark.slow, pytest.mark.looks]
QUICK = Subject(control_dt=1e-3, quick=True)
TIMED = "convergence"
"""The one figure that holds times, which differ from run to run."""


@pytest.fixture(scope="module", params=FIGURES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def written(name: str, tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Path], Figure]:
    """The files of a figure, and the figure itself."""
    kept: list[Figure] = []

    def function(subject: Subject) -> Figure:
        kept.append(spec.function(subject))
        return kept[0]

    spec = FIGURES[name]
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(FIGURES, name, replace(spec, function=function))
        files = draw(name, QUICK, tmp_path_factory.mktemp("figures") / "new")
    return files, kept[0]


@pytest.fixture(scope="module")
def files(written: tuple[list[Path], Figure]) -> list[Path]:
    return written[0]


@pytest.fixture(scope="module")
def drawn(written: tuple[list[Path], Figure]) -> Figure:
    return written[1]


def test_figure_is_written_whole(name: str, files: list[Path]) -> None:
    assert [path.name for path in files] == [f"{name}.pdf", f"{name}.png"]
    assert sorted(files[0].parent.iterdir()) == sorted(files), "a draft was left behind"
    assert files[0].read_bytes().startswith(b"%PDF")
    assert files[1].read_bytes().startswith(b"\x89PNG")


def test_figure_is_small_enough_for_a_paper(files: list[Path]) -> None:
    pdf, png = (path.stat().st_size for path in files)
    assert pdf < 300_000
    assert png < 1_000_000


def test_figure_holds_neither_date_nor_version(files: list[Path]) -> None:
    for path in files:
        assert b"CreationDate" not in path.read_bytes()
        assert b"Matplotlib" not in path.read_bytes()


@pytest.mark.parametrize("name", [name for name in FIGURES if name != TIMED], scope="module")
def test_figure_is_the_same_each_time(name: str, files: list[Path], tmp_path: Path) -> None:
    with mpl.rc_context({"lines.linewidth": 7.0, "font.size": 30.0}):  # a user's own taste
        again = draw(name, QUICK, tmp_path)
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in files]


def test_figure_says_what_it_shows(name: str) -> None:
    figure = FIGURES[name]
    assert figure.title
    assert len(figure.caption) > 200
    assert figure.caption.endswith(".")


def test_every_axis_has_a_label_with_its_unit(drawn: Figure) -> None:
    """Below its column and left of its row, where it has none of its own."""
    for plot in drawn.axes:
        column = plot.get_shared_x_axes().get_siblings(plot)
        row = [other for other in drawn.axes if other.get_position().y0 == pytest.approx(plot.get_position().y0)]
        for texts in ({other.get_xlabel() for other in column}, {other.get_ylabel() for other in row}):
            assert texts != {""}
            assert all(text.endswith("]") and "[" in text for text in texts - {""}), texts


def test_no_text_is_clipped(drawn: Figure) -> None:
    """What is drawn lies within the page, titles, labels and legends included."""
    width, height = drawn.get_size_inches()
    box = drawn.get_tightbbox()
    assert box.x0 >= 0.0
    assert box.y0 >= 0.0
    assert box.x1 <= width
    assert box.y1 <= height


# --- Figure 1 shows the paper's pattern ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def simulation() -> Figure:
    return FIGURES["simulation"].function(QUICK)


def magnified(figure: Figure, name: str) -> tuple[Axes, np.ndarray, np.ndarray]:
    """The magnified view of one observer: its axes, and time [s] and the motor's distance [mm] after 10 s, as drawn."""
    kind, level = name.split("-")
    axes = figure.axes[3 * (3 * list(GAINS).index(level) + 1) + KINDS.index(kind)]
    (line,) = (line for line in axes.lines if line.get_label() == r"$\theta$")
    assert line.get_color() == LINES[kind]["color"]
    time, distance = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    return axes, time[time > 10.0], distance[time > 10.0]


@pytest.mark.parametrize("name", ["pid-low", "letien-low", "letien-high"])
def test_simulation_shows_hunting(simulation: Figure, name: str) -> None:
    axes, _, distance = magnified(simulation, name)
    assert np.ptp(distance) > 0.7
    assert np.count_nonzero(np.diff(np.sign(distance))) >= 2, "it does not cross the target back and forth"
    assert axes.get_ylim()[0] < distance.min() < distance.max() < axes.get_ylim()[1], "it leaves the view"


@pytest.mark.parametrize(("name", "rest"), [("pd-low", (0.9, 1.2)), ("pd-high", (0.02, 0.1))])
def test_simulation_shows_rest_off_the_target(simulation: Figure, name: str, rest: tuple[float, float]) -> None:
    axes, _, distance = magnified(simulation, name)
    assert rest[0] < distance.min() < distance.max() < rest[1]
    assert np.ptp(distance) < 0.01
    assert distance.mean() > 0.1 * axes.get_ylim()[1], "too small to be seen"


def test_simulation_shows_no_error_under_pid_high(simulation: Figure) -> None:
    axes, _, distance = magnified(simulation, "pid-high")
    assert np.abs(distance).max() < 0.1 * axes.get_ylim()[1]


def test_first_break_away_is_below_f_s_and_the_slow_one_near_it() -> None:
    fast, faster, slow = (break_away(panels(QUICK)[view.name], view.start)[1] for view in VIEWS)
    assert faster < fast < 1.15
    assert 1.4 < slow < float(FRICTION.f_s)
