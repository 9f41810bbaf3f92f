"""The joint kernel of each friction law: compiled when it is first used, and kept on disk."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable
from typing import Any

from fo_gym.compiling import compiled, kept
from fo_gym.friction import FrictionLaw
from fo_gym.plant import kernel

_KERNELS: dict[tuple[type[FrictionLaw], int], Callable[..., None]] = {}

__all__ = ["kernel_of"]


def kernel_of(law: FrictionLaw) -> Callable[..., None]:
    """`advance` of fo_gym.plant.kernel for all laws of this one's class and number of states."""
    kind, states = type(law), law.states
    if (kind, states) not in _KERNELS:
        done: dict[Any, Any] = {}
        respond, step = compiled(kind.respond, done), compiled(kind.step, done)
        made = kernel.kernel(respond, step, states, max(1, law.memory))  # type: ignore[no-untyped-call]
        name = f"{kind.__name__}-{states}-{_place(kind)}"
        _KERNELS[kind, states] = kept(made, name, slow=f"the joint kernel of {kind.__name__}")
    return _KERNELS[kind, states]


def _place(kind: type) -> str:
    """What tells laws of the same name in different files apart."""
    try:
        file = inspect.getfile(kind)
    except (OSError, TypeError):  # defined at a prompt
        file = kind.__module__
    return hashlib.sha256(f"{file}:{kind.__qualname__}".encode()).hexdigest()[:12]
