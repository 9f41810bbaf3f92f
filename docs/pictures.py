"""Draw the pictures of the README and of the documentation with the code as it is: `python docs/pictures.py`.

Without a display, set MUJOCO_GL=egl (or osmesa) first.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

import fo_gym
from fo_gym.envs.rendering import SceneRenderer

Image = NDArray[np.uint8]

IMAGES = Path(__file__).parent / "images"
HEIGHT, WIDTH = 1440, 1920

# When an environment's picture is taken [s], and which part of it is shown (left, top, size, in shares).
VIEWS = {
    "FJRStiction-v0": (0.22, (0.11, 0.12, 0.78)),
    "FJRRegulation-v0": (3.25, (0.10, 0.05, 0.85)),
    "FJRSquare-v0": (4.35, (0.10, 0.05, 0.85)),
    "FJRTracking-v0": (4.0, (0.10, 0.05, 0.85)),
    "FJRInteraction-v0": (3.0, (0.10, 0.05, 0.85)),
}
PANELS = {
    "FJRStiction-v0": "one joint: a step of 10 mm against stiction",
    "FJRRegulation-v0": "seven joints: a step of $-5°$, then a push",
    "FJRSquare-v0": "seven joints: the tool draws a square of 15 cm",
}
TRACES = {
    "pid-low": ("C1", "PID-type, low gains: hunts"),
    "pd-low": ("C4", "PD-type, low gains: stops short"),
    "pid-high": ("C0", "PID-type, high gains: arrives"),
}
SOCIAL = (1280, 640)
"""Size of the card that is shown where a link to the project is shared [pixels]."""


def played(env_id: str, seconds: float, compensator: str) -> Iterator[tuple[Any, dict[str, Any]]]:
    """The simulation and its truth after each step under a compensator."""
    observer = fo_gym.make_compensator(compensator)
    env = gym.make(env_id, feedback=observer.feedback)
    observation, _ = env.reset(seed=0)
    joints = env.unwrapped.joint_info
    observer.reset(joints, 1)
    for _ in range(round(seconds / joints.control_dt)):
        signals = fo_gym.Signals.from_observation(observation[None], joints.dof)
        observation, *_, info = env.step(observer.estimate(signals)[0])
        yield env.unwrapped.simulation, info
    env.close()


def picture(env_id: str, compensator: str = "pid-high") -> Image:
    """The part of the environment that is shown, when its picture is taken: (height, width, 3)."""
    seconds, part = VIEWS[env_id]
    renderer = None
    for simulation, _ in played(env_id, seconds, compensator):
        renderer = renderer or SceneRenderer(simulation, "rgb_array", HEIGHT, WIDTH)
        renderer.watch(simulation)
    image = renderer.frame(simulation)
    renderer.close()
    return crop(image, *part)


def crop(image: Image, left: float, top: float, size: float) -> Image:
    """The part of the same shape that begins at (left, top), all in shares of the image."""
    height, width, _ = image.shape
    return image[int(top * height) : int((top + size) * height), int(left * width) : int((left + size) * width)]


def halved(image: Image) -> Image:
    """The image at half the size, each pixel the mean of four."""
    height, width = (size // 2 for size in image.shape[:2])
    blocks = image[: 2 * height, : 2 * width].reshape(height, 2, width, 2, 3)
    return blocks.mean(axis=(1, 3)).astype(np.uint8)


def add_closeup(axes: Axes, image: Image) -> None:
    """Enlarge, in a corner, what is red: the trace of the tool."""
    red, green, blue = (image[..., channel].astype(int) for channel in range(3))
    rows, columns = np.nonzero((red - green > 90) & (red - blue > 60))
    margin = 30
    part = image[rows.min() - margin : rows.max() + margin, columns.min() - margin : columns.max() + margin]
    inset = axes.inset_axes((0.645, 0.50, 0.345, 0.48))
    inset.imshow(part)
    inset.set(xticks=[], yticks=[])


def each_environment() -> dict[str, Image]:
    """A picture of every environment, for its page."""
    pictures = {env_id: picture(env_id) for env_id in fo_gym.ENVIRONMENTS}
    for env_id, image in pictures.items():
        plt.imsave(IMAGES / f"{env_id}.png", halved(image))
    return pictures


def environments(pictures: dict[str, Image]) -> None:
    """One row: three of the environments."""
    figure, row = plt.subplots(1, 3, figsize=(12.6, 3.75), layout="constrained")
    for axes, (env_id, what) in zip(row, PANELS.items(), strict=True):
        axes.imshow(pictures[env_id])
        axes.set(xticks=[], yticks=[])
        axes.set_title(env_id, fontsize=13, family="monospace")
        axes.set_xlabel(what, fontsize=11)
    add_closeup(row[2], pictures["FJRSquare-v0"])
    figure.savefig(IMAGES / "environments.png", dpi=100)


def social() -> None:
    """The card: what the project is, and the two ways to miss the target."""
    width, height = SOCIAL
    figure = plt.figure(figsize=(width / 100, height / 100), facecolor="white")
    figure.text(0.05, 0.80, "fo-gym", fontsize=60, weight="bold", va="center")
    figure.text(0.05, 0.63, "The public benchmark for friction\ncompensation on robot joints", fontsize=23, va="center")
    axes = figure.add_axes((0.08, 0.14, 0.53, 0.34))
    for name, (colour, label) in TRACES.items():
        theta = np.array([info["theta"][0] for _, info in played("FJRStiction-v0", 20.0, name)])
        axes.plot(1e-3 * np.arange(1, len(theta) + 1), 1e3 * theta - 10.0, color=colour, linewidth=2.5, label=label)
    axes.set(xlim=(0, 20), ylim=(-1.3, 1.6), xlabel="time [s]", ylabel="off target [mm]")
    axes.xaxis.label.set_size(15)
    axes.yaxis.label.set_size(15)
    axes.tick_params(labelsize=13)
    axes.spines[["top", "right"]].set_visible(False)
    lines = axes.get_legend_handles_labels()
    figure.legend(*lines, loc="center left", bbox_to_anchor=(0.635, 0.31), fontsize=15, frameon=False)
    scene = figure.add_axes((0.64, 0.50, 0.34, 0.46))
    scene.imshow(picture("FJRSquare-v0"))
    scene.axis("off")
    figure.savefig(IMAGES / "social.png", dpi=100)


if __name__ == "__main__":
    IMAGES.mkdir(exist_ok=True)
    environments(each_environment())
    social()
