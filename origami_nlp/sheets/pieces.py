"""States at which facets meet at borders or face to face: minima on every piece of what can be folded beside them.

Beside such a state the states that do not cross lie in a union of pieces.  Of facets that meet at borders one of
several gaps stays open (`facets.choices`); of facets that lie face to face one is above, and a gap at each corner of
their overlap stays open: the same one in every order of layers that there is, or either (`facets.Faces`).  The state is
a minimum if it is one on every piece.  A piece is cut out by gaps, so that fewer gaps are tried first: what holds with
them holds on all pieces that have them.  Where a direction of descent is left, it passes some choice wholly (none of
its options stays open along it), and the pieces are told apart by that choice; or it passes none, and leads to lower
states.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from origami_nlp.facets import Choice, Faces, Lying, Placed, Sheet, Touch, dense
from origami_nlp.numerics import CLOSES, INDEPENDENT, STATIONARY, nearest_in_cone, unbounded
from origami_nlp.sheets.branches import Branches
from origami_nlp.sheets.contacts import Balance, balance, closed_choices, closed_contacts
from origami_nlp.sheets.curvature import curvature
from origami_nlp.sheets.lower import lower_state
from origami_nlp.sheets.rows import LOADED, Rows
from origami_nlp.sheets.sharp import slopes

MOST_PIECES = 500
"""Pieces on which a state is judged; at more it is not decided."""
DRAWN = 8
"""Directions of descent that are drawn where the steepest one leads to no lower state."""
DOWN = 1e-3
"""Slope of a direction of descent, over the steepest one that closure allows."""
MOST_FORCES = 20
"""Forces with which a certificate is tried, where they are not unique."""
UNSTRESSED = 1e-4
"""Torques over the mean stiffness [rad] below which residuals are not relative to them: all may be rounding."""

Chosen: TypeAlias = tuple[tuple[int, ...], dict[int, bool]]
"""Of a piece: gaps chosen at borders, and of pairs that may lie either way whether the first is above."""


@dataclass(frozen=True, eq=False)
class Piece:
    """A state judged with some rows that must stay open.

    Attributes
    ----------
    rows
        Limits and gaps.
    balance
        Their forces.
    missing
        Torque that is left, over the largest.
    lowest
        Smallest curvature of the Lagrangian along what loaded rows leave free; nan where the torque is not balanced.
    proved
        Whether the state is a strict minimum with these rows.
    most
        The largest force of each row, [r].
    ways
        Directions in which states may be lower, [n] each.
    sharp
        Whether it is one because energy rises along every way out to first order, balanced or not.
    """

    rows: Rows
    balance: Balance
    missing: float
    lowest: float
    proved: bool
    most: np.ndarray
    ways: tuple[np.ndarray, ...] = ()
    sharp: bool = False

    @property
    def balanced(self) -> bool:
        """Whether the rows balance the springs."""
        return self.missing <= STATIONARY * 10


@dataclass(eq=False)
class Pieces:
    """What was found on the pieces at a state.

    Attributes
    ----------
    proved
        Those that suffice: the state is a minimum if `left` is None.
    left
        The piece on which it is none, or is not known to be one.
    lower
        A lower state that was found there, [n].
    count
        Of pieces judged.
    """

    proved: list[Piece] = field(default_factory=list)
    left: Piece | None = None
    lower: np.ndarray | None = None
    count: int = 0


def judge_piece(sheet: Sheet, phi: np.ndarray, rows: Rows, found: Balance) -> Piece:
    """Judge a closed state with rows that must stay open, by second-order sufficient conditions.

    Parameters
    ----------
    sheet, phi
        The programme and the state, [n] [rad].
    rows
        Limits and gaps that are closed.
    found
        Forces of them that balance the springs as well as can be.

    Returns
    -------
    Piece
        What was found.
    """
    piece = _certified(sheet, phi, rows, found)
    flat = [isinstance(t, Lying) for t in rows.touches]
    if not piece.proved or math.isinf(piece.lowest) or not any(flat):
        return piece
    # to second order only points inside both facets are known to stay apart
    inner = rows.inside(sheet, phi)
    again = _certified(sheet, phi, inner, balance(sheet, phi, inner, sheet.kernel(phi)))
    return replace(piece, proved=again.proved)


def _certified(sheet: Sheet, phi: np.ndarray, rows: Rows, found: Balance) -> Piece:
    """Look for forces with which curvature is positive along what loaded rows leave free."""
    largest = max(float(np.abs(sheet.torque(phi)).max()), UNSTRESSED)
    missing = float(np.abs(found.left).max(initial=0.0)) / largest
    if missing > STATIONARY * 10:
        return Piece(rows, found, missing, math.nan, False, found.forces, (-found.left,))
    corners, _, most = found.choices()
    # forces that cancel each other can be added, however small: with them contacts are loaded
    cancel = np.zeros(len(found.forces), bool) if found.unique else unbounded(found.columns)
    cancel &= np.isfinite(found.lengths)
    lowest, way = math.nan, np.zeros(0)
    for forces in (found.forces, np.mean(corners, axis=0), *corners[:MOST_FORCES]):
        loaded = (forces > LOADED) | cancel
        pushing = rows.slopes.T @ np.where(forces > LOADED, forces, 0.0)
        lam = sheet.normal(phi).multipliers(sheet.torque(phi) - pushing)
        hessian = sheet.hessian(phi, lam)
        if rows.touches:
            hessian = dense(hessian) - rows.bent(sheet, phi, forces)
        many = len(rows.limits)
        lowest, way, proved = curvature(
            sheet, phi, hessian, rows.limits[loaded[:many]], rows.slopes[many:][loaded[many:]]
        )
        if proved:
            return Piece(rows, found, missing, lowest, True, most)
    ways = () if lowest >= 0 else (way, -way)
    return Piece(rows, found, missing, lowest, False, most, ways)


def judge_pieces(
    sheet: Sheet,
    phi: np.ndarray,
    rows: Rows,
    choices: Sequence[Choice],
    z: np.ndarray,
    faces: Faces | None = None,
    ways: Branches | None = None,
) -> Pieces:
    """Judge a state on every piece.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state, [n] [rad].
    rows
        Limits and gaps that stay open on every piece.
    choices
        Gaps of which one at least stays open.
    z
        Basis of what closure allows, [n, t].
    faces
        Facets that lie face to face; none by default.
    ways
        Out of the state, where closure loses rank; not known by default.

    Returns
    -------
    Pieces
        What was found; it ends at the first piece on which the state is not known to be a minimum.
    """
    tree = _Tree(sheet, phi, choices, z, faces)
    if tree.known:
        known = Rows.at(sheet, phi, np.zeros(0, int), tree.known)
        rows = rows.with_touches(known, range(len(tree.known)))
    out = Pieces()
    waiting: list[Chosen] = [((), {})]
    while waiting:
        sheet.check_time()
        gaps, above = waiting.pop()
        out.count += 1
        held = rows.with_touches(tree.gaps, tree.rows_of(gaps, above)).needed(z, tree.flat)
        piece = judge_piece(sheet, phi, held, balance(sheet, phi, held, z))
        if not piece.proved and ways is not None:
            rises, falling = slopes(sheet, phi, ways, held.slopes)
            piece = replace(piece, proved=rises, sharp=rises, ways=(*piece.ways, *falling))
        if piece.proved:
            out.proved.append(piece)
            continue
        out.left = piece
        if out.count >= MOST_PIECES:
            return out
        split: list[Chosen] = []
        for way in (*piece.ways, *_aside(sheet, phi, piece, z)):
            more, along = tree.passed(gaps, above, way)
            if more:
                split = split or more
                continue
            held = rows.with_touches(tree.gaps, along)
            out.lower = lower_state(sheet, phi, way, held, contact=True)
            if out.lower is not None:
                return out
        if not split:
            return out
        out.left = None
        waiting += split
    return out


def pieces_at(sheet: Sheet, phi: np.ndarray) -> Pieces:
    """Judge a state on every piece of what meets there.

    Parameters
    ----------
    sheet, phi
        The programme, and a closed state in which no facets cross, [n] [rad].

    Returns
    -------
    Pieces
        Of `judge_pieces`, with all that is closed at the state.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.facets import Sheet
    >>> from origami_nlp.sheets import pieces_at
    >>> sheet = Sheet(o.examples.pattern("miura", 1, 2).with_springs(1.0, 0.5))
    >>> pieces_at(sheet, np.array([-0.5])).left is None, pieces_at(sheet, np.array([-0.4])).lower
    (True, array([-0.4001]))
    """
    rows, meeting = closed_contacts(sheet, phi), closed_choices(sheet, phi)
    return judge_pieces(sheet, phi, rows, meeting, sheet.kernel(phi), Faces(sheet, phi))


def _aside(sheet: Sheet, phi: np.ndarray, piece: Piece, z: np.ndarray) -> Iterator[np.ndarray]:
    """Go through more directions of descent [n] that rows leave open, where torque is left: inward first, then any.

    Along the steepest one contacts stay closed that bend, or closure that loses rank is not kept to second order.
    """
    if piece.balanced:
        return
    c, rows = z.T @ sheet.torque(phi), piece.rows.slopes @ z
    size = float(np.linalg.norm(c))
    inward = rows.sum(axis=0)
    inward *= size / max(float(np.linalg.norm(inward)), 1e-300)
    drawn = size * np.random.default_rng(0).normal(size=(DRAWN, len(c)))
    for aside in (0.3 * inward, inward, *drawn):
        y = nearest_in_cone(aside - c, rows)
        if c @ y < -DOWN * size * float(np.linalg.norm(y)):
            yield z @ y


class _Tree:
    """What keeps facets apart in several ways: gaps at borders of which one stays open, pairs that lie either way."""

    def __init__(
        self,
        sheet: Sheet,
        phi: np.ndarray,
        choices: Sequence[Choice],
        z: np.ndarray,
        faces: Faces | None,
    ) -> None:
        self.faces = faces
        self.known: list[Touch] = []
        either: dict[int, tuple[tuple[Touch, ...], tuple[Touch, ...]]] = {}
        if faces is not None:
            place = Placed(sheet.crossings.poses, phi)

            def closed(pair: int, above: bool) -> tuple[Touch, ...]:
                every = faces.touches(pair, above)
                return tuple(t for t in every if t.gap(place) <= CLOSES * sheet.crossings.size)

            either = {k: (closed(k, False), closed(k, True)) for k in faces.open}
            self.known = [t for pair, above in faces.known for t in closed(pair, above)]
        self.flat = {*self.known, *(t for both in either.values() for way in both for t in way)}
        every: list[Touch] = [t for choice in choices for t in choice]
        every += [t for both in either.values() for touches in both for t in touches]
        touches = list(dict.fromkeys(every))
        number = {t: k for k, t in enumerate(touches)}
        self.gaps = Rows.at(sheet, phi, np.zeros(0, int), touches)
        self.lengths = np.maximum(np.linalg.norm(self.gaps.slopes @ z, axis=1), INDEPENDENT)
        size = self.lengths.round(9)
        # in an order that numbers of corners do not change: choices passed alike differ in the lengths of slopes
        self.columns = [sorted((number[t] for t in c), key=lambda k: size[k]) for c in choices]
        self.columns.sort(key=lambda c: [size[k] for k in c])
        self.either = {
            k: tuple([number[t] for t in way] for way in both) for k, both in either.items()
        }

    def rows_of(self, gaps: tuple[int, ...], above: dict[int, bool]) -> list[int]:
        """Return the numbers of gaps that stay open: some chosen at borders, those of pairs whose order is known."""
        return [
            *dict.fromkeys([*gaps, *(k for p, up in above.items() for k in self.either[p][up])])
        ]

    def passed(
        self, gaps: tuple[int, ...], above: dict[int, bool], way: np.ndarray
    ) -> tuple[list[Chosen], list[int]]:
        """Tell the pieces apart by a choice that a direction passes; or return the gaps that it keeps open."""
        opening = self.gaps.slopes @ way
        opening /= self.lengths * max(float(np.linalg.norm(way)), 1e-300)
        best = [math.inf if set(c) & {*gaps} else max(opening[c]) for c in self.columns]
        free = [p for p in self.either if p not in above]
        sides = [[float(min(opening[k], default=0.0)) for k in self.either[p]] for p in free]
        least = min([*best, *map(max, sides), 0.0])
        if least < -INDEPENDENT:  # alike to rounding: the first
            worst = next((i for i, b in enumerate(best) if b < 0.999 * least), -1)
            if worst >= 0:
                return [((*gaps, k), above) for k in self.columns[worst]], []
            return self._either(
                gaps, above, free[next(i for i, s in enumerate(sides) if max(s) < 0.999 * least)]
            ), []
        settled = dict(above)
        for pair, (down, up) in sorted(zip(free, sides, strict=True), key=lambda one: min(one[1])):
            assert self.faces is not None
            if pair in settled and min(down, up) >= -INDEPENDENT:
                continue
            lies = self.faces.follow({**settled, pair: up >= down})
            if lies is None:  # each pair would stay apart, but not all of them
                return self._either(gaps, above, pair), []
            settled = lies
        along = [max(c, key=lambda k: opening[k]) for c in self.columns if not set(c) & {*gaps}]
        return [], self.rows_of((*gaps, *along), settled)

    def _either(self, gaps: tuple[int, ...], above: dict[int, bool], pair: int) -> list[Chosen]:
        """Let a pair lie either way, where there is an order with it, with what follows."""
        assert self.faces is not None
        both = [self.faces.follow({**above, pair: up}) for up in (False, True)]
        return [(gaps, lies) for lies in both if lies is not None]
