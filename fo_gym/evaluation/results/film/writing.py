"""How frames become a file: MP4 or GIF, by ffmpeg, the same bytes for the same frames."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fo_gym.files import draft_of

Image = NDArray[np.uint8]

_BITEXACT = ["-fflags", "+bitexact", "-flags:v", "+bitexact", "-threads", "1", "-map_metadata", "-1"]
_KINDS: dict[str, dict[str, Any]] = {
    ".mp4": {"codec": "libx264", "pix_fmt_out": "yuv420p", "output_params": ["-crf", "20", *_BITEXACT]},
    ".gif": {
        "codec": "gif",
        "pix_fmt_out": "pal8",
        # One palette for all frames, no dithering, and of each frame only what changed: small, and nothing flickers.
        "output_params": [
            "-filter_complex",
            "split[a][b];[a]palettegen=max_colors=96:stats_mode=full[p];"
            "[b][p]paletteuse=dither=none:diff_mode=rectangle",
            *_BITEXACT,
        ],
    },
}
ENDINGS = tuple(_KINDS)
"""Of the files that can be written."""

__all__ = ["ENDINGS", "write_film"]


def write_film(frames: Iterator[Image], path: Path, fps: float) -> Path:
    """Write a film, whole or not at all; returns the file.

    Args:
        frames: (height, width, 3) each, all of the same size.
        path: with one of `ENDINGS`.
        fps: frames per second.

    Raises:
        ModuleNotFoundError: imageio-ffmpeg is not installed.
    """
    import imageio_ffmpeg  # noqa: PLC0415 (an extra)

    first = next(frames)
    height, width, _ = first.shape
    with draft_of(path) as draft:
        writer = imageio_ffmpeg.write_frames(
            str(draft), (width, height), fps=fps, quality=None, macro_block_size=2, **_KINDS[path.suffix]
        )
        writer.send(None)
        writer.send(first.tobytes())
        for frame in frames:
            writer.send(frame.tobytes())
        writer.close()
    return path
