"""Follow a contact boundary: the curve of closed states on which given contacts stay closed.

Arclength s is that of the space of all N fold angles (paper, paragraph "Metastability"): y = sqrt(multiplicity) x
for the model's variables x, |dy| = ds.  With C the Jacobian of closure and held contacts in y, t the unit tangent
(C t = 0) and H the Hessian of the Lagrangian whose multipliers balance the normal part of grad U,

    dU/ds = grad U . t,        d2U/ds2 = t . K t + grad U . y'' = t . H t,

because C y'' = -t . (Hessian of each constraint) t: the paper's effective tangential stiffness, without
differences.  Where more than one degree of freedom is left the curve is the geodesic of the contact-preserving
set that leaves the state in its softest direction; y'' is normal to that set and the formula stays exact.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.continuation.tracer import ContinuationOptions, End, Trace, trace
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State, Stratum, find_multipliers, project
from origami_nlp.numerics import BALANCED, FOLLOWED, NEAR_CONTACT, RANK
from origami_nlp.problem import Contact, Problem

STEPS = ContinuationOptions(1e-3, 0.04, 1e-10, turn=0.05, sharpest=0.15, most=10**6)
"""Such that energy and slope are smooth between points."""
REACH = 30.0
"""A curve is followed for this length [rad]: several times around the space of fold angles."""
NEWTON = 12
"""Steps of the corrector: from the predicted point it needs two to four."""


@dataclass(frozen=True)
class Point:
    """One point of a curve of states on which contacts stay closed.

    stratum: the state with the contacts held.  tangent, bend: y' and y'' [n], in the metric.
    dimension: of the set on which the contacts stay closed.
    """

    stratum: Stratum
    tangent: np.ndarray
    bend: np.ndarray
    dimension: int

    @property
    def x(self) -> np.ndarray:
        """The state in the problem's variables, [n]."""
        return self.stratum.state.x

    @property
    def slope(self) -> float:
        """dU/ds, scaled energy."""
        # paper, eq. 3.5
        return float(self.stratum.state.gradient @ self.tangent)

    @property
    def stiffness(self) -> float:
        """d2U/ds2, scaled energy."""
        # paper, eq. 3.6: the multipliers stand for grad U . y''
        return float(self.tangent @ self.stratum.hessian @ self.tangent)

    @property
    def springs(self) -> float:
        """t . K t alone, scaled energy."""
        p = self.stratum.state.problem
        # stiffness sums over the creases of a variable; y = sqrt(multiplicity) x divides by their number
        return float(self.tangent @ (p.parameters.stiffness / p.multiplicity * self.tangent))

    @cached_property
    def _forces(self) -> tuple[np.ndarray, bool]:
        held, state = self.stratum, self.stratum.state
        if np.linalg.svd(held.jacobian, compute_uv=False).min() > RANK:
            return held.forces, bool((held.forces > 0).all())
        # only what the contacts leave no motion to balance
        z, free = held.tangent, state.kernel
        across = state.gradient - z @ (z.T @ state.gradient)
        found = find_multipliers((held.slopes @ free).T, free.T @ across)
        size = 1.0 + float(np.abs(state.gradient).max())
        return found.smallest, found.residual <= BALANCED * size and bool((found.upper > 0).all())

    @property
    def multipliers(self) -> np.ndarray:
        """Lagrange multipliers of the contacts, scaled energy, those of smallest norm where they are dependent, [r]."""
        return self._forces[0]

    @property
    def pressed(self) -> bool:
        """Whether every held contact pushes."""
        return self._forces[1]


@dataclass(frozen=True, repr=False)
class BoundaryCurve(ShortRepr):
    """A followed contact boundary, in the scene's units.

    contacts: the contacts held closed.  s: arclength [m], 0 at the state or sample it was started from.
    states, fold_angles: in the problem's variables [m, n], all of them [m, N].
    energy, slope, stiffness: U, dU/ds, d2U/ds2 [m].  springs: t . K t, the part
    of the stiffness that the springs would have along a straight path; the rest is the bend of the boundary.
    multipliers: moment at each single contact, [m, contacts]; pressed: whether all contacts push, [m].
    start, end: why the curve ends there; both ``closed curve`` for a loop.
    dimension: of the set on which the contacts stay closed; above 1 only its softest direction is followed.
    """

    contacts: tuple[str, ...]
    rows: tuple[Contact, ...] = field(metadata={"plain": False})
    s: np.ndarray
    states: np.ndarray = field(metadata={"plain": False})
    fold_angles: np.ndarray
    energy: np.ndarray
    slope: np.ndarray
    stiffness: np.ndarray
    springs: np.ndarray
    multipliers: np.ndarray
    pressed: np.ndarray
    start: str
    end: str
    dimension: int

    @property
    def length(self) -> float:
        """Arclength [rad] in the space of all N fold angles."""
        return float(self.s[-1] - self.s[0])


@dataclass(frozen=True)
class HeldCurve:
    """The closed states of a problem on which contacts stay closed, as a curve to trace; see `tracer.CurveProblem`.

    Where the contacts leave a set of more dimensions, its geodesics.
    """

    problem: Problem
    contacts: tuple[Contact, ...]
    dimension: int

    @property
    def root(self) -> np.ndarray:
        """Metric of all N fold angles, [n]."""
        return self.problem.root

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        """Move x [n] onto closure and contacts."""
        state = correct(State(self.problem, x).on(self.contacts))
        return None if state is None else state.x

    def frame(self, x: np.ndarray, along: np.ndarray) -> Point | None:
        """Return the point at x; None where the set has another dimension, or goes across `along`."""
        point = evaluate(State(self.problem, x).on(self.contacts), along)
        return None if point is None or point.dimension != self.dimension else point


def correct(held: Stratum, steps: int = NEWTON) -> State | None:
    """Project a state onto closure with its contacts closed, in the metric; None if that takes more steps."""
    state = held.state
    x, residual = project(state.problem, state.x, held.contacts, steps=steps)
    return state.at(x) if residual <= FOLLOWED else None


def evaluate(held: Stratum, along: np.ndarray | None = None) -> Point | None:
    """Return the point of a boundary at a state; `along` [n] picks the tangent (default: the softest direction).

    Returns None where no motion keeps the contacts closed, or `along` is not near any.
    """
    z = held.tangent
    if z.shape[1] == 0:
        return None
    if along is None:
        # the softest direction of the set that keeps the contacts
        one = z.shape[1] == 1
        tangent = z[:, 0] if one else z @ np.linalg.eigh(z.T @ held.hessian @ z)[1][:, 0]
    else:
        tangent = z @ (z.T @ along)
        size = float(np.linalg.norm(tangent))
        if size < 0.5:
            return None
        tangent = tangent / size
    turning = np.array([_second(held, i, tangent) for i in range(len(held.jacobian))])
    # C y'' = -t' (Hess c) t; the solution of smallest norm is normal to the set: a geodesic
    bend = -np.linalg.lstsq(held.jacobian, turning, rcond=RANK)[0]
    return Point(held, tangent, bend, z.shape[1])


def _second(held: Stratum, i: int, along: np.ndarray) -> float:
    """Return the second derivative of constraint i (closure first, then contacts) along a direction in the metric."""
    if i >= (m := len(held.state.jacobian)) and held.contacts[i - m].is_limit:
        return 0.0
    one = -np.eye(len(held.jacobian))[i]
    p, step = held.state.problem, along / held.state.problem.root
    return float(step @ p.lagrangian_hessian(held.state.x, one, held.contacts, 0.0) @ step)


def trace_held(
    held: Stratum, steps: ContinuationOptions, ends: Any = (), dimension: int | None = None
) -> Trace[Point] | None:
    """Trace the boundary through a state both ways; None where no motion keeps the contacts closed.

    dimension: give up where the set on which the contacts stay closed has another one.
    """
    first = evaluate(held)
    if first is None or dimension not in (None, first.dimension):
        return None
    return trace(HeldCurve(held.state.problem, held.contacts, first.dimension), first, steps, ends)


def closing(held: Stratum) -> tuple[Contact, ...]:
    """Return the contacts besides the held ones that close where a curve ends."""
    found = State(held.state.problem, held.state.x, NEAR_CONTACT).contacts
    new = (*found.base, *(contact for options in found.branches for contact in options[0]))
    return tuple(c for c in dict.fromkeys(new) if c not in held.contacts)


CLOSES_ANOTHER = "another contact closes"
"""Why a curve ends where a state is refused; the names of what closes follow."""


def follow_boundary(held: Stratum, *, stop_at_release: bool = True) -> BoundaryCurve | None:
    """Follow the boundary through a state on which its contacts stay closed, both ways.

    A curve ends where another contact closes, where a held contact no longer pushes (unless
    `stop_at_release` is false), where it meets itself, where closure or contacts become singular, or after
    `REACH`.  None where no motion keeps the contacts closed.
    """
    problem = held.state.problem
    ends = [_while(lambda p: not problem.refuses(p.x), CLOSES_ANOTHER)]
    if stop_at_release and (first := evaluate(held)) is not None and first.pressed:
        ends.append(_while(lambda p: p.pressed, "the contact stops pushing"))
    found = trace_held(held, replace(STEPS, far=REACH), ends)
    if found is None:
        return None
    why = []
    for end, point in ((found.start, found.frames[0]), (found.end, found.frames[-1])):
        if end == CLOSES_ANOTHER:
            names = "; ".join(problem.name(contact) for contact in closing(point.stratum))
            end += f" ({names or 'facets meet'})"
        why.append(end)
    return boundary_of(held.contacts, found.frames, found.s, found.signs, why)


def _while(good: Callable[[Point], bool], why: str) -> End[Point]:
    """Return the end of a curve after the last point that is good."""
    return End(lambda points: sum(1 for _ in itertools.takewhile(good, points)), why)


def boundary_of(
    contacts: tuple[Contact, ...], points: Sequence[Point], s: np.ndarray, signs: Any, ends: Any
) -> BoundaryCurve:
    """Evaluate a boundary at points with arclength s [m]; signs: of their tangents against s, [m] or one."""
    problem = points[0].stratum.state.problem
    weights = np.array([problem.weight(contact) for contact in contacts])
    at = np.array([p.x for p in points])
    return BoundaryCurve(
        contacts=tuple(problem.name(contact) for contact in contacts),
        rows=contacts,
        s=s,
        states=at,
        fold_angles=problem.expand(at),
        energy=problem.energies(at),
        slope=problem.scale * signs * np.array([p.slope for p in points]),
        stiffness=problem.scale * np.array([p.stiffness for p in points]),
        springs=problem.scale * np.array([p.springs for p in points]),
        # moment at each single contact
        multipliers=problem.scale * np.array([p.multipliers for p in points]) / weights,
        pressed=np.array([p.pressed for p in points]),
        start=ends[0],
        end=ends[1],
        dimension=points[0].dimension,
    )
