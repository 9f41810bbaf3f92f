"""What single and vector environments have in common: a simulation, and a renderer that is made when it is needed."""

from __future__ import annotations

from typing import Any

from fo_gym.envs.rendering import SceneRenderer
from fo_gym.simulation.simulation import Simulation

__all__ = ["Drawn"]


class Drawn:
    """A simulation that can be drawn.

    Attributes:
        simulation: what is drawn.
        render_mode: None, or how.
    """

    simulation: Simulation
    render_mode: str | None
    _renderer: SceneRenderer | None = None

    @property
    def available(self) -> frozenset[str]:
        """Names of the signals that the sensors provide; the others are zero."""
        return self.simulation.available

    def _renderer_now(self) -> SceneRenderer:
        if self._renderer is None:
            self._renderer = SceneRenderer(self.simulation, self.render_mode)
        return self._renderer

    def _close_renderer(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def __getstate__(self) -> dict[str, Any]:
        # A renderer holds an OpenGL context or a window; the copy makes its own when asked to draw.
        return {**self.__dict__, "_renderer": None}
