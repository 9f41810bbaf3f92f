"""Run a command as another processor would compute: `python docs/processors/elsewhere.py SET COMMAND...`.

A processor can only do less than it is able to, so that the sets are of older ones. Each changes the variables by which
the libraries choose their code: Numba, NumPy, OpenBLAS and the C library (exp, sin, tanh). The first three are there on
every architecture, the cores of OpenBLAS and the sets other than "native" and "generic" on x86-64 alone.
"""

from __future__ import annotations

import os
import platform
import sys
from typing import Any

import numpy as np

X86 = platform.machine() in ("x86_64", "AMD64")


def disabled(keep: tuple[str, ...] = ()) -> str:
    """The instruction sets beyond its baseline that NumPy uses here, but for those to `keep`, in its own names."""
    told: Any = np.show_config(mode="dicts")
    return " ".join(name for name in told["SIMD Extensions"].get("found", ()) if name not in keep)


def instruction_sets() -> dict[str, dict[str, str]]:
    """The variables of each set; "native" is the processor as it is."""
    generic = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NPY_DISABLE_CPU_FEATURES": disabled()}
    if not X86:
        return {"native": {}, "generic": generic}
    # What an x86-64 of 2004 can do, but for NumPy's baseline (SSE 4.2, 2008).
    generic |= {"OPENBLAS_CORETYPE": "Prescott", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"}
    haswell = {  # AVX2 and FMA, no AVX-512
        "NUMBA_CPU_NAME": "haswell",
        "NUMBA_CPU_FEATURES": "",
        "NPY_DISABLE_CPU_FEATURES": disabled(keep=("X86_V3",)),
        "OPENBLAS_CORETYPE": "Haswell",
    }
    return {"native": {}, "generic": generic, "haswell": haswell, "blas": {"OPENBLAS_CORETYPE": "Nehalem"}}


def environment(name: str) -> dict[str, str]:
    """The environment of a command that computes as this set does. Raises ValueError for an unknown one."""
    sets = instruction_sets()
    if name not in sets:
        raise ValueError(f"unknown instruction set {name!r}; here are {', '.join(sets)}")
    return os.environ | sets[name]


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    chosen, program, *arguments = sys.argv[1:]
    os.execvpe(program, [program, *arguments], environment(chosen))
