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

import math
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from origami_nlp.contact.force_cone import distance_to_boundary
from origami_nlp.display import shown
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import (
    Multipliers,
    State,
    Stratum,
    find_multipliers,
    judge_branch,
    newton,
    polish,
    project,
)
from origami_nlp.numerics import (
    BALANCED,
    CARRIES,
    CONTACT_TOL,
    DUPLICATE_TOL,
    NEAR_CONTACT,
    NONZERO,
    null_space,
)
from origami_nlp.pattern import most_torque
from origami_nlp.problem import Problem
from origami_nlp.search import descent_path, solve_with

LEAST_DAMPING, SOFT = 1e-2, 1e-2
"""Share of a step at which the search for a critical load gives up, and of the stiffness without load that is soft."""
ASIDE = 1e-3
"""The re-solves of a check use the critical load times 1 -+ this."""
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
    checked
        Whether re-solves at `moments` times 1 - 1e-3 and 1 + 1e-3 found the contact closed and loaded below, and open
        above.
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
    checked: bool = False

    def __str__(self) -> str:
        return f"{self.norm:.5g}" if math.isfinite(self.norm) else self.status


def load_margin(state: State, *, check: bool = True) -> LoadMargin:
    """Find the load margin of a minimum.

    Parameters
    ----------
    check
        Whether to re-solve just below and just above the critical load.
    """
    model = state.problem
    choices = state.pieces
    if not state.few:
        return _nothing(model, "none", "too many pieces of the feasible set meet at the state")
    if choices == [()]:
        return _nothing(model, "none", "no contact is closed")
    judged = [judge_branch(state.on(rows)) for rows in choices]
    if any(b.multipliers.residual > BALANCED * (1 + np.abs(state.gradient).max()) for b in judged):
        return _nothing(model, "none", "no multipliers balance the springs on some piece")
    dependent = [b for b in judged if not (b.regular and b.multipliers.unique)]
    if dependent:
        return _dependent(state.on(dependent[0].rows), check)
    weak = {
        row: None
        for b in judged
        for row, value in zip(b.rows, b.multipliers.smallest, strict=True)
        if value <= CARRIES
    }
    if weak:
        words = "; ".join(model.name(row) for row in weak)
        return _nothing(model, "zero", "closed but carrying nothing: any load may open it", words)
    # where pieces of the feasible set meet, the state must stay a minimum on each of them
    pieces = [_regular(state.on(b.rows), check) for b in judged]
    least = min(pieces, key=lambda margin: margin.norm)
    creases = tuple(_smaller([p.creases[v] for p in pieces]) for v in range(model.size))
    return replace(least, creases=creases)


def _smaller(margins: list[CreaseMargin]) -> CreaseMargin:
    """Combine the margins of one orbit over pieces of the feasible set."""
    up = min(margins, key=lambda m: m.positive)
    down = min(margins, key=lambda m: m.negative)
    return CreaseMargin(up.creases, up.positive, down.negative, (up.ends[0], down.ends[1]))


def _nothing(model: Problem, status: Status, reason: str, opens: str = "") -> LoadMargin:
    norm = {"zero": 0.0, "unbounded": math.inf}.get(status, math.nan)
    return LoadMargin(status, norm, norm, _cap(model), model.symmetry, reason, opens=opens)


def _cap(model: Problem) -> float:
    p = model.parameters
    if p.laws is None:
        return 2 * math.pi * model.scale * float(p.stiffness.sum())
    return most_torque((model.scale * p.stiffness).tolist(), p.laws.made(model.scale))


def under_load(model: Problem, load: np.ndarray) -> Any:
    """The model with energy U - load . y, for a load [n] in the metric of all N fold angles, over `scale`."""
    # work is the same in both metrics: load . y = (root load) . x
    return model.loaded(model.root * load)


def moments_of(model: Problem, load: np.ndarray) -> tuple[float, ...]:
    """Moment [N m] on each of the N creases of a load in the metric."""
    return tuple(model.expand(model.scale * load / model.root).tolist())


def _regular(piece: Stratum, check: bool) -> LoadMargin:
    model, rows = piece.state.problem, piece.contacts
    response, _ = piece.response()
    # mu_i + D_i . f = 0 is a plane of loads at the distance mu_i / |D_i|
    margins = piece.forces / np.maximum(np.linalg.norm(response, axis=1), NONZERO)
    best: tuple[float, np.ndarray, _Event] | None = None
    for i in range(len(rows)):
        # planes are first order: along the refined direction the load is raised until the state really ends
        direction = _refine(piece, i, response[i])
        event = _critical(piece, direction, 4 * float(margins[i]))
        if best is None or event.load < best[0]:
            best = (event.load, event.load * direction, event)
    assert best is not None
    _, load, event = best
    ending, i = event.ending, event.row
    cap = _cap(model)
    creases = tuple(_orbit(piece, v, cap) for v in range(model.size))
    checked = False
    if check and ending == "opens":
        (closed, pushes), (still_closed, _) = (
            _resolve(piece, event.state, i, share * load) for share in (1 - ASIDE, 1 + ASIDE)
        )
        checked = closed and pushes > 0 and not still_closed
    norm, first = (float(model.scale * v) for v in (np.linalg.norm(load), margins.min()))
    reason = "smallest load with a vanishing multiplier, found by re-solving under load"
    if ending != "opens":
        reason = f"the load path ends before a contact opens: {ending}"
    about = norm, first, cap, model.symmetry, reason, moments_of(model, load), model.name(rows[i])
    return LoadMargin("exact", *about, ending, creases, checked)


def _refine(piece: Stratum, i: int, response: np.ndarray) -> np.ndarray:
    """Return the unit direction of the smallest load at which multiplier i vanishes.

    Relinearises mu_i at the loaded state: f <- D_i (D_i . f - mu_i) / |D_i|^2, damped where the loaded
    state cannot be solved for.  Falls back on the first-order direction.
    """
    model, rows = piece.state.problem, piece.contacts
    d, mu = response, piece.forces[i]
    start = -mu * d / (d @ d)
    load, y, damping = np.zeros(model.size), piece.state.x, 1.0
    wanted = start
    for _ in range(MOST_REFINEMENTS):
        trial = load + damping * (wanted - load)
        loaded = under_load(model, trial)
        solved, _ = newton(loaded, y, rows)
        if solved is None or not solved.converged:
            damping /= 2
            if damping < LEAST_DAMPING:
                return start / np.linalg.norm(start)
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


@dataclass(frozen=True)
class _Event:
    """First event along a load path: load (scaled), what happens, to which row, and the state there."""

    load: float
    ending: Ending
    row: int
    state: np.ndarray


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
        return solved.x, None if not model.refuses(solved.x) else "closes", 0

    # invariant: nothing has happened up to `low`; what was seen beyond, or that Newton failed there, halves the step
    low, near, step = 0.0, piece.state.x, cap / 32
    ending: Ending = "lost"
    row = 0
    while True:
        high = min(low + step, cap)
        found = look(high, near)
        if found is not None and found[1] is None:
            low, near = high, found[0]
            if low >= cap:
                return _Event(cap, "cap", 0, near)
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
    return _Event(high, ending, row, near)


def _orbit(piece: Stratum, v: int, cap: float) -> CreaseMargin:
    """Return the margins for moments on the creases of variable v alone."""
    model = piece.state.problem
    root = math.sqrt(model.multiplicity[v])
    values, ends = [], []
    for sign in (1.0, -1.0):
        direction = np.zeros(model.size)
        direction[v] = sign
        event = _critical(piece, direction, cap / model.scale)
        tau = math.inf if event.ending == "cap" else event.load
        values.append(float(model.scale * tau / root))
        ends.append(event.ending)
    return CreaseMargin(model.creases_of(v), values[0], values[1], (ends[0], ends[1]))


def _resolve(piece: Stratum, near: np.ndarray, i: int, load: np.ndarray) -> tuple[bool, float]:
    """Solve the loaded scene from a state beside `near` with row i slightly open: is it closed, its multiplier.

    By IPOPT (and polish), or, where that jumps to another basin because the loaded state is shallow, by
    `search.descent_path`, which does not jump.
    """
    model, rows = piece.state.problem, piece.contacts
    loaded = under_load(model, load)
    _, jac = model.constraints(near, rows)
    wanted = np.zeros(len(jac))
    wanted[model.equation_count + i] = NEAR_CONTACT
    start = near + np.linalg.lstsq(jac, wanted, rcond=None)[0]
    start, _ = project(model, start, tuple(row for row in rows if row != rows[i]))
    dead = loaded.parameters.dead is not None  # forces in space have no symbols
    y = start if dead else polish(loaded, *solve_with(loaded, start, rows)[:2]).x
    if (dead or np.linalg.norm(y - near) > FARTHEST) and not model.refuses(start):
        y = descent_path(loaded, start).end
    there = State(loaded, y).on(rows)
    # on another piece of the feasible set it opens to the other side
    closed = abs(float(there.openings[i])) <= CONTACT_TOL
    # another row may have described the same touch: read it as row i
    return closed, float(there.forces[i]) if closed else 0.0


def _dependent(piece: Stratum, check: bool) -> LoadMargin:
    """Margin where contacts are dependent: distance of the pull to the boundary of the cone of contact forces."""
    state, rows = piece.state, piece.contacts
    model, z, pull = state.problem, state.kernel, state.gradient
    gradients = piece.slopes @ z  # in the tangent space of closure
    # the pull is balanced while it lies in the cone {A' mu: mu >= 0}; leaving that, some contact would have to pull
    found = distance_to_boundary(gradients.T, z.T @ pull)
    names = "; ".join(model.name(row) for row in rows)
    if found is None:
        return _nothing(
            model,
            "unbounded",
            "the contacts lock one another: their forces balance every load that is normal to the "
            "set on which all stay closed; other loads move the state along that set",
            names,
        )
    distance, normal = found
    load = z @ normal * distance

    def balanced(factor: float) -> Multipliers:
        return find_multipliers(gradients.T, z.T @ (pull - factor * load))

    size = CARRIES * (1 + float(np.abs(pull).max()))
    checked = False
    if check:
        below, above = balanced(1 - ASIDE), balanced(1 + ASIDE)
        checked = below.residual <= size < above.residual
    held = null_space(gradients).shape[1] == 0
    still = "the state is a corner and does not move" if held else "with the state held still"
    reason = f"dependent contacts: distance to the boundary of the cone of contact forces, {still}"
    norm = float(model.scale * distance)
    about = norm, norm, _cap(model), model.symmetry, reason, moments_of(model, load), names
    return LoadMargin("bound", *about, "opens", (), checked)
