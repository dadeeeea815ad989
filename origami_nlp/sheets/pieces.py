"""States at which facets meet at borders: minima on every piece of what can be folded beside them, or left on one.

Beside such a state the states that do not cross lie in a union of pieces: of each choice (`facets.choices`) one gap
stays open.  The state is a minimum if it is one on every piece.  A piece is cut out by gaps, so that fewer gaps are
tried first: what holds with them holds on all pieces that have them.  Where a direction of descent is left, it passes
some choice wholly (none of its gaps stays open along it), and the pieces are told apart by that choice; or it passes
none, and leads to lower states.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.facets import Choice, Sheet, dense
from origami_nlp.numerics import INDEPENDENT, STATIONARY, unbounded
from origami_nlp.sheets.contacts import Balance, balance, closed_choices, closed_contacts
from origami_nlp.sheets.curvature import curvature
from origami_nlp.sheets.lower import lower_state
from origami_nlp.sheets.rows import LOADED, Rows

MOST_PIECES = 500
"""Pieces on which a state is judged; at more it is not decided."""
MOST_FORCES = 20
"""Forces with which a certificate is tried, where they are not unique."""
UNSTRESSED = 1e-4
"""Torques over the mean stiffness [rad] below which residuals are not relative to them: all may be rounding."""


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
    way
        Its direction, or that of descent where torque is left, [n].
    proved
        Whether the state is a strict minimum with these rows.
    most
        The largest force of each row, [r].
    """

    rows: Rows
    balance: Balance
    missing: float
    lowest: float
    way: np.ndarray
    proved: bool
    most: np.ndarray

    @property
    def balanced(self) -> bool:
        """Whether the rows balance the springs."""
        return self.missing <= STATIONARY * 10

    @property
    def ways(self) -> tuple[np.ndarray, ...]:
        """Directions in which states may be lower, [n] each."""
        if self.balanced:
            return () if self.lowest >= 0 else (self.way, -self.way)
        return (self.way,)


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
    largest = max(float(np.abs(sheet.torque(phi)).max()), UNSTRESSED)
    missing = float(np.abs(found.left).max(initial=0.0)) / largest
    if missing > STATIONARY * 10:
        return Piece(rows, found, missing, math.nan, -found.left, False, found.forces)
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
            return Piece(rows, found, missing, lowest, way, True, most)
    return Piece(rows, found, missing, lowest, way, False, most)


def judge_pieces(
    sheet: Sheet,
    phi: np.ndarray,
    rows: Rows,
    choices: Sequence[Choice],
    z: np.ndarray,
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

    Returns
    -------
    Pieces
        What was found; it ends at the first piece on which the state is not known to be a minimum.
    """
    touches = list(dict.fromkeys(t for choice in choices for t in choice))
    place = {t: k for k, t in enumerate(touches)}
    gaps = Rows.at(sheet, phi, np.zeros(0, int), touches)
    lengths = np.maximum(np.linalg.norm(gaps.slopes @ z, axis=1), INDEPENDENT)
    # in an order that numbers of corners do not change: choices that are passed alike differ in the lengths of slopes
    columns = [sorted((place[t] for t in c), key=lambda k: round(lengths[k], 9)) for c in choices]
    columns.sort(key=lambda c: [round(lengths[k], 9) for k in c])
    out = Pieces()
    waiting: list[tuple[int, ...]] = [()]
    while waiting:
        chosen = waiting.pop()
        out.count += 1
        held = rows.with_touches(gaps, chosen)
        piece = judge_piece(sheet, phi, held, balance(sheet, phi, held, z))
        if piece.proved:
            out.proved.append(piece)
            continue
        out.left = piece
        if out.count >= MOST_PIECES:
            return out
        passed: list[int] | None = None
        for way in piece.ways:
            opening = gaps.slopes @ way / (lengths * max(float(np.linalg.norm(way)), 1e-300))
            best = [math.inf if set(c) & {*chosen} else max(opening[c]) for c in columns]
            least = min([*best, 0.0])
            if least < -INDEPENDENT:  # alike to rounding: the first
                worst = next(i for i, b in enumerate(best) if b < 0.999 * least)
                passed = columns[worst] if passed is None else passed
                continue
            along = [*chosen, *(c[int(opening[c].argmax())] for c in columns)]
            held = rows.with_touches(gaps, dict.fromkeys(along))
            out.lower = lower_state(sheet, phi, way, held, contact=True)
            if out.lower is not None:
                return out
        if passed is None:
            return out
        out.left = None
        waiting += [(*chosen, k) for k in passed]
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
    return judge_pieces(sheet, phi, rows, meeting, sheet.kernel(phi))
