"""What a polished state is: which kind of minimum, with which certificate, or why it is not one."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.kkt.certificates import BY_SECOND_ORDER, BranchJudgement, judge_branch
from origami_nlp.kkt.contact_forces import ContactForce, forces_of, joined_forces
from origami_nlp.kkt.descent_witness import (
    DescentWitness,
    follow_descent,
    follow_level,
    follow_lines,
)
from origami_nlp.kkt.large import judge_large, lower_beside
from origami_nlp.kkt.neighbourhood import (
    RADII,
    dimension_nearby,
    sample_neighbourhood,
    tangent_is_feasible,
)
from origami_nlp.kkt.singular_beside import not_told_apart
from origami_nlp.kkt.splitting import judge_by_splitting
from origami_nlp.kkt.state import State
from origami_nlp.numerics import CLOSURE_TOL, LEVEL, SETTLED, STATIONARY, UNPOLISHED

AT_REST = CLOSURE_TOL**2
"""Energy over the mean stiffness [rad^2] of springs at rest to rounding of their fold angles."""
MOST_EQUATIONS = 6
"""Of closure up to which small spheres are searched: of larger problems some tens of directions say nothing."""
Verdict: TypeAlias = Literal["minimum", "saddle", "not stationary", "not admissible", "undecided"]
Kind: TypeAlias = Literal["interior", "contact-pinned", "contact-touching", "degenerate"]


@dataclass(frozen=True, repr=False)
class Classification(ShortRepr):
    """The decision on a state.

    Attributes
    ----------
    verdict
        ``minimum``, ``saddle``, ``not stationary``, ``not admissible`` or ``undecided``.
    kind
        For minima ``interior`` (no active constraint), ``contact-pinned``, ``contact-touching`` (strict complementarity
        fails: an active constraint has multiplier zero) or ``degenerate``; else None.
    reason
        The certificate of a minimum, or why it is not one.
    local_dimension
        Dimension of the feasible set at the state: the model's degrees of freedom where it is full, 1 on a handle, 0 if
        isolated.
    contacts
        Closed contacts with their multipliers.
    eigenvalues
        Of the reduced Hessian (tangential stiffness), scene's units.
    stationarity
        Residual of the best multipliers (scaled energy).
    descent
        For a saddle, a unit direction of descent [n] in the model's variables.
    lower
        A lower admissible state [n] that was found near it; None where there is none, or none was needed.
    mode
        Of a minimum, the unit eigenvector (in the metric of all fold angles) of the smallest of `eigenvalues`, as a
        direction [n] in the model's variables, its largest entry positive; None where it is not one.
    """

    verdict: Verdict
    kind: Kind | None
    reason: str
    local_dimension: int
    contacts: tuple[ContactForce, ...] = ()
    eigenvalues: tuple[float, ...] = ()
    stationarity: float = math.nan
    descent: np.ndarray | None = None
    lower: np.ndarray | None = None
    mode: np.ndarray | None = None


def classify(state: State, *, polished: bool = True) -> Classification:
    """Classify a closed state.

    `polished` says whether it is exact to rounding; if not, IPOPT's accuracy is assumed, nothing finer is read, and
    what looks like a minimum is undecided: next to a singular set any state seems to balance.

    Parameters
    ----------
    state
        The state; contacts closed to its `tolerance` are taken as closed.
    polished
        Whether Newton took it to rounding.

    Returns
    -------
    Classification
        The verdict with its certificate, contacts with multipliers, and a direction of descent where there is one.

    Examples
    --------
    >>> from origami_nlp import State, classify, examples, pose
    >>> scene = examples.degree6("pi/3", ratio=1)
    >>> classify(State(pose(scene), scene.rest_angles[:4])).verdict
    'not admissible'
    """
    if not polished:
        state = State(state.problem, state.x, UNPOLISHED)
    what = _decide(state, STATIONARY if polished else UNPOLISHED)
    if what.verdict == "minimum" and not polished:
        return Classification("undecided", None, f"not polished; {what.reason}", 0)
    if what.verdict == "minimum" and (why := not_told_apart(state.problem, state.x)):
        return replace(what, verdict="undecided", kind=None, reason=why)
    return what


def classified(problem: Any, x: np.ndarray) -> Classification:
    """Return what is decided on a closed state [n] of a problem; kept, as a descent asks before its end is judged."""
    what: Classification = problem.kept("classified", x, lambda: classify(State(problem, x)))
    return what


def _decide(state: State, accuracy: float) -> Classification:
    """Decide on a state, taking at their word the numbers of one that is not polished."""

    def reject(verdict: Verdict, why: str, descent: np.ndarray | None = None) -> Classification:
        return Classification(verdict, None, why, 0, descent=descent)

    model = state.problem
    if state.refused:
        doubt = model.doubt(state.x)
        return reject("undecided" if doubt else "not admissible", doubt or state.refused)
    if model.sparse:
        return _decide_large(state)
    lower = follow_level(state)
    if lower is not None:
        return _refuted(lower)
    contacts = state.contacts
    if contacts.branches or not contacts.complete:
        judged, failed = judge_by_splitting(state, accuracy)
        if isinstance(judged, DescentWitness):
            return _refuted(judged)
        return _by_search(state, failed) if failed else _of_larger(state, judged)
    one = judge_branch(state.on(contacts.base), accuracy)
    # where closure keeps its rank and no contact is closed, closed states are a manifold that nothing bounds
    real = one.tangent is not None and (
        (one.regular and not one.rows) or tangent_is_feasible(state, one.tangent, one.held)
    )
    if not real and one.verdict != "minimum":
        # the set that the linearised contacts allow is not followed by states: isolated, or beyond first order
        return _by_search(state, [one])
    if one.verdict in ("saddle", "not stationary"):
        d, missing = one.direction, one.multipliers.residual
        d = None if d is None or not d.any() else d / np.linalg.norm(d)
        return Classification(
            one.verdict, None, one.certificate, 0, stationarity=missing, descent=d
        )
    if one.verdict == "undecided":
        return _by_search(state, [one])
    dimension = one.cone_dimension if real else 0
    if real and not state.regular:
        if _is_isolated(state):
            return _isolated(state, one, BY_SECOND_ORDER)
        dimension = dimension_nearby(state, contacts.base)
    return Classification(
        "minimum",
        _kind([one]),
        one.certificate,
        dimension,
        forces_of(state, one),
        tuple((model.scale * one.eigenvalues).tolist()),
        # nothing has to balance where closure itself leaves no way down
        math.nan if one.level == 5 else one.multipliers.residual,
        mode=_softest_mode(one, model.root),
    )


def _softest_mode(branch: BranchJudgement, root: np.ndarray) -> np.ndarray | None:
    """Return the mode of the smallest eigenvalue, where it is alone: of two that agree, rounding would turn it."""
    values = branch.eigenvalues
    if not branch.modes.size or (len(values) > 1 and values[1] - values[0] <= SETTLED * values[-1]):
        return None
    mode: np.ndarray = branch.modes[:, 0]
    large = np.flatnonzero(np.abs(mode) >= (1 - SETTLED) * np.abs(mode).max())
    return mode * math.copysign(1.0, mode[large[0]]) / root


def _decide_large(state: State) -> Classification:
    """Decide on a state of a problem that is too large for kernels."""
    for branch in judge_large(state):
        if branch.verdict == "minimum":
            return _of_larger(state, [branch])
        lower = lower_beside(state, branch)
        if lower is not None:
            return _refuted(lower)
    return Classification("undecided", None, f"not decided: {branch.certificate}", 0)


def _of_larger(state: State, judged: list[BranchJudgement]) -> Classification:
    """Return the classification of a minimum of sets that hold all states beside it, and more."""
    doubt = state.problem.doubt(state.x)
    if doubt:
        return Classification("undecided", None, f"not decided: {doubt}", 0)
    if not state.problem.sparse and _is_isolated(state):
        return _isolated(state, judged[0], BY_SECOND_ORDER)
    words = "; ".join(dict.fromkeys(b.certificate for b in judged))
    return Classification(
        "minimum",
        _kind(judged),
        words + (_of_branches(len(judged)) if len(judged) > 1 else ""),
        max(b.cone_dimension for b in judged),
        joined_forces(state, [forces_of(state, b) for b in judged]),
        tuple((state.problem.scale * judged[0].eigenvalues).tolist()),
        math.nan if judged[0].level == 5 else judged[0].multipliers.residual,
    )


def _refuted(lower: DescentWitness) -> Classification:
    """Return the classification of a state with a lower admissible state next to it."""
    return Classification(
        "not stationary", None, lower.words, 0, descent=lower.direction, lower=lower.state
    )


def _is_isolated(state: State) -> bool:
    """Return whether contacts close every direction that closure leaves to second order."""
    if state.regular:
        return False
    cone, contacts = state.tangent_cone, state.contacts
    # pieces hold all states beside this one, and perhaps more
    pieces = state.pieces if state.few else [contacts.base]
    return not cone.reason and all(cone.is_point(state.on(rows).slopes) for rows in pieces)


def _isolated(state: State, branch: BranchJudgement, reason: str) -> Classification:
    """Return the classification of an isolated point: a minimum, since it has no neighbours."""
    forces = forces_of(state, branch)
    # nothing has to balance at a point that cannot move: no stationarity residual
    return Classification("minimum", "degenerate", reason, 0, forces)


def _of_branches(count: int) -> str:
    return f" (on each of the {count} pieces of the feasible set that meet here)"


def _kind(branches: list[BranchJudgement]) -> Kind:
    if any(not b.regular or not b.multipliers.unique or b.held for b in branches):
        return "degenerate"
    if all(not b.rows for b in branches):
        return "interior"
    # strict complementarity (Nocedal & Wright, definition 12.5)
    loaded = all((b.multipliers.smallest > 0).all() for b in branches)
    return "contact-pinned" if loaded else "contact-touching"


def _by_search(state: State, judged: list[BranchJudgement]) -> Classification:
    """Refute a singular state by a lower neighbour on small spheres around it; without one it is undecided."""
    model = state.problem
    if model.excess(state.x) <= AT_REST:
        return Classification(
            "minimum",
            "degenerate",
            "at rest: no state has less energy",
            dimension_nearby(state, state.contacts.base),
            forces_of(state, judged[0]),
            stationarity=0.0,
        )
    # where contacts are split, or incomplete, directions of descent were followed before
    exact = state.contacts.complete and not state.contacts.branches
    lower = follow_descent(state, judged[0]) if exact else None
    lower = lower or follow_lines(state)
    if lower is not None:
        return _refuted(lower)
    if not exact or model.equation_count > MOST_EQUATIONS:
        return _not_decided(judged)
    rows = tuple(dict.fromkeys(row for b in judged for row in b.rows))
    found = sample_neighbourhood(state, rows)
    noise = LEVEL * max(abs(state.energy), model.scale)
    where = f"small spheres, radii {min(RADII):g} to {max(RADII):g}, {found.tried} closed states"
    if found.state is not None and found.lowest < -noise:
        return Classification(
            "not stationary",
            None,
            f"{where}: a neighbour is lower by {-found.lowest:.2e}",
            found.dimension,
        )
    if found.state is None:
        reason = "no certificate; no admissible neighbour found on small spheres"
    else:
        reason = f"no certificate; {where}, none admissible and lower"
    return Classification("undecided", None, reason, found.dimension)


def _not_decided(judged: list[BranchJudgement]) -> Classification:
    words = "; ".join(dict.fromkeys(b.certificate for b in judged))
    missing = min(b.multipliers.residual for b in judged)
    reason = f"not decided: {words}, no lower state found"
    return Classification("undecided", None, reason, 0, stationarity=missing)
