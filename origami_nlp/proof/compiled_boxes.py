"""What a proof does with boxes in C (`c/`), compiled once by the compiler of the machine; without one NumPy does it."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp import numerics
from origami_nlp.proof.affine import TINY, UNIT

LANES = 64
"""Boxes that an operation is done for at once: their numbers stay in the processor's cache."""
CODES = "LOAD STORE KEEP ADD SUB MUL NEG ABS DIV ROOT MOST AT_MOST".split()
"""Operations of straight-line programs."""
EXACT = 1e-3
"""Least squares take no row to be more accurate than this, relative to its slopes: its square is what they miss by, and
one over that their condition."""

WIDER = 1e-9
"""Share of its half width by which a contracted box is left wider than computed, for replays in other arithmetic."""
GRID = 2.0**-12
"""Width of the grid of bounds, over half a side of the box: wide beside what processors differ by, hardly a loss."""
OFF = 0.3
"""Bounds are moved by this share of it at least: those that common numbers (0, 1/2, 1) give lie between its lines."""
KEPT = 0.9
"""A contraction that leaves more than this share of every side is not carried out."""

Parts = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Lower and upper bounds of boxes [n, K], and which sides are pinned."""


def _source() -> str:
    """Return what is compiled: numbers as they are here, and the files beside."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint", "string")]
    lines += [f"#define {name} {code}" for code, name in enumerate(CODES)]
    names = "CHOSEN DEPENDENT NONZERO ROUNDED".split()
    values = {name: getattr(numerics, name) for name in names}
    values |= {"EXACT": EXACT, "TINY": TINY, "UNIT": UNIT}
    values |= {"WIDER": WIDER, "GRID": GRID, "OFF": OFF, "KEPT": KEPT}
    lines += [f"#define {name} ({float(value).hex()})" for name, value in values.items()]
    lines.append(f"#define LANES {LANES}")
    files = ("straight_line.c", "contraction.c", "halving.c")
    return "\n".join(
        [*lines, *((Path(__file__).parent / "c" / f).read_text("utf-8") for f in files)]
    )


_MADE: list[Any] = []
"""The compiled functions, once they were asked for: each batch of boxes asks again."""


def library() -> Any:
    """Return the compiled functions; None where nothing can be compiled."""
    if not _MADE and (made := numerics.compiled("proof", _source)) is not None:
        whole, at, number = ctypes.c_int64, ctypes.c_void_p, ctypes.c_double
        made.run.argtypes = [whole, *[at] * 4, whole]
        made.nonzero.argtypes = [whole, whole, whole, at, at, at, number, at]
        made.contract.argtypes = [at] * 12
        made.settle.argtypes = [whole, whole, whole, number, *[at] * 11]
        made.halve.argtypes = [whole, whole, number, at, at, at, whole, at, at, at]
        for function in (made.run, made.nonzero, made.contract, made.settle):
            function.restype = None
        made.halve.restype = whole
        _MADE.append(made)
    return _MADE[0] if _MADE else None


def _room(n: int, columns: int) -> Parts:
    return np.empty((n, columns)), np.empty((n, columns)), np.empty((n, columns), np.int8)


def _given(boxes: Parts) -> list[np.ndarray]:
    kinds = (np.float64, np.float64, np.int8)
    return [np.ascontiguousarray(v, k) for v, k in zip(boxes, kinds, strict=True)]


def halved(boxes: Parts, wanted: int, small: float) -> Parts:
    """Cut all boxes that are not narrower than `small`, at the middle of their widest sides, until there are enough.

    Parameters
    ----------
    boxes
        Bounds and pins.
    wanted
        How many are enough.
    small
        Width below which none is cut [rad].

    Returns
    -------
    Parts
        Of what there is then.
    """
    n = len(boxes[0])
    while (count := boxes[0].shape[1]) < wanted:
        given, made = _given(boxes), _room(n, 2 * count)
        at, to = ([numerics.address(v) for v in part] for part in (given, made))
        found = library().halve(n, count, small, *at, 2 * count, *to)
        if not found:
            break
        boxes = made[0][:, :found], made[1][:, :found], made[2][:, :found]
    return boxes


def settled(
    boxes: Parts, which: np.ndarray, low: np.ndarray, high: np.ndarray, small: float
) -> tuple[Parts, Parts]:
    """Contract boxes, and cut those that did not shrink to half their volume; no tree is kept.

    Parameters
    ----------
    boxes
        Bounds and pins.
    which
        Numbers of those that no row excludes, [C].
    low, high
        Bounds of xi in these, [n, C].
    small
        Width below which boxes are left as they are [rad].

    Returns
    -------
    done, again
        Those that are small, and those to be asked anew.
    """
    lower, upper, pins = _given(boxes)
    n, columns, count = *lower.shape, len(which)
    given = (np.array(which, np.int64), lower.copy(), upper.copy(), pins)
    made, counts, kind = _room(n, 2 * count), np.zeros(2, np.int64), np.empty(count, np.int8)
    bounds = (np.ascontiguousarray(low), np.ascontiguousarray(high))
    arrays = (*given, *bounds, kind, *made, counts)
    library().settle(n, columns, count, small, *map(numerics.address, arrays))
    few, every = counts.tolist()
    one, other, held = made
    done = one[:, :few], other[:, :few], held[:, :few]
    return done, (one[:, few:every], other[:, few:every], held[:, few:every])
