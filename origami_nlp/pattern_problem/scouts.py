"""Where descents would end, roughly, in C (`c/scout.c`): nothing is decided by it, and without a compiler nothing said.

A barrier keeps facets apart, and fold angles within their limits, at a distance that falls in `SHARES`; what is left of
it at the end is the same each time, so that two ends are compared, not an end with a minimum: ends of one minimum agree
to some 1e-6 rad, and are some 1e-4 rad from it, further where springs are soft.
"""

from __future__ import annotations

import ctypes
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp import numerics
from origami_nlp.numerics import CLOSURE_TOL, address, compiled
from origami_nlp.pattern_problem import compiled_closure, compiled_facets

if TYPE_CHECKING:
    from origami_nlp.pattern_problem.problem import PatternProblem

MOST_CREASES, MOST_PAIRS = 64, 2_000
"""Creases, and pairs of pieces that may touch, up to which scouts are made."""
SHARES = 0.1, 0.003, 0.0001
"""Reach of barriers, stage by stage: [rad], and of the mean side of facets."""
STRENGTH = 0.1
"""Of barriers, over their reach: a unit torque is held at about this share of it."""
GRID = 2.0**-33
"""Of fold angles that a scout begins at, before it closes them [rad]: less than what counts as touching."""
AT_LIMIT = 1e-6
"""Nearer to a fold limit a crease is held there [rad]."""
PULLS = 1e-6
"""Torque over the mean stiffness from which on it opens a crease that is at a limit."""
INWARD = 0.02
"""Distance from a fold limit that nothing holds it to at which a descent goes on [rad]."""
MOST_STEPS = 120
"""Of a descent."""
ROOM = 4_000
"""Features that are near each other at most."""
NAMES = {
    "DIFFERENCE": 1e-6,
    "MOST_CORRECTIONS": 12,
    "MOST_CREASES": MOST_CREASES,
    "MOST_HALVINGS": 20,
    "MOST_SWEEPS": 12,
    "NEARLY": 0.9,
    "PARALLEL": 1e-12,
    "ROUGH": 1e-2,
    "SOFTEST": 1e-6,
    "STILL": 1e-10,
    "TOUCHES": 1e-9,
    "TRUST": 0.3,
}
"""Numbers of the source: steps of differences over the reach, decrements where stages end, largest step [rad], ..."""
WHOLE = "root steps many pairs room room_of_pair q facets".split()
REAL = "length strength size".split()
FLOATS = "axis point reference normals stiffness rest load low high shape radii middles".split()
WORK = "angle turns shifts x normal middle seen vector matrix wrench".split()
INTS = "here before crossed pieces corners facet one other stays".split()
PARTS = {
    "const Loops *": ["loops"],
    "Place *": ["place"],
    "const double *": FLOATS,
    "double *": WORK,
    "const int64_t *": INTS,
    "int64_t *": ["order", "begins"],
    "unsigned char *": ["hit", "touch"],
    "void *": ["near"],
}


class _ScoutInC(ctypes.Structure):
    """A pattern, and room for what is computed."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in WHOLE),
        *((name, ctypes.c_double) for name in REAL),
        *((name, ctypes.c_void_p) for names in PARTS.values() for name in names),
    ]


def _source() -> str:
    """Return what is compiled: sources of facets and of closure, whose names must not meet, and the file beside."""
    own = ("cross", "dot", "INSIDE", "NONZERO", "OUTSIDE")
    lines = ["#define cross cross_of_facets", "#define dot dot_of_facets", compiled_facets.source()]
    lines += [*(f"#undef {name}" for name in own), compiled_closure.source()]
    values = NAMES | {
        name: getattr(numerics, name) for name in "CLOSURE_TOL DECREASE DEEP RANK".split()
    }
    lines += [f"#define {name} ({value!r})" for name, value in values.items()]
    fields = [("int64_t ", WHOLE), ("double ", REAL), *PARTS.items()]
    lines += ["typedef struct {", *(f"{c}{name};" for c, names in fields for name in names)]
    lines += ["} Scout;", "typedef struct { double *turn, *shift, *x, *normal, *middle; } Placed;"]
    return "\n".join([*lines, (Path(__file__).parent / "c" / "scout.c").read_text("utf-8")])


class Scouts:
    """Descents of a pattern's energy that stop short of its minima, some thirty times as fast as those that do not.

    Parameters
    ----------
    problem
        The problem.
    """

    def __init__(self, problem: PatternProblem) -> None:
        self._problem = problem
        self._library: Any = None
        p, crossings = problem.pattern, problem.crossings
        known = not (p.cell or p.laws or problem.parameters.dead is not None)
        if not known or problem.size > MOST_CREASES or len(crossings.listed) > MOST_PAIRS:
            return
        if not problem.closure.compiled.usable or not len(crossings.listed):
            return
        self._library = compiled("scout", _source)

    @property
    def usable(self) -> bool:
        """Whether there is a compiler, and the pattern is one of springs, and small."""
        return self._library is not None

    @cached_property
    def _tables(self) -> dict[str, np.ndarray]:
        """The pattern as arrays, and empty ones."""
        problem, n = self._problem, self._problem.size
        c, f, m = problem.crossings, problem.pattern.facets, problem.closure.count
        shape = c.pattern.corners[c.pieces] / c.size
        middles = shape.mean(axis=1)
        area = numerics.area_vectors(shape)
        p, q = shape.shape[:2]
        here, before, crossed, axis, point = c.poses.walks
        par, limits = problem.parameters, problem.fold_limits
        floats = {
            **{"axis": axis, "point": point, "reference": problem.pattern.reference},
            **{"stiffness": par.stiffness, "rest": par.rest},
            **{"normals": area / np.linalg.norm(area, axis=1, keepdims=True), "load": par.load},
            **{"low": limits.low, "high": limits.high, "shape": shape, "middles": middles},
            "radii": np.linalg.norm(shape - middles[:, None], axis=2).max(axis=1),
        }
        vector, matrix = 11 * n + m, (m + n) * n + 4 * n * n
        sizes = n, 18 * f, 6 * f, 6 * q * p, 6 * p, 6 * p, 9 * p, vector, matrix, 6 * f
        floats |= {name: np.zeros(size) for name, size in zip(WORK, sizes, strict=True)}
        ints = {
            **{"here": here, "before": before, "crossed": crossed, "pieces": c.pieces},
            **{"corners": [len(set(piece)) for piece in c.pieces.tolist()], "facet": c.facet},
            **{"one": c.listed[:, 0], "other": c.listed[:, 1], "stays": np.zeros(n)},
            "order": np.zeros(m + n),
            "begins": np.zeros(1),
        }
        made = {name: np.array(x, np.float64, order="C") for name, x in floats.items()}
        made |= {name: np.array(x, np.int64, order="C") for name, x in ints.items()}
        touch = np.zeros((len(c.listed), q * (q + 2)), np.uint8)
        return made | {
            "touch": touch,
            "hit": np.zeros(len(c.listed), np.uint8),
            "near": np.zeros((2 * ROOM, 10)),
        }

    @cached_property
    def _given(self) -> _ScoutInC:
        c, made = self._problem.crossings, self._tables
        q = made["shape"].shape[1]
        side = np.linalg.norm(made["shape"] - np.roll(made["shape"], -1, axis=1), axis=2)
        loops, place = self._problem.closure.compiled.addresses
        at = {"loops": loops, "place": place} | {k: x.ctypes.data for k, x in made.items()}
        whole = c.poses.root, len(made["here"]), len(c.pieces), len(c.listed), ROOM, q * (q + 2), q
        real = float(side[side > 0].mean()), STRENGTH, c.size
        names = (name for names in PARTS.values() for name in names)
        return _ScoutInC(*whole, c.pattern.facets, *real, *map(at.__getitem__, names))

    def descend(
        self, phi: np.ndarray, apart: bool, most: int = 6
    ) -> tuple[np.ndarray, np.ndarray, bool] | None:
        """Go downhill from a closed state, with facets kept `apart` or not.

        Parameters
        ----------
        phi
            Fold angles, [n] [rad]; of facets that are kept apart none may cross.
        apart
            Whether they are.

        Returns
        -------
        end : numpy.ndarray
            A closed state near the stationary one below.
        last : numpy.ndarray
            The last state on the way before facets cross.
        crosses : bool
            Whether they do somewhere.  None in place of all where it came to no end.
        """
        problem = self._problem
        problem.check_time()
        given, limits, made = self._given, problem.fold_limits, self._tables
        held = limits.room(phi) <= AT_LIMIT
        made["stays"][:] = held
        # starts that rounding has moved are one start, but for those beside a border of the grid
        side = np.where(limits.high - phi <= AT_LIMIT, 1.0, -1.0)
        end = limits.hold(limits.clip(np.round(phi / GRID) * GRID), held * side)
        shares = np.array(SHARES)
        last, pulls, ends = np.empty(len(end)), np.empty(len(end)), np.zeros(4)
        call = self._library.scout
        if not call.argtypes:
            whole, at = ctypes.c_int64, ctypes.c_void_p
            call.restype, call.argtypes = None, [at, at, whole, whole, *[at, whole], *[at] * 3]
        call(
            *(ctypes.addressof(given), address(end), int(apart), len(shares), address(shares)),
            *(MOST_STEPS, address(last), address(pulls), address(ends)),
        )
        if ends[0]:
            return None
        opens = held & (side * pulls > PULLS)
        if apart or not opens.any():
            return end, last, bool(ends[3])
        # it goes on off the limits to which nothing holds it
        off, residual = problem.project(np.where(opens, phi - side * INWARD, end), held)
        good = residual <= CLOSURE_TOL and problem.closure.lifts_to_one(off)
        if not (most and good and limits.inside(off).all()):
            return None
        more = self.descend(off, False, most - 1)
        return (more[0], last, True) if more is not None and ends[3] else more
