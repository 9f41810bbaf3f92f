"""The chart libraries, taken from the packages at hand when the page is built: nothing is fetched, none is kept here.

uPlot draws traces: it is a hundredth of Plotly's size, and as quick with thousands of points. PyPI has it inside
youplot alone, whose copy is, byte for byte, that of uPlot's own release; a hash holds it to that, and youplot's Python
is never imported. Plotly draws maps, from its own package, and is loaded where there are some and they are looked at.
"""

from __future__ import annotations

import hashlib
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

UPLOT = {
    "uplot.js": (
        "youplot/vendor/uplot.iife.min.js",
        "2d27e8ad3d228164525ce213f9dc716f39b4e3aee0cc773fb3491c96cf4921a2",
    ),
    "uplot.css": ("youplot/vendor/uplot.min.css", "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04"),
}
"""uPlot 1.6.31 (MIT): where its files lie in the package, and their SHA-256 as released (npm's uplot 1.6.31, dist/)."""
_PLOTLY = "plotly/package_data/plotly.min.js"

__all__ = ["MissingPackageError", "plotly", "uplot"]


class MissingPackageError(ModuleNotFoundError):
    """A package that the page is built from is not there, or not as it should be."""


def uplot() -> dict[str, bytes]:
    """The files of uPlot by the names that the page gives them.

    Raises:
        MissingPackageError: youplot is not installed, or has another uPlot.
    """
    package = _package("youplot")
    found = {}
    for name, (place, expected) in UPLOT.items():
        found[name] = _content(package, place)
        actual = hashlib.sha256(found[name]).hexdigest()
        if actual != expected:
            raise MissingPackageError(
                f"{place} of youplot {package.version} has the SHA-256 {actual}, uPlot 1.6.31 has {expected}; "
                "install youplot 1.0.0"
            )
    return found


def plotly() -> bytes:
    """Plotly's script. Raises MissingPackageError where plotly is not installed."""
    return _content(_package("plotly"), _PLOTLY)


def _package(name: str) -> Distribution:
    try:
        return distribution(name)
    except PackageNotFoundError as error:
        raise MissingPackageError(f"there is no package {name}") from error


def _content(package: Distribution, place: str) -> bytes:
    path = Path(str(package.locate_file(place)))
    if not path.is_file():
        raise MissingPackageError(f"{package.name} {package.version} has no {place}")
    return path.read_bytes()
