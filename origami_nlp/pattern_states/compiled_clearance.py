"""Which facets might touch inside steps of a curve, in C (`c/clearance.c`); without a compiler NumPy says it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, CURVED, DEEP, NONZERO, compiled

TILTS = 0.0, 0.1, 0.3, 1.0
"""By which planes of sectors are turned, in search of one between two sectors: tangents."""
SIZES = "q n facets".split()
FLOATS = "corners middles radii rays_still rays_moving arm".split()
INTS = "facet still moving apex first crease".split()


class _PairsInC(ctypes.Structure):
    """Pieces of facets, and pairs of them."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in SIZES),
        ("size", ctypes.c_double),
        *((name, ctypes.c_void_p) for name in (*FLOATS, *INTS)),
    ]


def _source() -> str:
    """Return what is compiled."""
    values = {"CLOSURE_TOL": CLOSURE_TOL, "CURVED": CURVED, "DEEP": DEEP, "NONZERO": NONZERO}
    lines = [f"#include <{name}.h>" for name in ("math", "stdint")]
    lines += [f"#define {name} {value.hex()}" for name, value in values.items()]
    lines.append(f"static const double TILTS[] = {{{', '.join(t.hex() for t in TILTS)}}};")
    fields = [("int64_t ", SIZES), ("double ", ["size"]), ("const double *", FLOATS)]
    fields.append(("const int64_t *", INTS))
    lines += ["typedef struct {", *(f"{c}{name};" for c, names in fields for name in names)]
    source = (Path(__file__).parent / "c" / "clearance.c").read_text("utf-8")
    return "\n".join([*lines, "} Sheet;", source])


class CompiledClearance:
    """What `Clearance.touching` says, in C.

    Parameters
    ----------
    tables
        Of `Clearance.tables`, made where there is a compiler.
    sizes
        Of creases and of facets.
    size
        Of the sheet.
    """

    def __init__(
        self, tables: Callable[[], dict[str, np.ndarray]], sizes: tuple[int, int], size: float
    ) -> None:
        self.library: Any = compiled("clearance", _source)
        if self.library is None:
            return
        made = tables()
        self._kept = {name: np.ascontiguousarray(made[name], np.float64) for name in FLOATS}
        self._kept |= {name: np.ascontiguousarray(made[name], np.int64) for name in INTS}
        q = made["corners"].shape[1]
        at = {name: a.ctypes.data for name, a in self._kept.items()}
        self._sheet = _PairsInC(q, *sizes, size, *map(at.get, (*FLOATS, *INTS)))
        self._work = np.empty(3 * (3 * q + 2 + 2 * q + 2 * q * q))
        if not self.library.find_touching.argtypes:
            whole, address = ctypes.c_int64, ctypes.c_void_p
            self.library.find_touching.restype = None
            self.library.find_touching.argtypes = [
                *(address, whole, *[address] * 4),
                *(whole, *[address] * 3),
            ]

    def touching(
        self,
        before: tuple[np.ndarray, np.ndarray],
        after: tuple[np.ndarray, np.ndarray],
        speed: np.ndarray,
        bend: np.ndarray,
        pairs: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `Clearance.touching`, with bounds of the first and second derivatives of the steps, [T, n]."""
        turn, shift = (np.array([a, b], np.float64) for a, b in zip(before, after, strict=True))
        given = [np.ascontiguousarray(x, np.float64) for x in (speed, bend)]
        asked = np.ascontiguousarray(pairs, np.int64)
        out = np.empty((len(speed), len(pairs)), np.uint8)
        at = (x.ctypes.data for x in (turn, shift, *given))
        self.library.find_touching(
            *(ctypes.addressof(self._sheet), len(speed), *at, len(pairs), asked.ctypes.data),
            *(self._work.ctypes.data, out.ctypes.data),
        )
        step, k = np.nonzero(out)
        return step, pairs[k], out[step, k] == 2
