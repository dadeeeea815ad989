"""What a pattern is: how much there is of it, how many degrees of freedom it has flat and folded, and what is odd.

In JSON vertices and edges are numbered from 0 as in the file, angles in radians.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.display import Details, Report, Section, Table
from origami_nlp.io import from_plain, to_plain
from origami_nlp.numerics import CLOSURE_TOL, INPUT_TOL, NOISE, RANK
from origami_nlp.pattern import Pattern, as_pattern, listed, pattern_from_dict, pattern_to_dict
from origami_nlp.pattern_problem import MOVES, Layers, PatternProblem, angle_sums, check_orders

if TYPE_CHECKING:
    from typing import Self

SIZES = (0.3, 0.5, 1.0)
"""Fold angles from which mountains and valleys are folded [rad]."""
DRAWN = (0.5, 1.0, 2.0)
"""Largest fold angles of random starts [rad]."""
MOST_DRAWN = 30
"""Of such starts; one of the largest sheets."""
NEIGHBOURS = 6
"""States beside a folded one that are looked at, whether their rank is higher."""
OFFSET = 0.1
"""How far from it they start [rad]."""
MOST_VALUES = 1_000
"""Creases up to which states beside a folded one are looked at."""
MODELLED = (
    "modelled: rigid facets without thickness, springs at creases, every loop closed; a state is judged, not the way "
    "to it"
)


@dataclass(frozen=True, eq=False, repr=False)
class Mobility(Report):
    """The counts of a pattern.

    Attributes
    ----------
    pattern
        What was looked at.
    closure_rows
        Equations m: three for each interior vertex, six for each hole.
    rank_flat
        Of the Jacobian of closure at the flat state; None where the sheet cannot lie flat.
    rank_folded
        Of it at `folded`; None where no folded state was found.
    folded
        A closed state in which as many creases are folded as was found, [n] [rad]; None where there is none.
    start
        What that state was reached from.
    crossed
        Number of pairs of facets that cross in it.
    layers
        Of the state that the file describes, where that is folded, closes, and no facets pierce each other; else None.

    Examples
    --------
    >>> import origami_nlp as o
    >>> seen = o.analyze_mobility(o.examples.pattern("metasheet", 3, 3))
    >>> seen.closure_rows, seen.rank_folded, seen.dof
    (12, 11, 1)
    """

    PICTURE = "draw_mobility"
    SCHEMA = "origami-nlp/pattern/2"
    pattern: Pattern
    closure_rows: int
    rank_flat: int | None
    rank_folded: int | None
    folded: np.ndarray | None
    start: str
    crossed: int
    layers: Layers | None = None

    @property
    def dof(self) -> int | None:
        """Number of independent motions of the folded sheet: creases less rank; 0 where the flat one has none."""
        if self.rank_folded is not None:
            return self.pattern.creases - self.rank_folded
        # flat, more may be free to first order than moves: that no motion is there to first order is enough
        return 0 if self.rank_flat == self.pattern.creases else None

    @property
    def redundant(self) -> int | None:
        """Number of equations that follow from others at the folded state: as many states of self-stress."""
        return None if self.rank_folded is None else self.closure_rows - self.rank_folded

    @property
    def verdict(self) -> str:
        """How many degrees of freedom it has, in a sentence."""
        words = {
            None: "degrees of freedom not decided: no folded state was found",
            0: "rigid: no degree of freedom is left",
            1: "folds with 1 degree of freedom",
        }
        said = words.get(self.dof, f"folds with {self.dof} degrees of freedom")
        through = self.folded is not None and self.crossed
        return f"{self.pattern.title}: {said}{', but facets cross where it was folded' if through else ''}"

    def report_sections(self) -> Iterator[Section]:
        """Return the verdict over a table of what there is, what is odd, and the ranks behind it."""
        p = self.pattern
        degrees = Counter(len(loop.creases) for loop in p.vertices)
        which = ", ".join(f"{many} of degree {d}" for d, many in sorted(degrees.items()))
        letters = Counter(p.assignment)
        kinds = ", ".join(f"{letters[a]} {a}" for a in "MVUF" if letters[a])
        pieces = f"of {len(p.polygons)} polygons" if len(p.polygons) > p.facets else ""
        at = f"counted at one folded state: {self.start}" if self.folded is not None else ""
        flat = "" if self.stress_flat is None else f", flat {self.stress_flat}"
        rows = [
            ("facets", str(p.facets), pieces),
            ("creases", str(p.creases), kinds),
            ("interior vertices", str(len(p.vertices)), which),
            ("holes", str(len(p.holes)), ""),
            ("degrees of freedom", _number(self.dof), at),
            ("states of self-stress", _number(self.redundant), f"there{flat}" if at else ""),
        ]
        if self.layers is not None and (self.layers.pairs or p.orders):
            rows.append(("pairs of layers", str(self.layers.pairs), self.layers.words()))
        yield _table(rows, self.verdict)
        for note in self.oddities():
            yield f"note: {note}"
        ranks = [
            ("closure equations", str(self.closure_rows), "3 a vertex, 6 a hole"),
            (
                "rank, flat",
                _number(self.rank_flat),
                "" if p.lies_flat else "reference: folded form",
            ),
            ("rank, folded", _number(self.rank_folded), "degrees of freedom: creases less this"),
        ]
        yield Details((_table(ranks, ""), MODELLED), "Closure equations, ranks, model")

    @property
    def stress_flat(self) -> int | None:
        """Number of states of self-stress of the flat sheet, which is equations less rank."""
        return None if self.rank_flat is None else self.closure_rows - self.rank_flat

    def oddities(self) -> list[str]:
        """Return what is odd about the pattern, one sentence each."""
        p = self.pattern
        said = [*p.notes]
        few = [loop.vertex for loop in p.vertices if len(loop.creases) < 4]
        if few:
            said.append(
                f"vertices {listed(few)} have fewer than four creases: flat ones fold along a straight line only"
            )
        sums = angle_sums(p)
        bent = {v: a for v, a in sums.items() if abs(a - 2 * math.pi) > NOISE}
        if bent:
            worst = max(bent, key=lambda v: abs(bent[v] - 2 * math.pi))
            said.append(
                f"{_many(len(bent), 'vertex is', 'vertices are')} not flat ("
                f"angle sum {math.degrees(bent[worst]):.6g} degrees at vertex "
                f"{worst})"
            )
        noise = max((abs(a - 2 * math.pi) for v, a in sums.items() if v not in bent), default=0.0)
        if noise > INPUT_TOL:
            said.append(
                f"angle sums miss 360 degrees by up to {math.degrees(noise):.1e}: noise in coordinates, with which "
                "redundant equations need not have a common solution"
            )
        if self.dof == 0 and p.creases:
            said.append(
                "no degree of freedom is left: with rigid facets it does not move; patterns such as Kresling's and the "
                "hypar bend their facets, which is not modelled"
            )
        if self.folded is None and self.dof is None:
            said.append("no folded state was found: there may be none, or none of its assignment")
        elif self.folded is not None:
            still = np.flatnonzero(np.abs(self.folded) <= MOVES)
            if len(still):
                said.append(
                    f"{_many(len(still), 'crease stays', 'creases stay')} flat in that state (edges "
                    f"{listed(p.numbers[still].tolist())}); "
                    "other branches may have fewer degrees of freedom"
                )
            if (np.abs(self.folded) >= math.pi).any():
                said.append(
                    "creases are fully folded in that state: where layers coincide it may have more degrees of freedom "
                    "than its neighbours"
                )
            if self.crossed:
                said.append(f"{_many(self.crossed, 'pair', 'pairs')} of facets cross in that state")
            against = np.flatnonzero(p.signs * self.folded < -MOVES)
            if len(against):
                said.append(
                    f"{_many(len(against), 'crease folds', 'creases fold')} against the letters there (edges "
                    f"{listed(p.numbers[against].tolist())})"
                )
        return said

    def _to_plain(self) -> dict[str, Any]:
        p = self.pattern
        return {
            "name": p.name,
            "pattern": pattern_to_dict(p),
            "facets": p.facets,
            "creases": p.creases,
            "interior_vertices": len(p.vertices),
            "holes": len(p.holes),
            "closure_rows": self.closure_rows,
            "rank_flat": self.rank_flat,
            "rank_folded": self.rank_folded,
            "dof": self.dof,
            "redundant": self.redundant,
            "self_stress": {"flat": self.stress_flat, "folded": self.redundant},
            "layers": to_plain(self.layers),
            "edges": p.numbers.tolist(),
            "assignment": p.assignment,
            "stiffness": p.stiffness.tolist(),
            "rest_angles": p.rest.tolist(),
            "vertices": [loop.vertex for loop in p.vertices],
            "folded": None
            if self.folded is None
            else {
                "fold_angles": self.folded.tolist(),
                "start": self.start,
                "crossings": self.crossed,
            },
            "notes": self.oddities(),
        }

    @classmethod
    def _from_plain(cls, data: dict[str, Any]) -> Self:
        folded, layers = data["folded"], data["layers"]
        return cls(
            pattern_from_dict(data["pattern"]),
            int(data["closure_rows"]),
            data["rank_flat"],
            data["rank_folded"],
            None if folded is None else np.array(folded["fold_angles"], float),
            "" if folded is None else str(folded["start"]),
            0 if folded is None else int(folded["crossings"]),
            None if layers is None else from_plain(Layers, layers),
        )

    def _rows(self) -> Iterable[dict[str, object]]:
        names = ["name", "facets", "creases", "interior_vertices", "holes", "closure_rows"]
        names += ["rank_flat", "rank_folded", "dof", "redundant"]
        data = self.to_dict()
        yield {name: data[name] for name in names}


def analyze_mobility(pattern: Pattern | str | Path, *, seed: int = 0) -> Mobility:
    """Count what a pattern has, and the degrees of freedom of its flat and of a folded state.

    The folded state is reached from the reference state of a folded form, the fold angles of the file, or its mountains
    and valleys; otherwise, or where creases stay flat, from random starts: of all that close within the fold limits it
    is the one in which most creases are folded, then fewest facets cross.

    Parameters
    ----------
    pattern
        Of `read_pattern` or `make_pattern`, the name of an example such as ``"miura:4x4"``, or a FOLD file.
    seed
        Of random starts.

    Returns
    -------
    Mobility
        The counts.

    Raises
    ------
    OptionError
        If `pattern` is not of its type.
    FoldFileError
        If faceOrders of the file contradict how its facets lie.

    Examples
    --------
    >>> import origami_nlp as o
    >>> seen = o.analyze_mobility(o.examples.pattern("miura", 4, 4))
    >>> seen.dof, seen.rank_flat, seen.redundant
    (1, 18, 4)
    """
    pattern = as_pattern(pattern)
    check_whole("seed", seed, 0)
    problem = PatternProblem(pattern)
    layers = check_orders(problem)
    folded, start = _folded(problem, np.random.default_rng(seed))
    zero = np.zeros(pattern.creases)
    off = problem.residual(zero)
    return Mobility(
        pattern,
        problem.closure.count,
        problem.rank(zero, max(RANK, 10 * off)) if off <= NOISE else None,
        None if folded is None else problem.rank(folded),
        folded,
        start,
        0 if folded is None else len(problem.crossings.find(folded)),
        layers,
    )


def _folded(problem: PatternProblem, rng: np.random.Generator) -> tuple[np.ndarray | None, str]:
    """Return the closed state in which most creases are folded, and what it was reached from."""
    best: tuple[tuple[int, int], np.ndarray | None, str] = ((0, 0), None, "")
    for phi, start in _starts(problem.pattern, rng):
        new, residual = problem.project(phi)
        if (
            residual > CLOSURE_TOL
            or (np.abs(new) > math.pi).any()
            or not problem.closure.lifts_to_one(new)
        ):
            continue
        moved = int((np.abs(new) > MOVES).sum())
        if moved < max(best[0][0], 1):
            continue
        crossed = len(problem.crossings.find(new))
        if (moved, -crossed) > best[0] or best[1] is None:
            best = (moved, -crossed), new, start
        if moved == problem.size and not crossed:
            break
    return _regular(problem, best[1], best[2], rng)


def _regular(
    problem: PatternProblem, phi: np.ndarray | None, start: str, rng: np.random.Generator
) -> tuple[np.ndarray | None, str]:
    """Move off a state at which more creases are aligned by chance than in its neighbourhood."""
    if phi is None or problem.size > MOST_VALUES:
        return phi, start
    rank = problem.rank(phi)
    if rank == min(problem.closure.count, problem.size - 1):
        return phi, start
    for _ in range(NEIGHBOURS):
        z = problem.kernel(phi)
        inwards = np.clip(phi, OFFSET - math.pi, math.pi - OFFSET)
        new, residual = problem.project(inwards + OFFSET * (z @ rng.standard_normal(z.shape[1])))
        if (
            residual > CLOSURE_TOL
            or (np.abs(new) > math.pi).any()
            or not problem.closure.lifts_to_one(new)
        ):
            continue
        if (more := problem.rank(new)) > rank:
            phi, rank, start = new, more, start.removeprefix("near: ").join(("near: ", ""))
    return phi, start


def _starts(p: Pattern, rng: np.random.Generator) -> Iterator[tuple[np.ndarray, str]]:
    at_limit = np.abs(p.reference) >= math.pi
    if p.reference.any() and not at_limit.all():
        yield p.reference, "as in the file"
    given = np.where(np.isnan(p.file_angles), 0.0, p.file_angles)
    if given.any() and (np.abs(given) < math.pi).all():
        yield given, "fold angles of the file"
    if p.signs.any():
        for size in SIZES:
            yield size * p.signs, f"mountains and valleys at {size} rad"
    for k in range(max(1, min(MOST_DRAWN, 3_000 // max(p.creases, 1)))):
        size = DRAWN[k % len(DRAWN)]
        yield rng.uniform(-size, size, p.creases), f"a random start, number {k + 1}"


def _table(rows: Sequence[tuple[str, str, str]], title: str) -> Table:
    return Table(("", "number", ""), rows, title, "lrL", framed=False)


def _number(value: int | None) -> str:
    return "-" if value is None else str(value)


def _many(count: int, one: str, more: str) -> str:
    return f"{count} {one if count == 1 else more}"
