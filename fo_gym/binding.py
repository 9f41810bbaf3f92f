"""Compiled functions bound to their arrays: what is the same in every call is not handed over in every call.

To hand an array to a compiled function takes longer than the function has to do for a few joints: Python's object is
looked at, and an owner of its memory is made and thrown away. A bound function is handed one number instead, the place
of a table that says where the arrays are.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import cache, cached_property, partial
from itertools import count
from typing import Any, ClassVar

import numpy as np
from numba import njit, typeof, types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from fo_gym.compiling import content, kept

__all__ = ["Binds", "Bound", "bound"]


class Bound(partial[Any]):
    """A compiled function with its first arguments given; see `bound`.

    Attributes:
        held: what it is bound to, which stays alive with it.
    """

    held: tuple[Any, ...]

    @cached_property
    def address(self) -> int:
        """Of a C function that does the same, given the address of the table, `args[0]`; no argument may be left."""
        entry: Any = self.func
        entry.compile((types.int64,))
        made = entry.overloads[types.int64,]
        return int(made.library.get_pointer_to_function(made.fndesc.llvm_cfunc_wrapper_name))

    def __reduce__(self) -> Any:
        raise TypeError(
            "a bound function knows where its arrays are in this process; name it among its owner's bindings, see Binds"
        )


class Binds:
    """An object with bound functions: they are not pickled with it, but bound anew to what was. Derive from it.

    Arrays that are views of others come as copies out of a pickle: who has such names them again before it binds.

    Attributes:
        bindings: names of what `bind` makes.
    """

    bindings: ClassVar[tuple[str, ...]] = ()

    def bind(self) -> None:
        """Make the bound functions; to be called when everything they are bound to is there."""

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name not in self.bindings}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.bind()


def bound(function: Any, *arguments: Any) -> Bound:
    """A compiled function with its first arguments given, which stand for what they are now: arrays, numbers, tuples.

    Whoever replaces an array, instead of writing into it, must bind anew.

    Args:
        function: of `fo_gym.compiling`.
        arguments: the first ones; at most four are left for the calls.
    """
    table = np.array(list(_words(arguments)), dtype=np.int64)
    kinds = typeof(arguments)  # type: ignore[no-untyped-call]
    call = Bound(_entry(function, kinds), table.ctypes.data)
    call.held = *arguments, table
    return call


def _words(value: Any) -> Iterator[int]:
    """What the table says: where an array begins, its shape and its strides; of a number its bits."""
    if isinstance(value, tuple):
        for each in value:
            yield from _words(each)
    elif isinstance(value, np.ndarray):
        yield from (value.ctypes.data, *value.shape, *value.strides)
    else:
        kind = np.float64 if isinstance(value, float) else np.int64
        yield int(np.array(value, dtype=kind).view(np.int64))


@cache
def _entry(function: Any, kinds: Any) -> Any:
    """The compiled function that finds its first arguments, of these types, by a table."""
    opened = _opened(kinds)

    def none(table):  # type: ignore[no-untyped-def]
        return function(*opened(table))

    def one(table, a):  # type: ignore[no-untyped-def]
        return function(*opened(table), a)

    def two(table, a, b):  # type: ignore[no-untyped-def]
        return function(*opened(table), a, b)

    def three(table, a, b, c):  # type: ignore[no-untyped-def]
        return function(*opened(table), a, b, c)

    def four(table, a, b, c, d):  # type: ignore[no-untyped-def]
        return function(*opened(table), a, b, c, d)

    plain = function.py_func
    entry = (none, one, two, three, four)[plain.__code__.co_argcount - len(kinds)]
    stamp = hashlib.sha256(f"{plain.__module__} {function.kept_as} {kinds}".encode()).hexdigest()[:12]
    entry.__qualname__ = f"{plain.__name__}_{stamp}"
    made = kept(njit(error_model="numpy", nogil=True)(entry), "bound")
    entry.__qualname__ += f"_{content(made)}"  # it is linked by name, and may be another one in another process
    return made


def _opened(kinds: Any) -> Any:
    """What a compiled function calls to get the values of these types from the table at an address."""

    def read(context: Any, builder: Any, words: Iterator[Any], kind: Any) -> Any:
        """Code for the value of one type, made of the next words of the table."""
        parts: Any = kind
        if isinstance(kind, types.BaseTuple):
            return context.make_tuple(builder, kind, [read(context, builder, words, each) for each in parts])
        word = next(words)
        if isinstance(kind, types.Array):
            item = context.get_data_type(kind.dtype)
            array = make_array(kind)(context, builder)  # type: ignore[no-untyped-call]
            populate_array(  # type: ignore[no-untyped-call]
                array,
                data=builder.inttoptr(word, item.as_pointer()),
                shape=[next(words) for _ in range(kind.ndim)],
                strides=[next(words) for _ in range(kind.ndim)],
                itemsize=context.get_constant(types.intp, context.get_abi_sizeof(item)),
                meminfo=None,
            )
            return array._getvalue()
        if kind == types.float64:
            return builder.bitcast(word, context.get_value_type(kind))
        return context.cast(builder, word, types.int64, kind)

    @intrinsic
    def opened(_typing: Any, table: Any) -> Any:
        """The type of all values together, and what writes the code that reads them."""

        def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            integer = context.get_value_type(types.int64)
            start = builder.inttoptr(arguments[0], integer.as_pointer())
            words = (builder.load(builder.gep(start, [integer(place)])) for place in count())
            return read(context, builder, words, kinds)

        return kinds(table), generate

    return opened
