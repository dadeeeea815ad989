"""Where equilibria go on from a state: one-sided conditions on contacts choose among the sets that may be held.

At a state with closed contacts R and multipliers mu >= 0 of them, half-branches hold W, a subset of R that carries all
of a solution mu.  Along one of them the multipliers of W stay >= 0 and the contacts of R outside W open.  Where
multipliers are not unique every corner of their set has its W.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.line import Line
from origami_nlp.continuation.tracer import ALIGNED, advance
from origami_nlp.kkt import State
from origami_nlp.numerics import (
    BALANCED,
    DEPENDENT,
    FOLLOWED,
    INDEPENDENT,
    INSIDE,
    RANK,
    STATIONARY,
)
from origami_nlp.problem import Contact

Piece = tuple[Contact, ...]
MOST_SETS = 128
"""Sets of held contacts that are tried at one state."""
TRIALS = (1e-2, 1e-3, 1e-5)
"""Steps after which a direction must still be an equilibrium: the later ones where an event follows soon."""
PULLS = -STATIONARY
"""A multiplier that is smaller, relative to the largest torque, pulls."""


@dataclass(frozen=True, eq=False)
class OneSidedBranch:
    """One direction in which equilibria go on.

    frame: the state with the tangent that leads there; a short step ahead where the contacts held are dependent at the
    state itself.  signed: whether the signs of the multipliers state how far it
    is one; where they are zero all along, or where nothing has to balance, only the verdict of `kkt.classify` does.
    split: whether several smooth pieces of what contacts allow meet all along it, each of which must balance.
    """

    frame: Equilibrium
    signed: bool
    split: bool = False

    def is_like(self, other: Equilibrium) -> bool:
        """Return whether it leads the way that `other` does."""
        return float(self.frame.tangent @ other.tangent) > ALIGNED


Branches = list[OneSidedBranch]


def find_one_sided_branches(line: Line, point: np.ndarray, verdict: str = "") -> Branches:
    """Return the half-branches of equilibria that leave the state (x, s); none where it is no equilibrium.

    verdict: what states are that no multipliers judge; none of those are followed where it is "".
    """
    state = State(line.at(float(point[-1])), point[:-1])
    if state.refused:
        return []
    out: list[OneSidedBranch] = []
    for piece in state.pieces:
        for hold in _holds(state, piece):
            for new in _along(line, point, hold, piece):
                along = new.frame.tangent
                same = [np.allclose(h.frame.tangent, along, atol=RANK, rtol=0) for h in out]
                if not any(same):
                    out.append(new)
                # of two that are the same states, the one that holds more contacts
                elif len(new.frame.hold) > len(out[k := same.index(True)].frame.hold):
                    out[k] = new
    if out or not verdict:
        return out
    return [*_frozen(line, point, _independent(state, state.pieces[0]))]


def _independent(state: State, rows: tuple[Contact, ...]) -> tuple[Contact, ...]:
    """Return contacts that are independent along what closure leaves free."""
    basis, chosen = np.zeros((0, state.kernel.shape[1])), []
    for contact, row in zip(rows, state.on(rows).slopes @ state.kernel, strict=True):
        left = row - basis.T @ (basis @ row)
        if np.linalg.norm(left) > RANK * max(1.0, float(np.linalg.norm(row))):
            basis = np.vstack([basis, left / np.linalg.norm(left)])
            chosen.append(contact)
    return tuple(chosen)


def _holds(state: State, piece: tuple[Contact, ...]) -> Iterator[tuple[Contact, ...]]:
    """Yield sets of independent contacts that can carry what the springs ask for, larger ones first."""
    held, m = state.on(piece), len(state.jacobian)
    found = held.multiplier_set
    size = 1.0 + float(np.abs(state.gradient).max())
    if found.residual > BALANCED * size:
        return
    # strictly active: every half-branch holds them; weakly active ones may open or press on, and are tried both ways
    must = [k for k in range(len(piece)) if found.unique and found.found[k] > BALANCED * size]
    optional = [k for k in range(len(piece)) if k not in must]
    # no more contacts than degrees of freedom: more would depend on each other
    most = state.kernel.shape[1]
    counts = range(min(len(optional), most - len(must)), -1, -1)
    sets = (some for count in counts for some in itertools.combinations(optional, count))
    for chosen in ((*must, *some) for some in itertools.islice(sets, MOST_SETS)):
        jacobian = np.vstack([state.jacobian, held.slopes[list(chosen)]])
        # rows of closure depend on each other: what counts is what they leave free
        rows = held.slopes[list(chosen)] @ state.kernel
        if np.linalg.svd(rows, compute_uv=False).min(initial=1.0) <= RANK:
            continue
        nu = np.linalg.lstsq(jacobian.T, state.gradient, rcond=DEPENDENT)[0]
        left = np.abs(state.gradient - jacobian.T @ nu).max()
        if left <= BALANCED * size and (nu[m:] >= -BALANCED * size).all():
            yield tuple(piece[k] for k in chosen)


def _along(line: Line, point: np.ndarray, hold: Piece, piece: Piece) -> Iterator[OneSidedBranch]:
    """Yield the directions in which the states that hold these contacts are equilibria."""
    curve = EquilibriumCurve(line, hold)
    system = curve.system(point)
    found = system.direction()
    if found is None:
        return
    others = tuple(c for c in piece if c not in hold)
    alike = system.seen.choices.alike(hold)
    alike = tuple(c for c in alike if not c.is_limit and c not in hold)
    rates = curve.opening_rates(system.problem, point, others)[1]
    first = line.problem.equation_count
    weak = system.multipliers[first:] <= BALANCED * system.size
    for sign in (1.0, -1.0):
        along, force = (sign * v for v in found)
        opening = rates @ along
        force = force[first:][weak]
        # complementarity along the curve: of a weak contact the multiplier may not fall where it is held, nor the
        # opening
        # where it is not
        if (force < -INDEPENDENT * system.size).any() or (opening < -INDEPENDENT).any():
            continue
        frame = Equilibrium(point, along, system)
        # a weak multiplier that stays zero to first order says nothing
        signed = not (np.abs(force) <= INDEPENDENT * system.size).any()
        curve.given[:] = [frame]  # a tangent near by spares a factorisation or two a step
        half = goes_on(curve, OneSidedBranch(frame, signed), others, alike)
        if half is not None:
            yield half


def _frozen(line: Line, point: np.ndarray, hold: tuple[Contact, ...]) -> Branches:
    """Return the directions in which a state that nothing moves keeps its verdict."""
    curve = EquilibriumCurve(line, hold)
    system = curve.system(point)
    found = system.direction()
    if found is None or system.free:
        return []
    return _both_ways(curve, Equilibrium(point, found[0], system), signed=False)


def one_sided_branches_at(curve: EquilibriumCurve, frame: Equilibrium) -> Branches:
    """Return the half-branches that leave a branching across the curve that comes there along `frame.tangent`."""
    across = frame.system.other_direction(frame.tangent)
    return _both_ways(curve, Equilibrium(frame.x, across, frame.system), signed=True)


def _both_ways(curve: EquilibriumCurve, at: Equilibrium, signed: bool) -> Branches:
    ways = (replace(at, tangent=sign * at.tangent) for sign in (1.0, -1.0))
    return [*filter(None, (goes_on(curve, OneSidedBranch(way, signed)) for way in ways))]


def goes_on(
    curve: EquilibriumCurve, half: OneSidedBranch, others: Piece = (), alike: Piece = ()
) -> OneSidedBranch | None:
    """Return the half-branch if a short step in this direction ends at an equilibrium; None if not.

    others: contacts of its piece that it does not hold.  One that a step passes to second order only, as where facets
    that lie on each other begin to overlap, is held too, from the end of that step on.  alike: contacts that say the
    same to first order as those that it holds, and may say more beyond.
    """
    for h in TRIALS:
        moved = advance(curve, half.frame, h)
        if moved is None or not is_equilibrium(moved[0]):
            continue
        frame = moved[0]
        held = _overlapping(curve, frame, others, alike)
        if held is None and any(frame.opening(c) < -FOLLOWED for c in others):
            return None
        frame = held or frame
        split = len(frame.seen.pieces) > 1
        if split and not balances(frame):
            if h == TRIALS[0]:
                continue
            return None  # nearer, what is lower is lost in rounding
        if half.signed or frame.judged.verdict == half.frame.judged.verdict:
            return OneSidedBranch(held or half.frame, half.signed or held is not None, split)
    return None


def _overlapping(
    curve: EquilibriumCurve, frame: Equilibrium, others: Piece, alike: Piece
) -> Equilibrium | None:
    """Return the equilibrium at the same parameter that holds more contacts, all of which push; None where none does.

    Signs of forces show what openings of third order in the step cannot: which contacts would be passed without them.
    """
    at_limit = tuple(c for c in (*others, *alike) if frame.opening(c) < FOLLOWED)
    hold = frame.hold
    for more in dict.fromkeys((at_limit, *((c,) for c in at_limit))):
        if not more or len(more) > frame.system.free:
            continue
        other = replace(curve, hold=(*hold, *more), known=[], given=[])
        found = other.at(frame.x, frame.s, frame.tangent)
        if found is None or found.system.least <= RANK or not is_equilibrium(found):
            continue
        pushes = (found.forces > BALANCED * found.system.size).all()
        if pushes and all(found.opening(c) > -FOLLOWED for c in others):
            return found
    return None


def balances(frame: Equilibrium) -> bool:
    """Return whether the springs balance on every smooth branch that contacts allow, not only on the one held."""
    state, pieces = frame.seen, frame.seen.pieces
    most = BALANCED * (1.0 + float(np.abs(state.gradient).max()))
    if len(pieces) == 1 or all(state.on(p).multiplier_set.residual <= most for p in pieces):
        return True
    return frame.judged.verdict != "not stationary"


def is_equilibrium(frame: Equilibrium) -> bool:
    """Return whether a point is admissible and all its contacts touch and push."""
    return pushes(frame) and not frame.seen.refused and touches(frame)


def pushes(frame: Equilibrium) -> bool:
    """Return whether no contact that is held pulls."""
    return not (frame.forces < PULLS * frame.system.size).any()


def touches(frame: Equilibrium) -> bool:
    """Return whether contacts held touch: a crease may lie in a facet's plane but beside it, or slip off a border."""
    return not any(margin(frame, c) <= 0.0 for c in frame.hold)


def margin(frame: Equilibrium, contact: Contact) -> float:
    """Return by how much features meet inside each other beyond `INSIDE`; inf where they meet at a border and touch."""
    if contact.is_limit:
        return math.inf
    inside = frame.problem.margin(contact, frame.state) - INSIDE
    if inside <= 0.0:
        found = frame.seen.contacts
        if contact in {*found.base, *(c for b in found.branches for option in b for c in option)}:
            return math.inf
    return inside
