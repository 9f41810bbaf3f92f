"""Draw the pictures of the README with the code as it is: `python docs/pictures.py`.

Without a display, set MUJOCO_GL=egl (or osmesa) first.
"""

from __future__ import annotations

from pathlib import Path

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

# Environment, when its picture is taken [s], which part is shown (left, top, size, in shares), what it does.
PANELS = (
    ("FJRStiction-v0", 0.22, (0.11, 0.12, 0.78), "one joint: a step of 10 mm against stiction"),
    ("FJRRegulation-v0", 3.25, (0.10, 0.05, 0.85), "seven joints: a step of $-5°$, then a push"),
    ("FJRSquare-v0", 4.35, (0.10, 0.05, 0.85), "seven joints: the tool draws a square of 15 cm"),
)


def picture(env_id: str, seconds: float, compensator: str = "pid-high") -> Image:
    """The environment as it looks after `seconds` under a compensator: (HEIGHT, WIDTH, 3)."""
    observer = fo_gym.make_compensator(compensator)
    env = gym.make(env_id, feedback=observer.feedback)
    observation, _ = env.reset(seed=0)
    joints = env.unwrapped.joint_info
    observer.reset(joints, 1)
    renderer = SceneRenderer(env.unwrapped.simulation, "rgb_array", HEIGHT, WIDTH)
    for _ in range(round(seconds / joints.control_dt)):
        signals = fo_gym.Signals.from_observation(observation[None], joints.dof)
        observation, *_ = env.step(observer.estimate(signals)[0])
        renderer.watch(env.unwrapped.simulation)
    image = renderer.frame(env.unwrapped.simulation)
    renderer.close()
    env.close()
    return image


def crop(image: Image, left: float, top: float, size: float) -> Image:
    """The part of the same shape that begins at (left, top), all in shares of the image."""
    height, width, _ = image.shape
    return image[int(top * height) : int((top + size) * height), int(left * width) : int((left + size) * width)]


def add_closeup(axes: Axes, image: Image) -> None:
    """Enlarge, in a corner, what is red: the trace of the tool."""
    red, green, blue = (image[..., channel].astype(int) for channel in range(3))
    rows, columns = np.nonzero((red - green > 90) & (red - blue > 60))
    margin = 30
    part = image[rows.min() - margin : rows.max() + margin, columns.min() - margin : columns.max() + margin]
    inset = axes.inset_axes((0.645, 0.50, 0.345, 0.48))
    inset.imshow(part)
    inset.set(xticks=[], yticks=[])


def environments() -> None:
    """One row: the three environments."""
    figure, row = plt.subplots(1, 3, figsize=(12.6, 3.75), layout="constrained")
    for axes, (env_id, seconds, part, what) in zip(row, PANELS, strict=True):
        image = crop(picture(env_id, seconds), *part)
        axes.imshow(image)
        axes.set(xticks=[], yticks=[])
        axes.set_title(env_id, fontsize=13, family="monospace")
        axes.set_xlabel(what, fontsize=11)
    add_closeup(row[2], image)
    figure.savefig(IMAGES / "environments.png", dpi=100)


if __name__ == "__main__":
    IMAGES.mkdir(exist_ok=True)
    environments()
