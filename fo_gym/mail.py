"""How a helper is told what to do, without Python: compiled functions over its mail, an array of int64.

One thread asks and waits, another one serves; each of them writes entries that the other one reads.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from fo_gym.compiling import jit

ASKED, DONE, FUNCTION, TABLE = range(4)
"""Entries: how often something was asked for, how often it was done, and what it is."""

ENTRIES = 4

_intrinsic: Any = intrinsic  # whose types are those of the generator

__all__ = ["ASKED", "DONE", "ENTRIES", "ask", "has_done", "serve", "tell"]


@_intrinsic
def _read(_typing: Any, mail: Any, place: Any) -> Any:
    """An entry of the mail as it is now, whatever another thread has written before it."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.load_atomic(builder.gep(array.data, [arguments[1]]), "acquire", 8)

    return types.int64(mail, types.int64), generate


@_intrinsic
def _write(_typing: Any, mail: Any, place: Any, value: Any) -> Any:
    """Write an entry of the mail, after all that was written before."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        builder.store_atomic(arguments[2], builder.gep(array.data, [arguments[1]]), "release", 8)
        return context.get_dummy_value()

    return types.void(mail, types.int64, types.int64), generate


@_intrinsic
def _call(_typing: Any, function: Any, table: Any) -> Any:
    """Call the function at an address with a table's."""

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(ir.VoidType(), [ir.IntType(64)])
        builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), [arguments[1]])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64), generate


@jit
def ask(mail, function, table):
    """Ask for a call of the function at an address with a table's, see `Bound.address`; 0 stands for something else."""
    mail[FUNCTION], mail[TABLE] = function, table
    _write(mail, ASKED, mail[ASKED] + 1)


@jit
def tell(mail):
    """What was asked for is done."""
    _write(mail, DONE, mail[DONE] + 1)


@jit
def serve(mail, looks, pause):
    """Do what is asked for; returns whether that is nothing compiled, or else when nothing comes for so many looks."""
    left = looks
    while left > 0:
        left -= 1
        if _read(mail, ASKED) > mail[DONE]:
            if mail[FUNCTION] == 0:
                for _ in range(pause):
                    _read(mail, ASKED)
                return True
            _call(mail[FUNCTION], mail[TABLE])
            _write(mail, DONE, mail[DONE] + 1)
            left = looks
    return False


@jit
def has_done(mail, looks):
    """Whether all that was asked for is done before it has been looked so often."""
    while looks > 0 and _read(mail, DONE) < mail[ASKED]:
        looks -= 1
    return looks > 0
