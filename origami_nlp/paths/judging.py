"""What a followed state is: its kind on an arc, and its whole record at one value of the parameter."""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.contact import breaking_stiffnesses
from origami_nlp.continuation import (
    BifurcationDiagram,
    BranchSegment,
    Equilibrium,
    GeometryLine,
    Hold,
    ParameterLine,
)
from origami_nlp.kkt import State, classify
from origami_nlp.numerics import CONTACT_TOL, SETTLED, rank
from origami_nlp.paths.records import PathBranch, StateAt
from origami_nlp.pattern import Scene
from origami_nlp.problem import Contact

BISECTIONS = 40
"""Of a part of an arc on which the verdict changes."""


Touching = dict[Hold, tuple[tuple[Contact, ...], ...]]


class JudgedSegment(NamedTuple):
    """A part of an arc: positions of its first and last frame, and what its states are."""

    first: int
    last: int
    kind: str
    certificate: str


def parts_of(arc: BranchSegment, ends: bool = True) -> list[JudgedSegment]:
    """Return what the states of an arc are, judged in the middle, and beside its `ends` too by default."""
    last = len(arc.frames) - 1
    if arc.index:
        return [JudgedSegment(0, last, "saddle", "")]
    inner = sorted({min(1, last), last // 2, max(last - 1, 0)})
    if last == 1 or not ends:
        inner = [arc.middle]
    known = {k: _judged(arc.frames[k]) for k in inner}
    cuts = [0]
    for a, b in itertools.pairwise(inner):
        if known[a][0] == known[b][0]:
            continue
        low, high = a, b
        while high - low > 1:
            middle = (low + high) // 2
            known[middle] = _judged(arc.frames[middle])
            # one change between a and b is assumed; events, where kinds change as a rule, cut arcs already
            low, high = (middle, high) if known[middle][0] == known[a][0] else (low, middle)
        cuts.append(high)
    out = []
    for first, end in zip(cuts, [*cuts[1:], last], strict=True):
        # the judged frame nearest to the middle of the part
        k = min((k for k in known if first <= k <= end), key=lambda k: abs(2 * k - first - end))
        out.append(JudgedSegment(first, end, *known[k]))
    return out


def _judged(frame: Equilibrium) -> tuple[str, str]:
    what = frame.judged
    return (what.kind or what.verdict, what.reason)


def breaking_eigenvalue(
    frame: Equilibrium, line: ParameterLine | GeometryLine, scene: Scene, touching: Touching
) -> float:
    """Return the smallest stiffness across the symmetry, in the space without it, with loaded contacts held.

    nan where there is no one Hessian; inf where nothing breaks the symmetry and keeps the contacts.  touching: what
    closes in that space where contacts are held, as far as it is known.
    """
    full = State(line.at(frame.s), frame.problem.expand(frame.state))
    pieces = touching.get(frame.hold, ((),) if not frame.hold.contacts else None)
    # what closed together at another state of these contacts, and is closed here, leaves the same pieces
    closed = tuple(dict.fromkeys(c for piece in pieces or () for c in piece))
    open_now = closed and np.abs(full.local.openings(closed)[0]).max() > CONTACT_TOL
    if pieces is None or open_now:
        pieces = touching[frame.hold] = tuple(full.pieces)
    found = breaking_stiffnesses(full, scene, pieces[0]) if len(pieces) == 1 else (math.nan,)
    return min(found, default=math.inf)


def states_at(
    model: Any,
    value: float,
    s: float,
    web: BifurcationDiagram,
    branches: tuple[PathBranch, ...],
    branch_of_arc: dict[int, int],
) -> tuple[StateAt, ...]:
    """Return the states of all branches at one value t = value of the parameter, where s is followed."""
    out: list[tuple[np.ndarray, StateAt]] = []
    for number, frame in (*web.states_at(s), *((-1, f) for f in web.alone_at(s))):
        if any(np.abs(x - frame.state).max() <= SETTLED for x, _ in out):
            continue  # two arcs that meet there
        state = State(model, frame.state)
        what = classify(state)
        branch = branch_of_arc.get(number, 0)
        stable = what.verdict == "minimum"
        found = StateAt(
            branch,
            tuple(state.fold_angles.tolist()),
            state.energy,
            what.verdict,
            what.kind,
            what.reason,
            what.local_dimension,
            what.contacts,
            model.scale * float(frame.eigenvalues[0]) if len(frame.eigenvalues) else math.nan,
            frame.system.residual,
            state.residual,
            _stays(branches[branch - 1] if branch else None, value) if stable else None,
        )
        out.append((frame.state, found))
    # ties (mirror images of one another) in a fixed order
    return tuple(
        sorted((s for _, s in out), key=lambda s: rank(s.energy / model.scale, s.fold_angles))
    )


def _stays(branch: PathBranch | None, value: float) -> tuple[float, float] | None:
    """Return the range over which a minimum of a branch can be followed from a value without losing stability."""
    if branch is None:
        return value, value
    parts = branch.kind_ranges
    here = [k for k, r in enumerate(parts) if r.stable and r.low <= value <= r.high]
    if not here:
        return None
    first = last = here[0]
    while first > 0 and parts[first - 1].stable:
        first -= 1
    while last + 1 < len(parts) and parts[last + 1].stable:
        last += 1
    ends = [t for r in parts[first : last + 1] for t in r.t]
    return min(ends), max(ends)
