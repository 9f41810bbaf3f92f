"""`fo-gym render`: a film of competitors side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fo_gym.cli.work import RobotOption
from fo_gym.console import Stop, check_folder, progress_bar, tell_written

if TYPE_CHECKING:
    from fo_gym.evaluation.competitors.competitor import Competitor
    from fo_gym.evaluation.runs.episodes import EpisodeSet

OUT = Path("build/render.mp4")
_MOST = 4
_FPS = {".mp4": 25.0, ".gif": 12.5}

__all__ = ["OUT", "run_render"]


def run_render(
    compensators: Annotated[
        list[str],
        typer.Argument(metavar="COMPENSATOR...", help="Up to four, as for `fo-gym evaluate`; none and ideal too."),
    ],
    env: Annotated[str, typer.Option(help="Environment id; see `fo-gym list`.")] = "FJRStiction-v0",
    robot: RobotOption = None,
    variant: Annotated[str, typer.Option(help="nominal, randomized or hardware.")] = "nominal",
    seed: Annotated[int, typer.Option(min=0, help="Of the episode.")] = 0,
    duration: Annotated[float | None, typer.Option(help="Length of the episode, s; by default the task's own.")] = None,
    speed: Annotated[float, typer.Option(min=0.01, max=100.0, help="Simulated seconds per second of the film.")] = 1.0,
    out: Annotated[Path, typer.Option(dir_okay=False, help="A file .mp4 or .gif.")] = OUT,
) -> None:
    """Film competitors side by side in the same episode: the scene, what moves magnified, and curves that grow with it.

    A joint's curve is its distance from the target, in a second row magnified; on a tool path it is the tool's distance
    from where it would be without friction, and the scene has the reference and the tool's trace. It needs
    imageio-ffmpeg, and without a display MUJOCO_GL=egl (or osmesa). The same command gives the same film.

    Examples:
        fo-gym render none pid-low pd-low pid-high --speed 2 --out hunting.gif

        fo-gym render none pid-high --env FJRSquare-v0 --out square.mp4

        fo-gym render mine.py:Mine pid-high --variant hardware --seed 3
    """
    from importlib.util import find_spec

    from fo_gym.extras import install_command

    if len(compensators) > _MOST:
        raise Stop(f"{len(compensators)} compensators were given; a film shows at most {_MOST} side by side")
    if out.suffix not in _FPS:
        raise Stop(f"--out is {out}; give a file that ends with {' or '.join(_FPS)}")
    check_folder("--out", out.parent)
    if find_spec("imageio_ffmpeg") is None:
        raise Stop(f"imageio-ffmpeg is not installed; install it with: {install_command('video')}")
    from fo_gym.compensators import CompensatorError
    from fo_gym.evaluation.competitors.entry import competitor_of
    from fo_gym.evaluation.runs.episodes import EpisodeSet
    from fo_gym.evaluation.runs.evaluate import check_arguments

    chosen: dict[str, Any] = {"robot": robot, "duration": duration}
    kwargs = {name: value for name, value in chosen.items() if value is not None}
    try:
        check_arguments(env, variant, kwargs)
        episode = EpisodeSet(env, variant, (seed,), kwargs)
        competitors = [competitor_of(name) for name in compensators]
        _film(competitors, episode, speed, out)
    except (ValueError, TypeError, OSError, CompensatorError, RuntimeError) as error:
        raise Stop(str(error)) from error
    tell_written([out])


def _film(competitors: list[Competitor], episode: EpisodeSet, speed: float, out: Path) -> None:
    """Run everybody, draw and write, behind a progress bar of frames."""
    from fo_gym.evaluation.competitors.entry import competitor_of
    from fo_gym.evaluation.results.film.layout import frames
    from fo_gym.evaluation.results.film.takes import take
    from fo_gym.evaluation.results.film.writing import write_film

    fps = _FPS[out.suffix]
    *takes, ideal = (take(each, episode, speed / fps) for each in (*competitors, competitor_of("ideal")))
    shown = f", {speed:g} times as fast" if speed > 1.0 else f", {1.0 / speed:g} times as slow" if speed < 1.0 else ""
    title = f"{episode.label}{'' if episode.variant == 'nominal' else f', seed {episode.seeds[0]}'}{shown}"
    drawn = frames(takes, ideal, title)
    with progress_bar(max(len(each.states) for each in takes)) as advance:
        # A frame shows whole steps; as many come in a second as the speed asks for.
        write_film((told for told in drawn if advance("drawing", 1) is None), out, speed / ideal.frame_dt)
