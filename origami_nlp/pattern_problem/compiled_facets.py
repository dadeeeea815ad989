"""Where facets are and which cross, in C (`c/facets.c`), compiled by the compiler of the machine; else by NumPy."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.numerics import INSIDE, NONZERO, OUTSIDE, address, compiled

RINGS = "after before valid border".split()
PLANES = "x side normal inward".split()
FEW = 64
"""Pairs of features for which there is room at first."""


def source() -> str:
    """Return what is compiled."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint")]
    for name, value in {"INSIDE": INSIDE, "NONZERO": NONZERO, "OUTSIDE": OUTSIDE}.items():
        lines.append(f"#define {name} {value.hex()}")
    return "\n".join([*lines, (Path(__file__).parent / "c" / "facets.c").read_text("utf-8")])


def library() -> Any:
    """Return the compiled functions; None where nothing can be compiled."""
    made = compiled("facets", source)
    if made is not None and not made.find_crossings.argtypes:
        whole, at = ctypes.c_int64, ctypes.c_void_p
        made.find_crossings.restype = made.place.restype = made.face.restype = None
        made.face.argtypes = [at, whole, whole, at, at, *[ctypes.c_double] * 2, *[at] * 3]
        made.place.argtypes = [whole, *[at] * 8]
        made.gaps.restype = whole
        made.gaps.argtypes = [whole, at, whole, *[at] * 10, ctypes.c_double, *[at] * 3]
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
    corners, one, other, work, out = map(address, (x, first, second, seen, hit))
    made.find_crossings(*x.shape[:3], corners, len(first), one, other, deep, work, out)
    return hit


class _PiecesInC(ctypes.Structure):
    """Convex pieces at a state."""

    _fields_ = [
        ("q", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in (*RINGS, *PLANES)),
    ]


class FacingInC:
    """Features of convex pieces that face each other.

    Parameters
    ----------
    rings
        With what `RINGS` names, [P, q].
    """

    def __init__(self, rings: Any) -> None:
        self._kept = [np.array(getattr(rings, name), np.int64) for name in RINGS]

    def __call__(
        self, planes: Any, pairs: np.ndarray, common: np.ndarray | None, reach: float, size: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return features of the pairs [K, 2]: of which [F], places [F, 2]; sign, gap and how far inside, [F, 3].

        Parameters
        ----------
        planes
            With what `PLANES` names.
        common
            Of corners over pieces: the places of the corner that they share as one number, or -1.  None: of sides.
        """
        q, pairs = self._kept[0].shape[1], np.ascontiguousarray(pairs, np.int64)
        shared = np.zeros(0, np.int64) if common is None else common.astype(np.int64)
        given = [np.ascontiguousarray(getattr(planes, name), np.float64) for name in PLANES]
        at = _PiecesInC(q, *map(address, (*self._kept, *given)))
        room = len(pairs) * q * (q if common is None else 1)
        many, place, found = (
            np.empty(len(pairs), np.int64),
            np.empty((room, 2), int),
            np.empty((room, 3)),
        )
        sides, of = int(common is None), map(address, (many, place, found))
        both = address(pairs), address(shared)
        library().face(ctypes.addressof(at), sides, len(pairs), *both, reach, size, *of)
        which = np.repeat(np.arange(len(pairs)), many)
        return which, place[: len(which)], found[: len(which)]


class GapsInC:
    """Gaps of pairs of features, with their derivatives by every fold angle, in C.

    Parameters
    ----------
    creases
        Of the pattern: facets that hold creases [n], their directions and points on them, [n, 3].
    """

    def __init__(self, creases: tuple[np.ndarray, np.ndarray, np.ndarray]) -> None:
        n = len(creases[0])
        self._axes, self.numbers = np.empty((n, 6)), dict[Any, int]()
        shapes = (("f8", (4, 3)), ("i8", (4,)), ("i8", ()), ("f8", ()), ("f8", (n,)))
        # of each pair: points in the reference state, facets that carry them, whether two sides, sign, creases crossed
        self._tables = [np.empty((FEW, *shape), kind) for kind, shape in shapes]
        kinds = zip(creases, ("i8", "f8", "f8"), strict=True)
        self._creases = [np.ascontiguousarray(x, kind) for x, kind in kinds]
        self._find()

    def _find(self) -> None:
        self._at = [*map(address, self._tables)], [*map(address, (*self._creases, self._axes))]

    def add(self, pair: Any, points: np.ndarray, senses: np.ndarray) -> int:
        """Note a pair with its points in the reference state [4, 3] and the creases between [n]; return its number."""
        k = self.numbers[pair] = len(self.numbers)
        if k == len(self._tables[0]):
            self._tables = [np.concatenate([table, table]) for table in self._tables]
            self._find()
        values = points, pair.owners, pair.type == "edge-edge", pair.sign, senses
        for table, value in zip(self._tables, values, strict=True):
            table[k] = value
        return k

    def __call__(
        self, which: Sequence[int], turn: np.ndarray, shift: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Return gaps [K] and rows [K, n] of pairs by number where facets have moved; None where sides run along."""
        numbers, n = np.array(which, np.int64), len(self._axes)
        gap, rows = np.empty(len(numbers)), np.empty((len(numbers), n))
        tables, (*creases, axes) = self._at
        at = (*tables, address(turn), address(shift), *creases)
        work = axes, address(gap), address(rows)
        made = library().gaps(len(numbers), address(numbers), n, *at, INSIDE, *work)
        return (gap, rows) if made else None
