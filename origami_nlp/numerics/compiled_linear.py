"""Nonnegative least squares in C (`c/linear.c`), compiled by the compiler of the machine."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.numerics import tolerances
from origami_nlp.numerics.compiling import address, c_sources, compiled

MOST = 256
"""Rows or columns: LAPACK takes less time of more."""


def _source() -> str:
    """Return what is compiled."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint", "string")]
    for name in "NONZERO RANK ROUNDED".split():
        lines.append(f"#define {name} ({getattr(tolerances, name).hex()})")
    return "\n".join([*lines, c_sources(Path(__file__).parent / "c" / "linear.c")])


def _library() -> Any:
    made = compiled("linear", _source)
    if made is not None and not made.nonnegative.argtypes:
        made.nonnegative.argtypes = [*[ctypes.c_int64] * 2, *[ctypes.c_void_p] * 5]
        made.nonnegative.restype = ctypes.c_int64
    return made


def nonnegative_in_c(b: np.ndarray, c: np.ndarray) -> np.ndarray | None:
    """Minimise |B mu - c| over mu >= 0, B [t, r]; None where it is for NumPy: near dependent columns, no compiler."""
    t, r = b.shape
    if not r or max(t, r) > MOST or (library := _library()) is None:
        return None
    columns, c = np.ascontiguousarray(b.T, np.float64), np.ascontiguousarray(c, np.float64)
    mu, free = np.empty(r), np.empty(3 * r, np.int64)
    work = np.empty(2 * r * t + r * r + 2 * r + 2 * t)
    at = map(address, (columns, c, mu, free, work))
    return mu if library.nonnegative(t, r, *at) else None
