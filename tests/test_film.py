"""Films: every competitor does what it does alone, magnified as stated; the same film is the same file."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")

import imageio_ffmpeg
import numpy as np
import pytest
from commands import run

import fo_gym
from fo_gym.cli import render
from fo_gym.envs.rendering import SceneRenderer
from fo_gym.evaluation.competitors.entry import competitor_of
from fo_gym.evaluation.results.film import layout, writing
from fo_gym.evaluation.results.film.takes import Take, curves_of, take
from fo_gym.evaluation.results.film.writing import write_film
from fo_gym.evaluation.runs.episodes import EpisodeSet

pytestmark = pytest.mark.looks

STICTION, SQUARE = "FJRStiction-v0", "FJRSquare-v0"
FRAME_DT = 0.1


def taken(env_id: str, *names: str, duration: float = 0.4) -> list[Take]:
    episode = EpisodeSet(env_id, "nominal", (0,), {"duration": duration})
    return [take(competitor_of(name), episode, FRAME_DT) for name in names]


@pytest.fixture(scope="module")
def link() -> list[Take]:
    return taken(STICTION, "none", "pid-low", "ideal")


def test_a_take_is_the_episode_that_is_scored(link: list[Take]) -> None:
    trace = fo_gym.trace("pid-low", STICTION, duration=0.4)
    ticks = np.rint(trace.signals["time"] / 1e-3).astype(int)
    theta = link[1].recording.ticks["theta"][:, 0]
    np.testing.assert_array_equal(theta[ticks].astype(np.float32), trace.signals["theta"])
    assert len(link[1].states) == 5
    for number, state in enumerate(link[1].states):
        np.testing.assert_array_equal(state.plant.theta[0], theta[100 * number])


def test_the_curves(link: list[Take]) -> None:
    (none, low, _), what, logarithmic = curves_of(link, link[-1])
    assert (what, logarithmic) == ("from its target [mm]", False)
    assert none[0] == low[0] == pytest.approx(-10.0)
    assert low[-1] == pytest.approx(1e3 * (link[1].recording.ticks["theta"][-1, 0, 0] - 0.01))
    square = taken(SQUARE, "none", "ideal", duration=0.2)
    (none, ideal), what, logarithmic = curves_of(square, square[-1])
    assert (what, logarithmic) == ("from the friction-free tool [mm]", True)
    assert none[-1] > 1.0
    assert not ideal.any()


def test_what_is_little_has_a_row_of_its_own(link: list[Take]) -> None:
    still = np.full(400, -10.0)
    hunting = np.concatenate([np.linspace(-10.0, 4.0, 200), 0.5 * np.sin(np.arange(200))])
    rows = layout._limits(link[:2], [still, hunting], logarithmic=False)
    assert len(rows) == 2
    assert rows[0][0] < -10.0
    assert rows[0][1] > 4.0
    assert rows[1] == pytest.approx((-0.65, 0.65), rel=0.01)
    assert len(layout._limits(link[:2], [still, 8.0 * hunting], logarithmic=False)) == 2
    assert len(layout._limits(link[:2], [still, np.linspace(-10.0, 4.0, 400)], logarithmic=False)) == 1


def test_a_closeup_is_magnified_as_it_says(link: list[Take]) -> None:
    """The motor's orange pointer covers as many times more pixels across."""
    low = link[1]
    low.simulation.set_state(low.states[0])
    renderer = SceneRenderer(low.simulation, "rgb_array", 300, 400)
    start = renderer.followed(low.simulation)
    end = start + np.array([0.02, 0.0, 0.0])
    closeup = renderer.closeup(np.array([start, end]), room=2.0)
    own, near = renderer.frame(low.simulation), renderer.frame(low.simulation, 0, closeup)
    again = renderer.frame(low.simulation)
    renderer.close()
    assert own is not None
    assert near is not None
    np.testing.assert_array_equal(own, again)
    # 40 mm fill the width of the picture: the pointer, 2 mm wide, is 20 pixels wide.
    orange = (near[..., 0].astype(int) - near[..., 2] > 100) & (near[..., 0] > 150)
    assert np.median(orange.sum(axis=1)[orange.any(axis=1)]) == pytest.approx(20.0, abs=3.0)
    # The camera of the robot file is there, and sees 10 degrees; it looks a little askew at the rail.
    away = np.linalg.norm(0.5 * (start + end) - [-0.075, -1.20, 0.58])
    assert closeup.magnification == pytest.approx(2.0 * away * np.tan(np.deg2rad(5.0)) / 0.03, rel=3e-3)


@pytest.mark.parametrize("env_id", [STICTION, SQUARE])
def test_frames(env_id: str) -> None:
    *takes, ideal = taken(env_id, "none", "pid-low", "ideal", duration=0.3)
    first = list(layout.frames(takes, ideal, "title"))
    assert len(first) == 4
    assert len({frame.shape for frame in first}) == 1
    assert all(side % 2 == 0 for side in first[0].shape[:2])
    assert not np.array_equal(first[0], first[-1])
    assert np.abs(first[0].astype(int) - first[-1])[40:200, first[0].shape[1] // 2 :].max() > 20  # pid-low has moved
    for number, (one, again) in enumerate(zip(first, layout.frames(takes, ideal, "title"), strict=True)):
        np.testing.assert_array_equal(again, one, err_msg=f"frame {number} is not the same again")


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_film_is_the_same_file_again(tmp_path: Path, ending: str) -> None:
    ramp = np.linspace(0, 255, 64 * 48).reshape(48, 64, 1).astype(np.uint8)
    frames = [np.repeat(np.roll(ramp, 7 * k, axis=1), 3, axis=2) for k in range(5)]
    files = [write_film(iter(frames), tmp_path / f"{name}{ending}", 12.5) for name in ("one", "two")]
    assert files[0].read_bytes() == files[1].read_bytes()
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(files[0]), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    read = subprocess.run(command, capture_output=True, check=True)
    assert b"64x48" in read.stderr
    assert b"12.50 fps" in read.stderr or b"12.5 fps" in read.stderr
    shown = np.frombuffer(read.stdout, np.uint8).reshape(-1, 48, 64, 3)
    assert len(shown) == 5
    assert np.abs(shown[2].astype(int) - frames[2]).mean() < 8.0


def test_the_command(tmp_path: Path) -> None:
    out = tmp_path / "films" / "link.gif"
    outcome = run("render", "none", "pid-low", "--duration", "0.3", "--speed", "2", "--out", str(out))
    assert outcome.code == 0, outcome.err
    assert out.read_bytes().startswith(b"GIF8")
    assert f"wrote {out}" in outcome.out.replace("\n", "")


def test_clock_curve_and_pictures_agree_at_any_speed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames that would be 0.4 steps apart are one step apart, and a second of the film is still 10 ms."""
    shown: list[float] = []
    rates: list[float] = []

    def write(frames: Iterator[np.ndarray], path: Path, fps: float) -> None:
        assert len(list(frames)) == 6
        rates.append(fps)

    monkeypatch.setattr(layout._Column, "draw", lambda column, number, seconds, closeup: shown.append(seconds))
    monkeypatch.setattr(writing, "write_film", write)
    outcome = run("render", "none", "--duration", "0.005", "--speed", "0.01", "--out", str(tmp_path / "slow.mp4"))
    assert outcome.code == 0, outcome.err
    assert shown == pytest.approx(1e-3 * np.arange(6))
    assert rates == pytest.approx([10.0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("a b c d e", "at most 4 side by side"),
        ("none --out film.avi", "give a file that ends with .mp4 or .gif"),
        ("nobody", "unknown compensator 'nobody'"),
        ("none --env Nothing-v0", "unknown environment"),
        ("none --variant wild", "variant is 'wild'"),
        ("none --duration -1", "duration is -1"),
    ],
)
def test_what_the_command_refuses(arguments: str, message: str) -> None:
    outcome = run("render", *arguments.split())
    assert (outcome.code, message in " ".join(outcome.err.split())) == (2, True), outcome.err


def test_without_ffmpeg_the_command_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    outcome = run("render", "none")
    assert outcome.code == 2
    assert "install it with:" in " ".join(outcome.err.split())


def test_there_is_a_frame_rate_for_every_kind_of_film() -> None:
    from fo_gym.evaluation.results.film.writing import ENDINGS  # noqa: PLC0415

    assert set(ENDINGS) == set(render._FPS)
