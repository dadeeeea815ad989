"""How large a perturbation load a pinned state bears before one of its contacts opens.

A load is a moment m_i [N m] added to the torque of each crease: the energy becomes U - m . phi.  In the metric of
all N fold angles (y = sqrt(multiplicity) x for the model's variables x, so |y| is the 2-norm over all
creases, and likewise |f| of the load f) the loaded state with its contacts held solves

    grad U - f - J' lambda - A' mu = 0,   closure = 0,   rows = 0,

whose implicit derivative gives mu(f) = mu + D f to first order (the state moves along its contacts, which is part of
D).  Contact i opens first under f = -mu_i D_i / |D_i|^2, of norm mu_i / |D_i|: the margin is the smallest
of these, exact to first order.  It is then refined without linearisation: the load is relinearised at
the loaded state until it is parallel to D_i there and mu_i = 0 (the smallest such load, locally), and
its critical factor is found by re-solving along that direction.

The states keep the scene's symmetry, so the loads do too: creases of one orbit carry equal moments.  With
``symmetry = "none"`` the margin is over all loads.  The margin is that of multi-configuration
rigidity (paper, introduction: Dorn, Li, Pellegrino): below it the contacts stay closed.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from origami_nlp.display import shown
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State, Stratum, judge_branch, newton
from origami_nlp.numerics import BALANCED, CARRIES, DUPLICATE_TOL, INDEPENDENT, NONZERO, null_space
from origami_nlp.pattern import most_torque
from origami_nlp.problem import Problem

LEAST_DAMPING, SOFT = 1e-2, 1e-2
"""Share of a step at which the search for a critical load gives up, and of the stiffness without load that is soft."""
MOST_REFINEMENTS = 60
FARTHEST = 0.2
"""A re-solved state farther than this [rad] from where it was expected has jumped to another basin."""

Status = Literal["exact", "zero", "unbounded", "bound", "none"]
Ending = Literal["opens", "closes", "softens", "cap", "lost"]


@dataclass(frozen=True)
class CreaseMargin:
    """Largest moment on each crease of one orbit alone, in either direction [N m].

    Attributes
    ----------
    creases
        1-based.
    positive
        Towards valley; inf where no contact opens up to `LoadMargin.cap`.
    negative
        Towards mountain (given as a positive number); inf likewise.
    ends
        What happens at the two loads, see `LoadMargin.ends`.
    """

    creases: tuple[int, ...] = field(metadata=shown("creases", side="L"))
    positive: float = field(metadata=shown("towards valley", "N m", ".4g"))
    negative: float = field(metadata=shown("towards mountain", "N m", ".4g"))
    ends: tuple[Ending, Ending] = field(metadata=shown("ends", side="L"))


@dataclass(frozen=True, repr=False)
class LoadMargin(ShortRepr):
    """The load margin of one state.

    Attributes
    ----------
    status
        ``exact``: contacts with unique multipliers; `norm` is where one opens.  ``zero``: a closed contact
        carries nothing, so that arbitrarily small loads open it.  ``unbounded``: the contacts lock
        one another, no load balances by opening them.  ``bound``: dependent contacts, `norm` is
        the distance to the boundary of the cone of contact forces with the state held still.
        ``none``: not given, see `reason`.
    norm
        Largest 2-norm [N m] of a load over all N creases that the contacts bear, whatever its direction.
    first_order
        The same without refinement.
    moments
        The worst load [N m], N entries, of norm `norm`.
    opens
        The contact that opens, in words.
    ends
        What happens at `moments`, if there are any: ``opens``, or earlier than any opening another contact
        ``closes`` or the state ``softens`` (its tangential stiffness reaches zero); ``cap`` or ``lost`` (no Newton
        solution) where the search ended.
    creases
        Margins for loads on one orbit of creases alone.
    cap
        Loads on single orbits are tried up to this 2-norm [N m]: 2 pi times the sum of all stiffnesses.
    symmetry
        Group that the loads keep; ``none`` means that all loads are covered.
    reason
        Words on how the number came about, or why there is none.
    """

    status: Status
    norm: float = field(metadata=shown("norm", "N m", ".5g"))
    first_order: float = field(metadata=shown("first order", "N m", ".5g"))
    cap: float = field(metadata=shown())
    symmetry: str
    reason: str
    moments: tuple[float, ...] = ()
    opens: str = ""
    ends: Ending | None = None
    creases: tuple[CreaseMargin, ...] = ()

    def __str__(self) -> str:
        return f"{self.norm:.5g}" if math.isfinite(self.norm) else self.status


UNLOADED = "closed but carrying nothing: any load may open it"


def load_margin(state: State) -> LoadMargin:
    """Find the load margin of a minimum."""
    model, choices = state.problem, state.pieces
    if not state.few:
        return _nothing(model, "none", "too many pieces of the feasible set meet at the state")
    if choices == [()]:
        return _nothing(model, "none", "no contact is closed")
    judged = [judge_branch(state.on(rows)) for rows in choices]
    if any(b.multipliers.residual > BALANCED * (1 + np.abs(state.gradient).max()) for b in judged):
        return _nothing(model, "none", "no multipliers balance the springs on some piece")
    for b in judged:
        if not (b.regular and b.multipliers.unique):
            return _dependent(state.on(b.rows))
    pairs = (zip(b.rows, b.multipliers.smallest, strict=True) for b in judged)
    weak = {row: None for each in pairs for row, value in each if value <= CARRIES}
    if weak:
        return _nothing(model, "zero", UNLOADED, "; ".join(map(model.name, weak)))
    # where pieces of the feasible set meet, the state must stay a minimum on each of them
    pieces = [_regular(state.on(b.rows)) for b in judged]
    creases = (_smaller(each) for each in zip(*(p.creases for p in pieces), strict=True))
    return replace(min(pieces, key=lambda margin: margin.norm), creases=tuple(creases))


def _smaller(margins: Sequence[CreaseMargin]) -> CreaseMargin:
    """Combine the margins of one orbit over pieces of the feasible set."""
    up = min(margins, key=lambda m: m.positive)
    down = min(margins, key=lambda m: m.negative)
    return CreaseMargin(up.creases, up.positive, down.negative, (up.ends[0], down.ends[1]))


def _nothing(model: Problem, status: Status, reason: str, opens: str = "") -> LoadMargin:
    norm = {"zero": 0.0, "unbounded": math.inf}.get(status, math.nan)
    return LoadMargin(status, norm, norm, _cap(model), model.symmetry, reason, opens=opens)


def _cap(model: Problem) -> float:
    p = model.parameters
    laws = p.laws.made(model.scale) if p.laws else ()
    return most_torque((model.scale * p.stiffness).tolist(), laws)


def under_load(model: Problem, load: np.ndarray) -> Any:
    """The model with energy U - load . y, for a load [n] in the metric of all N fold angles, over `scale`."""
    # work is the same in both metrics: load . y = (root load) . x
    return model.loaded(model.root * load)


def moments_of(model: Problem, load: np.ndarray) -> tuple[float, ...]:
    """Moment [N m] on each of the N creases of a load in the metric."""
    return tuple(model.expand(model.scale * load / model.root).tolist())


def _regular(piece: Stratum) -> LoadMargin:
    model, cap = piece.state.problem, _cap(piece.state.problem)
    response, _ = piece.response()
    # mu_i + D_i . f = 0 is a plane of loads at the distance mu_i / |D_i|
    planes = piece.forces / np.maximum(np.linalg.norm(response, axis=1), NONZERO)
    # planes are first order: along the refined direction the load is raised until the state really ends
    ways = [_refine(piece, i, d) for i, d in enumerate(response)]
    ends = [_critical(piece, way, 4 * far) for way, far in zip(ways, planes.tolist(), strict=True)]
    first = min(range(len(ends)), key=lambda i: ends[i].load)
    load, ending, row = ends[first]
    creases = tuple(_orbit(piece, v, cap) for v in range(model.size))
    reason = "smallest load with a vanishing multiplier, found by re-solving under load"
    if ending != "opens":
        reason = f"the load path ends before a contact opens: {ending}"
    norm, plane = model.scale * load, model.scale * float(planes.min())
    moments, opens = moments_of(model, load * ways[first]), model.name(piece.contacts[row])
    about = norm, plane, cap, model.symmetry, reason, moments, opens
    return LoadMargin("exact", *about, ending, creases)


def _refine(piece: Stratum, i: int, response: np.ndarray) -> np.ndarray:
    """Return the unit direction of the smallest load at which multiplier i vanishes.

    Relinearises mu_i at the loaded state: f <- D_i (D_i . f - mu_i) / |D_i|^2, damped where the loaded
    state cannot be solved for.  Falls back on the first-order direction.
    """
    model, rows = piece.state.problem, piece.contacts
    d, mu = response, piece.forces[i]
    start = wanted = -mu * d / (d @ d)
    load, y, damping = np.zeros(model.size), piece.state.x, 1.0
    for _ in range(MOST_REFINEMENTS):
        trial = load + damping * (wanted - load)
        solved, _ = newton(loaded := under_load(model, trial), y, rows)
        if solved is None or not solved.converged:
            damping /= 2
            if damping < LEAST_DAMPING:
                break
            continue
        here = State(loaded, solved.x).on(rows)
        d, mu = here.response()[0][i], here.forces[i]
        step = float(np.linalg.norm(trial - load))
        load, y = trial, solved.x
        # foot of the normal from 0 to the plane mu + D . (f - load) = 0: at the fixed point f is parallel to D
        wanted = d * (d @ load - mu) / (d @ d)
        if step <= BALANCED * np.linalg.norm(load) and damping == 1.0:
            return load / np.linalg.norm(load)
        damping = min(1.0, 2 * damping) if step < 0.5 * np.linalg.norm(load) else damping
    return start / np.linalg.norm(start)


class _Event(NamedTuple):
    """First event along a load path: load (scaled), what happens, and to which row."""

    load: float
    ending: Ending
    row: int


def _critical(piece: Stratum, direction: np.ndarray, cap: float) -> _Event:
    """Follow the state under tau * direction from tau = 0 with `rows` held, to the first event.

    The load is bisected to 1e-8 relative.
    """
    model, rows = piece.state.problem, piece.contacts

    def look(tau: float, near: np.ndarray) -> tuple[np.ndarray, Ending | None, int] | None:
        loaded = under_load(model, tau * direction)
        solved, mu = newton(loaded, near, rows)
        if solved is None or not solved.converged or np.linalg.norm(solved.x - near) > FARTHEST:
            return None
        # the first of three ends: a contact pulls, the tangential stiffness is gone, another contact closes
        if mu.min() < 0:
            return solved.x, "opens", int(mu.argmin())
        if State(loaded, solved.x).on(rows).stiffness <= 0:
            return solved.x, "softens", 0
        return solved.x, "closes" if model.refuses(solved.x) else None, 0

    # invariant: nothing has happened up to `low`; what was seen beyond, or that Newton failed there, halves the step
    low, near, step, row = 0.0, piece.state.x, cap / 32, 0
    ending: Ending = "lost"
    while True:
        high = min(low + step, cap)
        found = look(high, near)
        if found is not None and found[1] is None:
            low, near = high, found[0]
            if low >= cap:
                return _Event(cap, "cap", 0)
            step *= 1.5
            continue
        if found is not None and found[1] is not None:
            ending, row = found[1], found[2]
        step /= 2
        if step <= DUPLICATE_TOL * high:
            break
    if ending == "lost":
        # Newton has no solution beyond a fold of the load path, where the stiffness vanishes
        left = State(under_load(model, low * direction), near).on(rows).stiffness
        ending = "softens" if left <= SOFT * piece.stiffness else "lost"
    return _Event(high, ending, row)


def _orbit(piece: Stratum, v: int, cap: float) -> CreaseMargin:
    """Return the margins for moments on the creases of variable v alone."""
    model = piece.state.problem
    unit = model.scale / math.sqrt(model.multiplicity[v])
    way = np.eye(model.size)[v]
    up, down = (_critical(piece, sign * way, cap / model.scale) for sign in (1, -1))
    most, least = (math.inf if e.ending == "cap" else float(unit * e.load) for e in (up, down))
    return CreaseMargin(model.creases_of(v), most, least, (up.ending, down.ending))


def _dependent(piece: Stratum) -> LoadMargin:
    """Margin where contacts are dependent: distance of the pull to the boundary of the cone of contact forces."""
    state, rows = piece.state, piece.contacts
    model, z = state.problem, state.kernel
    gradients = piece.slopes @ z  # in the tangent space of closure
    # the pull is balanced while it lies in the cone {A' mu: mu >= 0}; leaving that, some contact would have to pull
    found = distance_to_boundary(gradients.T, z.T @ state.gradient)
    names = "; ".join(map(model.name, rows))
    if found is None:
        why = "the contacts lock one another: no load that is normal to their common set opens one"
        return _nothing(model, "unbounded", why, names)
    distance, normal = found
    if distance <= CARRIES:
        return _nothing(model, "zero", UNLOADED, names)
    held = null_space(gradients).shape[1] == 0
    still = "the state is a corner and does not move" if held else "with the state held still"
    reason = f"dependent contacts: distance to the boundary of the cone of contact forces, {still}"
    norm, moments = float(model.scale * distance), moments_of(model, z @ normal * distance)
    about = norm, norm, _cap(model), model.symmetry, reason, moments, names
    return LoadMargin("bound", *about, "opens")


def distance_to_boundary(b: np.ndarray, c: np.ndarray) -> tuple[float, np.ndarray] | None:
    """Find the distance of c from the boundary of cone(b) = {b mu: mu >= 0} within its span.

    The cone is bounded by planes through its generators; each is found by enumeration (contacts are few).

    Parameters
    ----------
    b, c
        Generators [t, r] (contact gradients in the tangent space) and a point of the cone [t].

    Returns
    -------
    distance, direction
        c - distance * direction lies on the boundary, direction a unit vector [t]; or None where the cone is
        a linear space and has no boundary: the contacts lock one another.
    """
    length = np.linalg.norm(b, axis=0)
    g = b[:, length > INDEPENDENT] / length[length > INDEPENDENT]
    u, s, _ = np.linalg.svd(g, full_matrices=False)
    rank = int((s > INDEPENDENT).sum())
    if rank == 0:
        return None
    span = u[:, :rank]
    g, p = span.T @ g, span.T @ c
    best: tuple[float, np.ndarray] | None = None
    # a facet of the cone is spanned by rank - 1 of its generators, and has all others on one side
    for chosen in itertools.combinations(range(g.shape[1]), rank - 1):
        wall = g[:, list(chosen)]
        _, s, vt = np.linalg.svd(wall.T) if rank > 1 else (None, np.zeros(0), np.eye(1))
        if (s > INDEPENDENT).sum() < rank - 1:
            continue
        inward = vt[-1]
        for w in (inward, -inward):
            # w . p is the distance of p from that facet's plane, negative outside; the smallest over all facets counts
            if (w @ g >= -INDEPENDENT).all() and (best is None or w @ p < best[0]):
                best = (float(w @ p), span @ w)
    return best
