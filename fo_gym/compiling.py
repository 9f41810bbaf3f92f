"""Compile plain Python, and keep what was compiled on disk for as long as nothing in it has changed.

Numba's own cache of a function looks at the time stamp of that function's file alone. What is compiled here is made of
functions of several files, a user's law among them: it is kept under the content of all that it is made of.
"""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable, Iterator
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any

from numba import njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic

_LOGGER = logging.getLogger("fo_gym")

__all__ = ["compiled", "content", "jit", "kept"]


def jit(function: Any) -> Any:
    """A function of the project, compiled when it is first called, and kept on disk."""
    return kept(njit(error_model="numpy", nogil=True)(function), function.__name__.strip("_"))


def compiled(function: Any, done: dict[Any, Any] | None = None) -> Any:
    """A function compiled by Numba, and with it the plain functions that it calls.

    Args:
        function: plain, or compiled by its author, and then as it is.
        done: those that have been compiled on the way here.
    """
    if not isinstance(function, FunctionType):
        return function
    done = {} if done is None else done
    if function not in done:
        called = {
            name: compiled(function.__globals__[name], done)
            for name in function.__code__.co_names
            if isinstance(function.__globals__.get(name), FunctionType)
            and function.__globals__[name].__module__.partition(".")[0] not in ("math", "numpy")
        }
        copy = FunctionType(
            function.__code__,
            {**function.__globals__, **called},
            function.__name__,
            function.__defaults__,
            tuple(CellType(compiled(cell.cell_contents, done)) for cell in function.__closure__ or ()) or None,
        )
        copy.__module__, copy.__qualname__ = __name__, function.__qualname__  # a module that who loads the kernel finds
        done[function] = njit(error_model="numpy", nogil=True)(copy)
    return done[function]


def content(function: Any) -> str:
    """Hash of what a function does: its code, the constants it reads, and so on for the functions that it calls."""
    return hashlib.sha256("\n".join(_parts(function, set())).encode()).hexdigest()


def _parts(thing: Any, seen: set[int]) -> Iterator[str]:
    if isinstance(thing, Dispatcher):
        yield repr(sorted(thing.targetoptions.items(), key=str))
        thing = thing.py_func
    if isinstance(thing, _Intrinsic):
        yield from _of_intrinsic(thing)
        return
    if not isinstance(thing, FunctionType):
        yield thing.__name__ if isinstance(thing, ModuleType | type) else repr(thing)
        return
    if id(thing.__code__) in seen:
        return
    seen.add(id(thing.__code__))
    yield from _code(thing.__code__)
    for value in (*(thing.__defaults__ or ()), *(cell.cell_contents for cell in thing.__closure__ or ())):
        yield from _parts(value, seen)
    for name in thing.__code__.co_names:
        if name in thing.__globals__:
            yield name
            yield from _parts(thing.__globals__[name], seen)
            if isinstance(module := thing.__globals__[name], ModuleType):
                yield from _of_module(module, thing.__code__.co_names, seen)


def _of_intrinsic(thing: Any) -> Iterator[str]:
    """What an intrinsic generates: its code, and that of the functions around it."""
    yield from _code(thing._defn.__code__)
    for cell in thing._defn.__closure__ or ():
        if isinstance(cell.cell_contents, FunctionType):
            yield from _code(cell.cell_contents.__code__)
        else:
            yield repr(cell.cell_contents)


def _of_module(module: ModuleType, names: tuple[str, ...], seen: set[int]) -> Iterator[str]:
    """What a function reads of a module, but for NumPy's and Python's own."""
    if module.__name__.partition(".")[0] not in ("math", "numpy", "numba"):
        for name in names:
            if hasattr(module, name):
                yield name
                yield from _parts(getattr(module, name), seen)


def _code(code: CodeType) -> Iterator[str]:
    yield code.co_code.hex()
    yield repr(code.co_names) + repr(code.co_varnames) + repr(code.co_freevars)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _code(constant)
        else:
            yield repr(constant)


class _ContentCache(FunctionCache):
    """Numba's cache of one function, valid for as long as its content is the same."""

    def __init__(self, function: Any, name: str, stamp: str, slow: str) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._stamp, self._slow = stamp, slow
        base = f"{self._impl.filename_base}-{name}"
        # A changed law overwrites what it was: one file per law.
        self._cache_file = IndexDataCacheFile(self.cache_path, base, stamp)  # type: ignore[no-untyped-call]

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        return sig, codegen.magic_tuple(), self._stamp

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was compiled before, or None."""
        found = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        if found is None and self._slow:
            _LOGGER.warning("compiling %s for this machine, once: some ten seconds", self._slow)
        return found


def kept(dispatcher: Any, name: str, slow: str = "") -> Callable[..., Any]:
    """The compiled function, kept on disk beside its file under `name`, and compiled anew where its content changed.

    Args:
        dispatcher: of Numba, not compiled yet.
        name: of its file.
        slow: what to call it, where it takes so long to compile that people are told.
    """
    dispatcher._cache = _ContentCache(dispatcher.py_func, name, content(dispatcher), slow)
    dispatcher.kept_as = name
    return dispatcher
