"""Dry friction at hinges: each stable state becomes a region of states that stay where they are.

With friction torques |f_i| <= T_i at the hinges a state rests where closure, contacts and friction balance the torque:

    grad U + f = J' lambda + A' mu,   mu >= 0.

Near a minimum with its loaded contacts held the states that some f balances are, to first order, x + C f, and the
contacts carry mu + D f (C and D the responses of the KKT system to a load).  How far a fold angle reaches is then a
linear program over the box of f: with no contact held it is sum_j |C_ij| T_j in closed form.  Along one degree of
freedom the region is followed exactly: with t the tangent of the closed states, some f balances while

    |dU/ds| <= sum_j T_j |t_j|.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type, check_whole
from origami_nlp.continuation import (
    ContinuationOptions,
    End,
    HeldCurve,
    Point,
    evaluate,
    trace_ahead,
)
from origami_nlp.friction.result import Friction, FrictionMode, FrictionRegion
from origami_nlp.kkt import State, Stratum
from origami_nlp.minima import JudgedState, MinimaResult, full_scene
from origami_nlp.modes import loaded_stratum
from origami_nlp.numerics import ROUNDED, bracketed_roots, first_largest
from origami_nlp.pattern import read_torque_bounds
from origami_nlp.pattern_problem import MOST_DENSE
from origami_nlp.problem import Model

STEPS = ContinuationOptions(first=1e-3, longest=0.04, shortest=1e-10, turn=0.05, sharpest=0.15)
"""Of the curve of closed states, such that its slope is smooth between points."""
FRICTION, RELEASES, MEETS = "friction is overcome", "a contact stops pushing", "a contact closes"
"""What ends a region that is followed."""


def find_friction(
    result: MinimaResult,
    torque: float | Sequence[float | None] | Mapping[int, float],
    *,
    state: int | None = None,
) -> Friction:
    """Find the states around each minimum that dry friction at the hinges holds.

    Parameters
    ----------
    result
        Of `find_minima`, for a vertex or a pattern.
    torque
        Largest friction torque [N m]: of all creases, of each (None: no friction), or of some by number (1-based).
    state
        Number (1-based) of the only minimum to look at.

    Returns
    -------
    Friction
        Of each minimum: how far each fold angle and each mode reaches, to first order, in the space of all N fold
        angles with loaded contacts held; with one degree of freedom also exactly: followed to where friction is
        overcome.

    Raises
    ------
    OptionError
        If an argument is not what it must be, or there is no minimum of that number.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.pattern("miura", 2, 2).with_springs(1.0, 0.8))
    >>> region = o.find_friction(result, 0.05).regions[0]
    >>> len(region.modes), region.exact is not None
    (1, True)
    """
    check_type("result", result, MinimaResult)
    if state is not None:
        check_whole("state", state, 1, max(len(result.minima), 1))
    problem = result.model if result.is_pattern else Model(full_scene(result.scene))
    creases = len(problem.expand(np.zeros(problem.size)))
    bounds = read_torque_bounds(torque, creases, "torque")
    most = np.where(np.isfinite(bounds), bounds, 0.0)
    regions = [
        region_of(State(problem, np.array(minimum.fold_angles)), most, number, minimum)
        for number, minimum in enumerate(result.minima, start=1)
        if state in (None, number)
    ]
    return Friction(result, tuple(most.tolist()), tuple(regions))


def region_of(state: State, most: np.ndarray, number: int, minimum: JudgedState) -> FrictionRegion:
    """Return the region of one minimum, of all N fold angles; most: friction torques [N]."""
    none = FrictionRegion(number, minimum, (), (), (), (), None, "")
    if state.problem.sparse:
        return none.because(
            f"a pattern of more than {MOST_DENSE} creases is too large for its Hessian"
        )
    held, why = loaded_stratum(state)
    if held is None:
        return none.because(why)
    names = tuple(state.problem.name(c) for c in held.contacts)
    z = held.tangent
    phi = np.array(minimum.fold_angles)
    if not z.shape[1]:
        still = tuple(phi.tolist())
        return FrictionRegion(number, minimum, names, still, still, (), None, "")
    values, vectors = np.linalg.eigh(z.T @ held.hessian @ z)
    if values[0] <= ROUNDED * values[-1]:
        return none.because("to first order nothing holds a motion: its stiffness is zero")
    forces, states = held.response()
    share = most / state.problem.scale  # energies and torques of the problem are over its scale
    low, high = _reach(states, forces, held, share)
    modes = []
    for value, d in zip(values, (z @ vectors).T, strict=True):
        d = d * np.sign(d[first_largest(np.abs(d))])
        a, b = _reach((d @ states)[None], forces, held, share)
        modes.append(FrictionMode(float(value * state.problem.scale), d, float(a[0]), float(b[0])))
    exact = _followed(held, share) if z.shape[1] == 1 else None
    ends = tuple((phi + low).tolist()), tuple((phi + high).tolist())
    return FrictionRegion(number, minimum, names, *ends, tuple(modes), exact, "")


def _reach(
    rows: np.ndarray, forces: np.ndarray, held: Stratum, share: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the largest of rows [r, N] f over |f| <= share with contacts that push on, [r] each."""
    widest = np.abs(rows) @ share
    # contacts that no f in the box takes off do not matter
    taken = held.forces - np.abs(forces) @ share < 0 if len(forces) else np.zeros(0, bool)
    if not taken.any():
        return -widest, widest
    from scipy.optimize import linprog  # heavy: where contacts are held alone

    box = np.stack([-share, share], axis=1)
    out = np.zeros((2, len(rows)))
    for k, row in enumerate(rows):
        for side, sign in enumerate((1.0, -1.0)):
            found = linprog(
                sign * row, -forces[taken], held.forces[taken], bounds=box, method="highs"
            )
            out[side, k] = sign * found.fun
    return out[0], out[1]


def _followed(held: Stratum, share: np.ndarray) -> tuple[tuple[Any, str], tuple[Any, str]] | None:
    """Follow closed states to where friction is overcome, both ways: fold angles and why, None where none goes on."""
    problem, first = held.state.problem, evaluate(held)
    if first is None:
        return None
    curve = HeldCurve(problem, held.contacts, 1)

    def room(p: Point) -> float:
        return float(share @ np.abs(p.tangent)) - abs(p.slope)

    out = []

    def before(points: Sequence[Point], good: Callable[[Point], bool]) -> int:
        return next((k for k, p in enumerate(points) if not good(p)), len(points))

    def meet(a: Point, b: Point) -> Point | None:
        """Return where friction is overcome between a and b."""
        chord = float(a.tangent @ (problem.root * (b.x - a.x)))

        def beside(h: float) -> Point | None:
            x = curve.correct(a.x + h * a.tangent / problem.root)
            return None if x is None else curve.frame(x, a.tangent)

        def at(h: np.ndarray) -> np.ndarray:
            point = beside(float(h[0]))
            return np.array([np.nan if point is None else room(point)])

        return beside(float(bracketed_roots(at, [0.0], [chord])[0]))

    for along in (first.tangent, -first.tangent):
        begun = curve.frame(first.x, along)
        if begun is None:
            return None
        ends = [
            End[Point](lambda ps: before(ps, lambda p: not problem.refuses(p.x)), MEETS),
            End[Point](lambda ps: before(ps, lambda p: p.pressed), RELEASES),
            End[Point](lambda ps: before(ps, lambda p: room(p) >= 0), FRICTION, meet),
        ]
        frames, _, why = trace_ahead(curve, begun, STEPS, ends)
        end = frames[-1] if frames else begun
        out.append((tuple((problem.expand(end.x) + 0.0).tolist()), why))
    return out[1], out[0]
