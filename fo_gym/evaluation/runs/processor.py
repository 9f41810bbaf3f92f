"""What kind of machine computes: everything about it that decides the last bits of a result."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np

from fo_gym.evaluation.competitors.content import digest
from fo_gym.instructions import READ_BY_C

_HASH_LENGTH = 8

__all__ = ["processor", "processor_features"]


@lru_cache(maxsize=1)
def processor_features() -> Mapping[str, str]:
    """What decides the last bits here, apart from the versions of the packages.

    The processor and what it can do; what Numba compiles for (NUMBA_CPU_NAME and NUMBA_CPU_FEATURES change it); the
    instruction sets that NumPy uses beyond its baseline (NPY_DISABLE_CPU_FEATURES); the C library; and the variables
    that choose the code of OpenBLAS and of the C library, both of which follow the processor otherwise.
    """
    cpu, able = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    chosen: Any = numba.config
    # With "generic" Numba itself takes no features; a None stands for the processor's own.
    compiled_with = able if chosen.CPU_FEATURES is None else chosen.CPU_FEATURES
    return MappingProxyType(
        {
            "architecture": platform.machine(),
            "cpu": cpu,
            "cpu_features": _enabled(able),
            "numba_cpu": chosen.CPU_NAME or cpu,
            "numba_features": _enabled(compiled_with),
            "numpy_features": " ".join(_numpy_features()),
            "libc": " ".join(platform.libc_ver()),
            **{name: os.environ.get(name, "") for name in READ_BY_C},
        }
    )


def _enabled(features: str) -> str:
    """The features that are there, of LLVM's list "+avx,-avx2,...", in the order of the alphabet."""
    return " ".join(sorted(each[1:] for each in features.split(",") if each.startswith("+")))


def _numpy_features() -> list[str]:
    """The instruction sets beyond its baseline that NumPy found here and uses."""
    told: Any = np.show_config(mode="dicts")
    return list(told["SIMD Extensions"].get("found", ()))


@lru_cache(maxsize=1)
def processor() -> str:
    """Name of this kind of machine: architecture, what Numba compiles for, and a hash of `processor_features`."""
    features = processor_features()
    return f"{features['architecture']} {features['numba_cpu']} {digest(dict(features))[:_HASH_LENGTH]}"
