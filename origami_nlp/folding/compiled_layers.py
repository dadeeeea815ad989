"""Which creases of a vertex lie on each other and on facets, in C (`c/layers.c`); without a compiler in NumPy."""

from __future__ import annotations

import ctypes
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.numerics import address, compiled

Paths = tuple[tuple[int, ...], ...]
"""The nodes along each arc in order, its two ends included."""
Around = tuple[tuple[int, tuple[int, ...]], ...]
"""For each node those next to it, counter-clockwise seen from outside."""
Arranged = tuple[Paths, Around]
"""What lies where: all that an order of layers hangs on."""


def _source() -> str:
    """Return what is compiled."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint", "string")]
    return "\n".join([*lines, (Path(__file__).parent / "c" / "layers.c").read_text("utf-8")])


_MADE: list[Any] = []
"""The compiled functions, once they were asked for: each state asks again."""


def library() -> Any:
    """Return the compiled functions; None where nothing can be compiled."""
    if not _MADE and (made := compiled("layers", _source)) is not None:
        at = ctypes.c_void_p
        made.arrange.argtypes = [ctypes.c_int64, at, ctypes.c_double, at, at, at, at]
        made.arrange.restype = ctypes.c_int64
        _MADE.append(made)
    return _MADE[0] if _MADE else None


def arranged_in_c(creases: np.ndarray, tolerance: float) -> Arranged | None:
    """Return which creases lie on each other and on facets.

    Parameters
    ----------
    creases
        Polygon vertices, shape [N, 3].
    tolerance
        Distance below which features touch [rad].

    Returns
    -------
    Arranged or None
        Paths along arcs, and turns around nodes; None where nothing touches.
    """
    n = len(creases)
    c, angle, node = np.ascontiguousarray(creases, np.float64), np.empty(n), np.empty(n, np.int64)
    following, out = np.zeros((n, n), np.uint8), np.empty(2 * n * (n + 2), np.int64)
    work = map(address, (angle, node, following, out))
    used = library().arrange(n, address(c), tolerance, *work)
    if not used:
        return None
    said = iter(out[:used].tolist())
    paths = tuple(tuple(islice(said, next(said))) for _ in range(n))
    return paths, tuple((next(said), tuple(islice(said, count))) for count in said)
