"""Laws by name: those of the project, and those of a user's file or module."""

from __future__ import annotations

import inspect
from importlib import import_module
from pathlib import Path

from fo_gym.checks import shown
from fo_gym.friction.dahl import Dahl
from fo_gym.friction.elasto_plastic import ElastoPlastic
from fo_gym.friction.law import FrictionLaw
from fo_gym.friction.lugre import LuGre
from fo_gym.friction.maxwell_slip import MaxwellSlip
from fo_gym.modules import file_module, is_of_file
from fo_gym.specs import spec_of

LAWS: dict[str, type[FrictionLaw]] = {kind.__name__: kind for kind in (LuGre, ElastoPlastic, MaxwellSlip, Dahl)}
"""The project's own."""

__all__ = ["LAWS", "law_class", "law_name"]


def law_class(name: object) -> type[FrictionLaw]:
    """The class of that name: one of LAWS, "file.py:Class" or "module:Class".

    Raises:
        ValueError: there is none, or it is no friction law.
    """
    if isinstance(name, str) and name in LAWS:
        return LAWS[name]
    spec = spec_of(name) if isinstance(name, str) else None
    if spec is None or spec.kind not in ("file", "module"):
        raise ValueError(f"law is {shown(name)}; known are {', '.join(LAWS)}, or give file.py:Class or module:Class")
    try:
        module = file_module(Path(spec.where)) if spec.kind == "file" else import_module(spec.where)
        kind = getattr(module, spec.attribute)
    except (ImportError, AttributeError, OSError) as error:
        raise ValueError(f"law {shown(name)} cannot be had: {error}") from error
    if not inspect.isclass(kind) or not issubclass(kind, FrictionLaw):
        raise ValueError(f"law {shown(name)} is {shown(kind)}; give a class derived from fo_gym.friction.FrictionLaw")
    return kind


def law_name(kind: type[FrictionLaw]) -> str:
    """The name by which `law_class` finds it."""
    if LAWS.get(kind.__name__) is kind:
        return kind.__name__
    where = inspect.getfile(kind) if is_of_file(kind.__module__) else kind.__module__
    return f"{where}:{kind.__qualname__}"
