"""Steps onto closure in C (`c/closure.c`), compiled once by the compiler of the machine; without one by NumPy."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp import numerics
from origami_nlp.numerics import address, c_sources

FALLS = 0.05
"""A residual that falls by less a step asks for new factors: they cost as much as three to ten steps with old ones."""
LONGEST = 0.5
"""Steps of a projection are cut to this largest change of a fold angle [rad]."""
MOST_WORK = 4e7
"""Rows times the square of the band up to which its factors are formed in C: beyond, sparse ones take less."""
SIZES = "n m loops pairs band".split()
FLOATS = "axis point reference start moved".split()
INTS = "first crease of rows row place one other".split()
WORK = "c o q t value j l d".split()


class _LoopsInC(ctypes.Structure):
    """Loops of a pattern, and where their rows go."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in SIZES),
        ("size", ctypes.c_double),
        *((name, ctypes.c_void_p) for name in (*FLOATS, *INTS)),
    ]


class _PlaceInC(ctypes.Structure):
    """What is computed at a state."""

    _fields_ = [(name, ctypes.c_void_p) for name in (*WORK, "none")]


def source() -> str:
    """Return what is compiled: numbers as they are here, and the file beside."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint", "string")]
    names = "EPS MOST_TIMES NONZERO ROUNDED STALLS WEIGHT".split()
    values = {name: getattr(numerics, name) for name in names}
    values |= {"FALLS": FALLS, "LONGEST": LONGEST}
    lines += [f"#define {name} ({float(value).hex()})" for name, value in values.items()]
    of_loops = [("int64_t ", SIZES), ("double ", ["size"]), ("const double *", FLOATS)]
    of_place = [("double *", WORK), ("int64_t *", ["none"])]
    for struct, parts in (
        ("Loops", [*of_loops, ("const int64_t *", INTS)]),
        ("Place", of_place),
    ):
        lines += ["typedef struct {", *(f"{c}{name};" for c, names in parts for name in names)]
        lines.append(f"}} {struct};")
    return "\n".join([*lines, c_sources(Path(__file__).parent / "c" / "closure.c")])


class CompiledClosure:
    """Steps onto the closure of a pattern.

    Parameters
    ----------
    tables
        Of `Closure.tables`.
    size
        Length over which translations are.
    n
        Number of variables.
    """

    def __init__(self, tables: dict[str, np.ndarray], size: float, n: int) -> None:
        self._library: Any = None
        self._made_of = dict(tables), size, n
        of, rows, crease = tables["of"], tables["rows"], tables["crease"]
        loops, m = len(rows), int(rows.sum())
        shared = _sharing(crease)
        # loops that share creases are numbered near each other
        graph = sp.sparse.csr_array(
            (np.ones(len(shared)), (of[shared[:, 0]], of[shared[:, 1]])), shape=(loops, loops)
        )
        order = (
            sp.sparse.csgraph.reverse_cuthill_mckee(graph, symmetric_mode=True)
            if loops
            else np.zeros(0, int)
        )
        place = np.empty(loops, int)
        place[order] = np.cumsum(rows[order]) - rows[order]
        shared = shared[place[of[shared[:, 0]]] >= place[of[shared[:, 1]]]]
        low, high = place[of[shared[:, 1]]], place[of[shared[:, 0]]] + rows[of[shared[:, 0]]] - 1
        band = int((high - low).max(initial=0))
        if m * (band + 1.0) ** 2 > MOST_WORK:
            return
        self._library = library = numerics.compiled("closure", source)
        if library is None:
            return
        tables |= {"place": place, "one": shared[:, 0], "other": shared[:, 1]}
        self._kept = {name: np.ascontiguousarray(tables[name], np.float64) for name in FLOATS}
        self._kept |= {name: np.ascontiguousarray(tables[name], np.int64) for name in INTS}
        many = len(crease)
        sizes = 3 * many, 3 * many, 4 * loops, 3 * loops, m, 6 * many, m * (band + 1), n
        self._kept |= {name: np.zeros(k) for name, k in zip(WORK, sizes, strict=True)}
        self._kept["none"] = np.zeros(n, np.int64)
        at = {name: a.ctypes.data for name, a in self._kept.items()}
        self._loops = _LoopsInC(
            n, m, loops, len(shared), band, size, *map(at.get, (*FLOATS, *INTS))
        )
        self._place = _PlaceInC(*map(at.get, (*WORK, "none")))
        self._given = ctypes.addressof(self._loops), ctypes.addressof(self._place)
        self._ends = np.zeros(2)
        if not library.project.argtypes:
            pointer, whole = ctypes.c_void_p, ctypes.c_int64
            library.project.argtypes = [pointer] * 3 + [whole] + [pointer] * 3
            library.project.restype = library.bend.restype = None
            library.bend.argtypes = [pointer] * 5
            library.follow.argtypes = [pointer] * 6
            library.follow.restype = whole
            library.equations.argtypes = [pointer] * 5
            library.equations.restype = ctypes.c_double

    def __reduce__(self) -> Any:
        return CompiledClosure, self._made_of  # addresses are of one process

    @property
    def usable(self) -> bool:
        """Whether there is a compiler, and no more work than that of sparse factors."""
        return self._library is not None

    @property
    def addresses(self) -> tuple[int, int]:
        """Where the loops, and room for what is computed, stand: for C that goes on from `source`."""
        return self._given

    def _state(self, phi: np.ndarray) -> np.ndarray:
        """Return one state [n] as C reads it: of several it would read, and write, beyond the first."""
        if np.shape(phi) != (self._loops.n,):
            raise ValueError(
                f"one state has {self._loops.n} variables: its shape is {np.shape(phi)}"
            )
        return np.ascontiguousarray(phi, np.float64)

    def project(
        self, phi: np.ndarray, held: np.ndarray | None, steps: int, near: np.ndarray | None = None
    ) -> tuple[np.ndarray, float, bool]:
        """Move fold angles [n] onto closure as `PatternEquations.project` does, by factors at `near` to begin with.

        Returns
        -------
        phi : numpy.ndarray
            Where the steps ended.
        residual : float
            Largest entry of closure there.
        lifts : bool
            Whether all loops end with q0 > 0.
        """
        phi = self._state(phi).copy()
        stays = self._kept["none"] if held is None else held.astype(np.int64)
        loops, place = self._given
        begin = None if near is None else np.ascontiguousarray(near, np.float64)
        self._library.project(
            *(loops, address(phi), address(stays), steps),
            *(None if begin is None else address(begin), place, address(self._ends)),
        )
        residual, least = self._ends.tolist()
        return phi, residual, least > 0

    def equations(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
        """Evaluate closure [m] and its Jacobian [m, n] at a state [n], and whether all loops end with q0 > 0."""
        phi, m = self._state(phi), self._loops.m
        values, jacobian = np.empty(m), np.zeros((m, len(phi)))
        loops, place = self._given
        at = address(phi), place, address(values), address(jacobian)
        least = self._library.equations(loops, *at)
        return values, jacobian, least > 0

    def hessian(self, phi: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        """Evaluate the Hessian of multipliers . closure at a state [n], [n, n]; multipliers [m]."""
        phi, multipliers = self._state(phi), np.ascontiguousarray(multipliers, np.float64)
        (loops, place), h = self._given, np.zeros((len(phi), len(phi)))
        self._library.bend(loops, address(phi), place, address(multipliers), address(h))
        return h

    def follow(
        self, phi: np.ndarray, along: np.ndarray
    ) -> tuple[float, np.ndarray, np.ndarray] | None:
        """Return where a curve of closed states goes at one of them.

        Parameters
        ----------
        phi
            The state, [n].
        along
            Direction [n] on whose side it goes.

        Returns
        -------
        size : float
            Length of what closure leaves of `along`.
        tangent, bend : numpy.ndarray
            That over its length, and the curvature, [n].  None in place of all where corrections stall.
        """
        tangent, bend, size = np.array(along, np.float64), np.empty(len(phi)), ctypes.c_double()
        phi, (loops, place) = self._state(phi), self._given
        made = self._library.follow(
            loops,
            phi.ctypes.data,
            tangent.ctypes.data,
            bend.ctypes.data,
            ctypes.addressof(size),
            place,
        )
        return (size.value, tangent, bend) if made else None


def _sharing(crease: np.ndarray) -> np.ndarray:
    """Return all ordered pairs of entries that are of one crease, [P, 2]."""
    order = np.argsort(crease, kind="stable")
    first = np.searchsorted(crease[order], np.arange(crease.max(initial=-1) + 2))
    found = []
    for k in np.unique(np.diff(first)).tolist():
        rows = first[:-1][np.diff(first) == k]
        same = order[rows[:, None] + np.arange(k)]  # [creases, k]
        found.append(np.stack([np.repeat(same, k, 1), np.tile(same, k)], 2).reshape(-1, 2))
    return np.concatenate([*found, np.zeros((0, 2), int)])
