"""Descents with an active set in C (`c/descend.c`): from a start with what it holds to a stationary state, with rows.

Nothing is decided by them: where they end is judged by `kkt.classify`.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp import numerics, problem as stated
from origami_nlp.numerics import address, compiled
from origami_nlp.pattern_problem import (
    MOST_DENSE_ROWS,
    ContactPair,
    PatternProblem,
    compiled_closure,
    compiled_facets,
)

SLOTS = 64
"""Gaps that a descent holds at most."""
PICKS = 8
"""Pairs of features that a start brings together at most."""
FURTHEST = 2.0
"""Features that are brought together face each other closer, over the longest crease."""
SOFT = 0.01
"""Of the mean stiffness: the metric takes no crease for softer."""
MOST_STEPS = 200
"""Of a descent."""
STAYS = 2
"""In place of the side of a limit."""
LONGEST = 0.5
"""Step of a descent [rad]."""
NAMES = {
    "APART": 1e-7,  # a slot that is open by more is dropped, over the sheet's size
    "BISECTIONS": 9,
    "EXACT": 1e-10,
    "FACES": 0.5,  # features that face each other closer, over the sheet's size
    "FOLDING": 8,  # steps in which creases are folded
    "FAR_APART": 0.02,  # a slot that orders layers is dropped
    "LONGEST_STEP": LONGEST,  # [rad]
    "TURN": 2 * math.pi,
    "LEFT": 1e-3,  # of a square: beyond, rounding is near TIE
    "MOST_CLOSING": 40,
    "MOST_CORRECTIONS": 16,
    "MOST_HALVINGS": 24,
    "MOST_IDLE": 90,  # steps that lower no energy
    "MOST_LAST": 80,
    "MOST_RETRACTIONS": 8,
    "MOST_SWEEPS": 30,
    "OFF_SADDLE": 0.05,
    "SHUT": 1e-11,  # over the sheet's size
    "SOFTEST": 1e-12,
    "STILL": 1e-10,
    "TIE": 1e-9,
    "TOUCHES": 1e-9,
}
"""Numbers of the source."""
NUMERICS = "BALANCED CLOSURE_TOL DECREASE INSIDE OUTSIDE RANK SETTLED".split()
WHOLE = "n m placed facets root steps pieces q pairs laws".split()
REAL = "size deep reach".split()
FLOATS = (
    "stiffness rest load low high measure sense_of reference axis from direction end walk corner "
    "law_weight law_shift law_piece law_grid"
)
WORK = "angle screw rows seen along normal inward soft".split()
INTS = (
    "here before crossed variable left chain_first chain facet ring after ring_before valid border triangle "
    "one other common law law_at law_cell"
)
PARTS = {
    "Outside ": ["outside"],
    "const Loops *": ["loops"],
    "Place *": ["place"],
    "const double *": FLOATS.split(),
    "double *": WORK,
    "const int64_t *": INTS.split(),
}
_OUTSIDE = ctypes.CFUNCTYPE(
    ctypes.c_double,
    ctypes.POINTER(ctypes.c_double),
    ctypes.c_int64,
    ctypes.POINTER(ctypes.c_double),
)
"""Energy of a state, and what is asked for besides: its torque, or its Hessian."""
CLOSES_NOT = "the start does not close, or its facets cross"
LEVEL = "facets come to lie on each other"
NO_LOWER = "no lower state within reach"
REASONS = (
    "arrived",
    NO_LOWER,
    "too many steps",
    "facets meet where no single gap keeps them apart",
    CLOSES_NOT,
    LEVEL,
)
"""How a descent ends."""


def compile_descents(note: Callable[[str], object] = lambda line: None) -> bool:
    """Compile descents if they are not yet, which `note` is told before; whether there is a compiler."""
    line = "descents are compiled, once on this machine (a second)"
    return compiled("descend", _source, lambda: note(line)) is not None


class _SheetInC(ctypes.Structure):
    """A pattern, and room for what is computed."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in WHOLE),
        *((name, ctypes.c_double) for name in REAL),
        *((name, ctypes.c_void_p) for names in PARTS.values() for name in names),
    ]


def _source() -> str:
    """Return what is compiled: sources of facets and of closure, whose names must not meet, and those beside."""
    own = ("cross", "dot", "INSIDE", "NONZERO", "OUTSIDE")
    lines = ["#define cross cross_of_facets", "#define dot dot_of_facets", compiled_facets.source()]
    lines += [*(f"#undef {name}" for name in own), compiled_closure.source()]
    values = {
        **NAMES,
        "SLOTS": SLOTS,
        "PICKS": PICKS,
        **{name: getattr(numerics, name) for name in NUMERICS},
    }
    lines += [f"#define {name} ({value!r})" for name, value in values.items()]
    fields = [("int64_t ", WHOLE), ("double ", REAL), *PARTS.items()]
    lines.append("typedef double (*Outside)(const double *x, int64_t order, double *out);")
    lines += ["typedef struct {", *(f"{c}{name};" for c, names in fields for name in names)]
    lines += ["} Sheet;", "#define Lawed Sheet", "#define factorise factorise_columns"]
    linear = Path(numerics.__file__).parent / "c" / "linear.c"
    here, laws = Path(__file__).parent / "c", Path(stated.__file__).parent / "c" / "laws.h"
    files = (
        linear,
        laws,
        here / "orthogonal.h",
        here / "rows.h",
        here / "descend.c",
        here / "starts.c",
    )
    return "\n".join([*lines, *(path.read_text("utf-8") for path in files)])


@dataclass(frozen=True)
class Slot:
    """A gap that a start holds: of corner `place[0]` of a piece over another, or of two sides.

    Attributes
    ----------
    pieces
        Of the feature that moves, and the other; -1 where `points` say what it is.
    places
        Corner and -1, or the sides.
    sign
        +1 or -1, so that the gap is positive where facets are apart.
    facets
        The one that stays, and the one that is carried.
    sides
        Whether of two sides.
    points
        Four points in the reference state, [4, 3], of a gap by points.
    orders
        Whether it keeps the order of layers: it is watched further out.
    """

    pieces: tuple[int, int]
    places: tuple[int, int]
    sign: float
    facets: tuple[int, int] = (0, 0)
    sides: bool = False
    points: np.ndarray | None = None
    orders: bool = False

    @classmethod
    def of(cls, touch: ContactPair, corners: np.ndarray, orders: bool = False) -> Slot:
        """Return the gap of two features, of a pattern with corners [V, 3], by its points."""
        sides, points = touch.type == "edge-edge", touch.reference(corners)
        return cls((-1, -1), (-1, -1), touch.sign, touch.facets, sides, points, orders)


@dataclass(frozen=True, eq=False)
class StartState:
    """Where a way down begins.

    Attributes
    ----------
    x, side
        A state [n], and the fold limits that it holds, by sign [n]; `STAYS` of what stays where it is while one of
        no steps is closed.
    slots
        Gaps that it holds.
    hold
        Whether what it holds stays until all is stationary.
    drawn
        Whether it is at random: it is to be closed, with what it holds, and stays so until all is stationary.
    picks
        Of one that is drawn, which features are brought together: of those that face each other the first, second, ...
    most
        Steps at most.
    """

    x: np.ndarray
    side: np.ndarray
    slots: tuple[Slot, ...] = ()
    hold: bool = False
    drawn: bool = False
    picks: tuple[int, ...] = ()
    most: int = MOST_STEPS


@dataclass(frozen=True)
class DescentEnd:
    """Where a descent ended.

    Attributes
    ----------
    x, begun
        State, and the closed one that it began at, [n].
    arrived
        Whether it is stationary on what it holds.
    why
        One of `REASONS`.
    steps, work
        Steps, and evaluations of closure.
    side
        Which fold limits are held, by sign, [n].
    slots
        Gaps that are shut.
    forces
        Multipliers of limits [n], and of slots.
    held
        Whether what it began with was to be held until all was stationary.
    """

    x: np.ndarray
    begun: np.ndarray
    arrived: bool
    why: str
    steps: int
    work: int
    side: np.ndarray
    slots: tuple[Slot, ...]
    forces: np.ndarray
    held: bool


class CompiledDescent:
    """Descents of a problem, compiled.

    Parameters
    ----------
    problem
        Of a vertex or a sheet.
    measure
        By which changes of variables are measured, [n]; None: that of the springs.
    """

    def __init__(self, problem: PatternProblem, measure: np.ndarray | None = None) -> None:
        self.problem, self._measure = problem, measure
        self._failed: BaseException | None = None
        self._library: Any = (
            compiled("descend", _source) if problem.closure.compiled.usable else None
        )
        if self._library is not None and not self._library.descend.argtypes:
            whole, at = ctypes.c_int64, ctypes.c_void_p
            call = self._library.descend
            call.restype = None
            call.argtypes = [at, whole, *[at] * 5, whole, ctypes.c_double, *[at] * 13]

    @cached_property
    def is_large(self) -> bool:
        """Whether dense arrays, or a basis of all directions in which it moves, would take too long."""
        return self.problem.sparse or self.problem.dof > MOST_DENSE_ROWS

    @property
    def usable(self) -> bool:
        """Whether there is a compiler, and the problem is small enough."""
        return self._library is not None and not self.is_large

    @cached_property
    def _outside(self) -> Any:
        """Energy with forces in space, asked for by the compiled function."""
        problem, n = self.problem, self.problem.size
        none = np.zeros(problem.closure.count)

        def evaluate(x: Any, order: int, out: Any) -> float:
            at = np.ctypeslib.as_array(x, (n,)).copy()
            try:
                if order == 0:
                    return problem.scaled_energy(at)
                what = problem.torque(at) if order == 1 else problem.hessian(at, none)
                np.ctypeslib.as_array(out, (n**order,))[:] = np.asarray(what).ravel()
            except BaseException as failed:  # C cannot raise it: it is raised where C returns
                self._failed = failed
            return 0.0

        return _OUTSIDE(evaluate)

    @cached_property
    def _kept(self) -> dict[str, np.ndarray]:
        """The pattern as arrays, and room."""
        problem, n = self.problem, self.problem.size
        c, par, limits = problem.crossings, problem.parameters, problem.fold_limits
        poses, pattern, rings = c.poses, c.pattern, problem.features.rings_of_pieces
        placed = pattern.creases
        here, before, crossed, axis, point = poses.walks
        every = np.arange(placed)
        walk, chain = (
            np.zeros((pattern.facets, placed)),
            [list[int]() for _ in range(pattern.facets)],
        )
        sense = np.sign(np.einsum("ki,ki->k", axis, pattern.directions[crossed]))
        for k, (to, of) in enumerate(zip(here.tolist(), before.tolist(), strict=True)):
            walk[to] = walk[of]
            walk[to, crossed[k]] += sense[k]
            chain[to] = [*chain[of], int(crossed[k])]
        pairs = c.listed if problem.contact else c.listed[:0]
        many, first = problem.features.shared
        shared = many[*pairs.T]
        common = np.stack([first[*pairs.T], first[pairs[:, 1], pairs[:, 0]]], axis=1)
        common = np.where(shared[:, None] == 0, -1, np.where(shared[:, None] == 1, common, -2))
        measure = self._measure
        if measure is None:
            measure = np.sqrt(np.maximum(par.stiffness, SOFT * par.stiffness.mean()))
        p, q = c.pieces.shape
        floats = {
            "stiffness": par.linear, "rest": par.rest, "load": par.load,
            "low": limits.low, "high": limits.high, "measure": measure,
            "sense_of": poses.signs(every.tolist()), "reference": pattern.reference,
            "axis": axis, "from": point, "direction": pattern.directions,
            "end": pattern.corners[pattern.ends[:, 0]], "walk": walk, "corner": pattern.corners,
        }  # fmt: skip
        none = {"law": [-1] * n, "law_at": [], "law_cell": [], "law_piece": [], "law_grid": []}
        laws = none if par.laws is None else par.laws.tables()
        floats |= {k: laws[k] for k in ("law_piece", "law_grid")}
        by = (np.zeros(n), np.zeros(n)) if par.laws is None else (par.laws.weight, par.laws.shift)
        floats |= dict(zip(("law_weight", "law_shift"), by, strict=True))
        sizes = placed, 6 * placed, SLOTS * placed, 9 * p, 3 * p * q, 3 * p, 3 * p * q, n
        floats |= {name: np.zeros(size) for name, size in zip(WORK, sizes, strict=True)}
        ints = {
            "here": here, "before": before, "crossed": crossed, "variable": poses.own(every.tolist()),
            "left": pattern.left, "chain_first": np.cumsum([0, *map(len, chain)]),
            "chain": [k for steps in chain for k in steps], "facet": c.facet, "ring": c.pieces,
            "after": rings.after, "ring_before": rings.before, "valid": rings.valid,
            "border": rings.border, "triangle": rings.triangle,
            "one": pairs[:, 0], "other": pairs[:, 1], "common": common,
        }  # fmt: skip
        ints |= {k: laws[k] for k in ("law", "law_at", "law_cell")}
        made = {k: np.array(x, np.float64, order="C") for k, x in floats.items()}
        made |= {k: np.array(x, np.int64, order="C") for k, x in ints.items()}
        m, most = problem.closure.count, n + SLOTS
        wide = m + SLOTS
        room = 4 * (n + wide + most + placed) * (n + wide + most) + 60 * (p * q + pattern.facets)
        room += SLOTS * (2 * placed + 12 + 4 * n) + 1000
        made["room"] = np.zeros(room)
        made["ints"] = np.zeros(40 * SLOTS + 20 * (n + wide + most) + len(pairs) + 1000, np.int64)
        return made

    @cached_property
    def _given(self) -> _SheetInC:
        problem, made = self.problem, self._kept
        c = problem.crossings
        loops, place = problem.closure.compiled.addresses
        at: dict[str, Any] = {"loops": loops, "place": place}
        at |= {k: x.ctypes.data for k, x in made.items()}
        plain = problem.parameters.dead is None
        at["outside"] = None if plain else ctypes.cast(self._outside, ctypes.c_void_p).value
        pieces, q = c.pieces.shape
        whole = (
            *(problem.size, problem.closure.count, c.pattern.creases, c.pattern.facets),
            *(c.poses.root, len(made["here"]), pieces, q, len(made["one"])),
            int(problem.parameters.laws is not None),
        )
        names = (name for names in PARTS.values() for name in names)
        # whichever way the sheet lies in space
        away = c.pattern.corners - c.pattern.corners.mean(axis=0)
        size, deep = float(np.linalg.norm(away, axis=1).max()), numerics.DEEP * c.size
        reach = FURTHEST * float(c.pattern.lengths.max()) / size
        return _SheetInC(*whole, size, deep, reach, *map(at.__getitem__, names))

    def __call__(
        self,
        starts: Sequence[StartState],
        asides: np.ndarray,
        pauses: bool = False,
        longest: float = LONGEST,
        path: np.ndarray | None = None,
    ) -> list[DescentEnd]:
        """Go downhill from states, each by itself.

        Parameters
        ----------
        starts
            Closed or nearly so; those that are drawn are closed with what they hold.
        asides
            Directions [K, n] that say to which side saddles are left.
        pauses
            Whether a way ends where facets come to lie on each other, and where all that is held is stationary.
        longest
            Step [rad].
        path
            Of one start: where its steps lead, [most, n], is written here.
        """
        limits, kept, count, n = (
            self.problem.fold_limits,
            self._kept,
            len(starts),
            self.problem.size,
        )
        x, side = np.array([s.x for s in starts]), np.array([s.side for s in starts], np.int64)
        given, points = np.zeros((count, SLOTS, 8), np.int64), np.zeros((count, SLOTS, 12))
        signs, picks = np.zeros((count, SLOTS)), np.zeros((count, PICKS), np.int64)
        for one, start in enumerate(starts):
            if not start.drawn:
                x[one] = limits.hold(x[one], side[one] * (side[one] != STAYS))
            picks[one, : len(start.picks)] = start.picks[:PICKS]
            for k, slot in enumerate(start.slots[:SLOTS]):
                (a, b), (i, j) = slot.pieces, slot.places
                given[one, k] = a, i, b, j, *slot.facets, slot.sides, slot.orders
                signs[one, k] = slot.sign
                if slot.points is not None:
                    points[one, k] = slot.points.ravel()
        whole = [
            np.array(each, np.int64)
            for each in (
                [2 if s.drawn else int(s.hold) for s in starts],
                [s.most for s in starts],
                [min(len(s.slots), SLOTS) for s in starts],
            )
        ]
        way = np.ascontiguousarray(asides, dtype=np.float64)
        pieces, sign = np.zeros((count, SLOTS, 4), np.int64), np.zeros((count, SLOTS))
        forces, ends, begun = (
            np.zeros((count, n + SLOTS)),
            np.zeros((count, 6)),
            np.zeros((count, n)),
        )
        kind, most, slots = map(address, whole)
        self._library.descend(
            *(ctypes.addressof(self._given), count, address(x), address(side), kind),
            *(address(picks), most, int(pauses), longest, None if path is None else address(path)),
            *(slots, address(given), address(points), address(signs), address(way)),
            *(
                address(kept["room"]),
                address(kept["ints"]),
                address(begun),
                address(forces),
                address(pieces),
                address(sign),
                address(ends),
            ),
        )
        if self._failed is not None:
            failed, self._failed = self._failed, None
            raise failed
        out = []
        for one, (status, steps, _, work, many, hold) in enumerate(ends.astype(int).tolist()):
            # those by points keep an order of layers: they are made anew
            own = np.flatnonzero(pieces[one, :many, 0] >= 0)
            kept_slots = tuple(
                Slot((a, b), (i, j), s)
                for (a, i, b, j), s in zip(
                    pieces[one, own].tolist(), sign[one, own].tolist(), strict=True
                )
            )
            counts = status == 0, REASONS[status], steps, work
            held = side[one], kept_slots, forces[one, : n + many], bool(hold)
            out.append(DescentEnd(x[one], begun[one], *counts, *held))
        return out
