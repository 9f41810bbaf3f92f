"""The variables by which libraries are told to compute as another processor would, apart from what reads them."""

from __future__ import annotations

READ_BY_C = ("OPENBLAS_CORETYPE", "GLIBC_TUNABLES")
"""Of OpenBLAS, and of the C library with its exp, sin and so on."""

VARIABLES = (
    *("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NPY_DISABLE_CPU_FEATURES", "NPY_ENABLE_CPU_FEATURES"),
    *READ_BY_C,
)
"""All of them."""

__all__ = ["READ_BY_C", "VARIABLES"]
