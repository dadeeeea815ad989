"""What a pattern is: how much there is of it, how many degrees of freedom it has flat and folded, and what is odd."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.display import Flags, Report, Section, Table
from origami_nlp.numerics import CLOSURE_TOL, INPUT_TOL, NOISE, RANK
from origami_nlp.pattern import Pattern, as_pattern
from origami_nlp.pattern_problem import MOVES, Layers, PatternProblem, angle_sums, check_orders

DRAWN = (0.5, 1.0, 2.0)
"""Largest fold angles of random starts [rad]."""
OFFSET = 0.1
"""How far from it they start [rad]."""
COUNTS = {
    "facets": "facets",
    "creases": "creases",
    "interior_vertices": "interior vertices",
    "holes": "holes",
    "dof": "degrees of freedom",
    "redundant": "states of self-stress",
    "closure_rows": "closure equations",
    "rank_flat": "rank flat",
    "rank_folded": "rank folded",
}
"""Of a `Mobility`, as its table calls them."""


@dataclass(frozen=True, repr=False)
class PatternFlags(Flags):
    """Of a `Mobility`: what is odd about the pattern.

    Attributes
    ----------
    few_creases
        A vertex has fewer than four creases: where the paper round it is flat it folds along a straight line only.
        Cure: None is needed if that is meant; else draw the creases that are missing.
    not_flat
        The sector angles round a vertex do not sum to 360 degrees. Cure: None is needed for paper that is meant not to
        lie flat; else `check` names the vertices and the error of the drawing.
    noisy_angles
        Sums of sector angles miss 360 degrees by the noise of coordinates, with which redundant equations need not have
        a common solution. Cure: Write coordinates with more digits, or use --snap.
    rigid
        No degree of freedom is left: with rigid facets the sheet does not move. Cure: None with rigid facets; patterns
        such as Kresling's and the hypar bend their facets (--bend).
    nothing_folded
        No folded state was found: there may be none, or none of its assignment. Cure: Another `seed`, or fold angles
        in the file.
    creases_stay_flat
        Creases are flat in the folded state at which degrees of freedom are counted. Cure: None is needed; other
        branches may have fewer.
    fully_folded
        Creases are fully folded in that state. Cure: None is needed; where layers coincide it may have more degrees of
        freedom than its neighbours.
    facets_cross
        Facets cross in that folded state. Cure: It is no state of paper; give fold angles of one in the file.
    against_letters
        Creases fold against their letters in that state. Cure: Look at the assignment; mountains and valleys may be
        exchanged.
    """

    few_creases: bool = False
    not_flat: bool = False
    noisy_angles: bool = False
    rigid: bool = False
    nothing_folded: bool = False
    creases_stay_flat: bool = False
    fully_folded: bool = False
    facets_cross: bool = False
    against_letters: bool = False


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
    SCHEMA = "origami-nlp/pattern/3"
    ALSO = (*list(COUNTS)[:6], "flags")
    pattern: Pattern
    closure_rows: int
    rank_flat: int | None
    rank_folded: int | None
    folded: np.ndarray | None
    start: str
    crossed: int
    layers: Layers | None = None

    @property
    def facets(self) -> int:
        """Number of facets."""
        return self.pattern.facets

    @property
    def creases(self) -> int:
        """Number of creases."""
        return self.pattern.creases

    @property
    def interior_vertices(self) -> int:
        """Number of vertices with paper all round."""
        return len(self.pattern.vertices)

    @property
    def holes(self) -> int:
        """Number of holes."""
        return len(self.pattern.holes)

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
        said = f"folds with {self.dof} degree{'s' * (self.dof != 1)} of freedom"
        if self.dof is None:
            said = "degrees of freedom not decided: no folded state was found"
        elif not self.dof:
            said = "rigid: no degree of freedom is left"
        crossing = ", but facets cross where it was folded" * (self.crossed > 0)
        return f"{self.pattern.title}: {said}{crossing}"

    def report_sections(self) -> Iterator[Section]:
        """Return the verdict over a table of what there is, and what is odd."""
        p = self.pattern
        degrees = Counter(len(loop.creases) for loop in p.vertices)
        letters = Counter(p.assignment)
        of_degree = (f"{n} of degree {d}" for d, n in sorted(degrees.items()))
        remarks = {
            "interior_vertices": ", ".join(of_degree),
            "creases": ", ".join(f"{letters[a]} {a}" for a in "MVUF" if letters[a]),
            "dof": f"counted at one folded state: {self.start}" * (self.folded is not None),
            "closure_rows": "3 a vertex, 6 a hole",
        }
        rows = []
        for name, label in COUNTS.items():
            n = getattr(self, name)
            rows.append((label, "-" if n is None else str(n), remarks.get(name, "")))
        if self.layers is not None and (self.layers.pairs or p.orders):
            rows.append(("pairs of layers", str(self.layers.pairs), self.layers.words()))
        yield Table(("", "number", ""), rows, self.verdict, "lrL", framed=False)
        yield from (f"note: {note}" for note in p.notes)
        if self.flags:
            yield self.flags.table()

    @property
    def flags(self) -> PatternFlags:
        """What is odd about the pattern, each with cause and cure."""
        p, sums = self.pattern, angle_sums(self.pattern).values()
        phi = np.zeros(p.creases) if self.folded is None else self.folded
        off = np.array([abs(a - 2 * math.pi) for a in sums])
        return PatternFlags(
            few_creases=any(len(loop.creases) < 4 for loop in p.vertices),
            not_flat=bool((off > NOISE).any()),
            noisy_angles=bool(((off > INPUT_TOL) & (off <= NOISE)).any()),
            rigid=self.dof == 0 and p.creases > 0,
            nothing_folded=self.folded is None and self.dof is None,
            creases_stay_flat=self.folded is not None and bool((np.abs(phi) <= MOVES).any()),
            fully_folded=bool((np.abs(phi) >= math.pi).any()),
            facets_cross=self.crossed > 0,
            against_letters=bool((p.signs * phi < -MOVES).any()),
        )

    def _rows(self) -> Iterable[dict[str, object]]:
        yield {"name": self.pattern.name, **{name: getattr(self, name) for name in COUNTS}}


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


def _closed(problem: PatternProblem, phi: np.ndarray) -> np.ndarray | None:
    """Return the closed state within +-pi that a state projects to, if there is one."""
    new, residual = problem.project(phi)
    closes = residual <= CLOSURE_TOL and (np.abs(new) <= math.pi).all()
    return new if closes and problem.closure.lifts_to_one(new) else None


def _folded(problem: PatternProblem, rng: np.random.Generator) -> tuple[np.ndarray | None, str]:
    """Return the closed state in which most creases are folded, and what it was reached from."""
    best, state, reached = (0, 0), None, ""
    for phi, start in _starts(problem.pattern, rng):
        new = _closed(problem, phi)
        moved = 0 if new is None else int((np.abs(new) > MOVES).sum())
        if new is None or moved < max(best[0], 1):
            continue
        crossed = len(problem.crossings.find(new))
        if (moved, -crossed) > best:
            best, state, reached = (moved, -crossed), new, start
        if moved == problem.size and not crossed:
            break
    return _regular(problem, state, reached, rng)


def _regular(
    problem: PatternProblem, phi: np.ndarray | None, start: str, rng: np.random.Generator
) -> tuple[np.ndarray | None, str]:
    """Move off a state at which more creases are aligned by chance than in its neighbourhood."""
    # of larger sheets states beside it are not looked at
    if phi is None or problem.size > 1_000:
        return phi, start
    rank = problem.rank(phi)
    if rank == min(problem.closure.count, problem.size - 1):
        return phi, start
    for _ in range(6):
        z = problem.kernel(phi)
        inwards = np.clip(phi, OFFSET - math.pi, math.pi - OFFSET)
        new = _closed(problem, inwards + OFFSET * (z @ rng.standard_normal(z.shape[1])))
        if new is not None and (more := problem.rank(new)) > rank:
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
        for size in (0.3, 0.5, 1.0):
            yield size * p.signs, f"mountains and valleys at {size} rad"
    # one of the largest sheets
    for k in range(max(1, min(30, 3_000 // max(p.creases, 1)))):
        size = DRAWN[k % len(DRAWN)]
        yield rng.uniform(-size, size, p.creases), f"a random start, number {k + 1}"
