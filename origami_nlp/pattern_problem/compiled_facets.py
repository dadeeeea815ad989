"""Where facets are and which cross, in C (`c/facets.c`), compiled by the compiler of the machine; else by NumPy."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.numerics import NONZERO, compiled


def _source() -> str:
    """Return what is compiled."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint")]
    lines.append(f"#define NONZERO {NONZERO.hex()}")
    return "\n".join([*lines, (Path(__file__).parent / "c" / "facets.c").read_text("utf-8")])


def library() -> Any:
    """Return the compiled functions; None where nothing can be compiled."""
    made = compiled("facets", _source)
    if made is not None and not made.find_crossings.argtypes:
        whole, at = ctypes.c_int64, ctypes.c_void_p
        made.find_crossings.restype = made.place.restype = None
        made.place.argtypes = [whole, *[at] * 8]
        made.find_crossings.argtypes = [*[whole] * 3, at, whole, at, at, ctypes.c_double, at, at]
    return made


def crossings_among(
    x: np.ndarray, first: np.ndarray, second: np.ndarray, deep: float
) -> np.ndarray | None:
    """Return which pairs of convex polygons pass through each other by more than a length, at several states.

    Parameters
    ----------
    x
        Corners, [S, P, q, 3], padded by repeating the first.
    first, second
        Numbers of the polygons of each pair, [K].
    deep
        The length.

    Returns
    -------
    numpy.ndarray or None
        Of bool, [S, K]; None where nothing can be compiled.
    """
    if (made := library()) is None:
        return None
    x = np.ascontiguousarray(x, np.float64)
    first, second = (np.ascontiguousarray(k, np.int64) for k in (first, second))
    seen, hit = np.empty((x.shape[1], 9)), np.empty((len(x), len(first)), np.bool_)
    at = (a.ctypes.data for a in (x, first, second, seen, hit))
    corners, one, other, work, out = at
    made.find_crossings(*x.shape[:3], corners, len(first), one, other, deep, work, out)
    return hit
