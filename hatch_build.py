"""Where the project is, for the package's page on PyPI: known where a workflow builds it, and nowhere else."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

_LINK = re.compile(r"(!?)(\[[^\]]*\])\((?!https?://|#)([^)]+)\)")


def urls(server: str, repository: str) -> dict[str, str]:
    """The project's addresses, by what PyPI calls them."""
    home = f"{server}/{repository}"
    owner, _, name = repository.partition("/")
    pages = f"https://{owner.lower()}.github.io/{name}"
    return {
        "Homepage": f"{pages}/",
        "Documentation": f"{pages}/docs/",
        "Repository": home,
        "Issues": f"{home}/issues",
        "Changelog": f"{home}/blob/main/CHANGELOG.md",
    }


def absolute(text: str, home: str) -> str:
    """A page of the repository whose links and pictures are found from elsewhere."""
    return _LINK.sub(
        lambda found: f"{found[1]}{found[2]}({home}/{'raw' if found[1] else 'blob'}/main/{found[3]})", text
    )


class MetadataHook(MetadataHookInterface):
    """Adds `urls` and `readme`."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Fill in what pyproject.toml calls dynamic."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["urls"] = {"Paper": "https://arxiv.org/abs/1907.00553"}
        if repository := os.environ.get("GITHUB_REPOSITORY"):
            server = os.environ["GITHUB_SERVER_URL"]
            metadata["urls"] |= urls(server, repository)
            text = absolute(text, f"{server}/{repository}")
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
