"""The springs that hold given states with the largest margin, or the proof that there are none.

Everything is divided by the mean stiffness, which is an unknown of its own (its inverse, `Springs.scale`), so that
bounds and energies in the scene's units stay linear.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.equilibrium import Balance, SpringRows, Springs, bounded
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.kkt import State
from origami_nlp.numerics import (
    DESIGN_ACTIVE,
    DESIGN_MARGIN,
    EQUAL,
    POSITIVE,
    ROUNDED,
    ConeRows,
    ConicProgram,
    ConicSolution,
)
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.problem import Contact

MOVED = 1e4 * DESIGN_ACTIVE
"""Largest change that closes equations and active bounds, over the mean stiffness: `DESIGN_ACTIVE` times the worst
condition 1e4 of the equations (see `DESIGN_MARGIN`); more is another design."""
ROOM = 2.0
"""Bounds of moments come of a least singular value in floating point, which is good to far more than this factor."""
LARGEST_MARGIN = 10.0
"""Cap on t: where nothing else bounds it (wound springs on a flat-folded state), more is of no use."""
MOST_PIECES = 16
"""Smooth pieces of the feasible set at one state, each with conditions of its own."""
MOST_CHOICES = 64
"""Choices of contacts that touch."""


class ConvexDesign:
    """The convex program of a question.

    Parameters
    ----------
    targets
        The question.
    touching
        Contacts without which states are to be in equilibrium, each with the number of its state from 0.
    loose
        Ask only for what every minimum fulfils: whichever of its contacts press (see `Balance`), and of singular states
        nothing.  Where that has no answer, no springs hold the states.
    more
        Further rows over the springs and the margin, see `Springs`.
    """

    def __init__(
        self,
        targets: Targets,
        touching: frozenset[tuple[int, Contact]] = frozenset(),
        more: Sequence[ConeRows] = (),
        loose: bool = False,
    ) -> None:
        self.targets, self.touching, self.loose = targets, touching, loose
        self.every_refuted = False
        kinds = int(targets.kinds.max()) + 1
        self.places = Springs.of(kinds)
        self.problem = ConicProgram(self.places.size)
        self.count = np.bincount(targets.kinds, minlength=kinds)
        self.balances: list[tuple[int, Balance, slice]] = []
        self._bounds(kinds)
        for i, placed in enumerate(targets.placed):
            self._hold(i, placed.target.margin, placed.target.name)
        self._energies()
        for rows in more:
            self.problem.add(rows.cone, rows.a, rows.b, rows.words)
        self.aim = _row(self.problem.size, (self.places.margin, 1.0))

    def _bounds(self, kinds: int) -> None:
        p, v, t = self.problem, self.places, self.targets
        eye, none = np.eye(kinds), np.zeros((kinds, kinds))
        column = np.ones((kinds, 1))
        # homogeneous of degree one in (k, tau, 1): the mean stiffness is the unit, `scale` its inverse
        mean = _row(v.size, (v.stiffness, self.count))
        p.add(EQUAL, mean, -float(self.count.sum()), "the mean stiffness is 1")
        p.add(POSITIVE, _row(v.size, (v.margin, -1.0)), LARGEST_MARGIN, "the margin has a cap")
        low, high = t.stiffness
        creases = [np.flatnonzero(t.kinds == k) + 1 for k in range(kinds)]
        names = ["crease " + ", ".join(map(str, c)) for c in creases]
        (least, most), extra = t.rest, 0.0 if isinstance(t.preload, bool) else t.preload
        bounds = (
            (eye, none, -low, f"stiffness at least {low:g} N m/rad"),
            (-eye, none, high, f"stiffness at most {high:g} N m/rad"),
            # phi0 = tau / k >= least as tau - least k >= 0: linear, since k > 0
            (-least * eye, eye, extra, f"rest angle at least {math.degrees(least):g} deg"),
            (most * eye, -eye, extra, f"rest angle at most {math.degrees(most):g} deg"),
        )
        for of_k, of_tau, of_scale, words in bounds:
            rows = np.hstack([of_k, of_tau, of_scale * column])
            p.add(POSITIVE, rows, np.zeros(kinds), tuple(f"{n}: {words}" for n in names))

    def _hold(self, i: int, share: float, name: str) -> None:
        t = self.targets
        kind = SpringRows(t.free, t.kinds).kind
        touching = {contact for j, contact in self.touching if j == i}
        state = standing(t, i)
        pieces = [Balance(state.on(tuple(p)), kind, touching, self.loose) for p in state.pieces]
        if len(pieces) > MOST_PIECES:
            many = f"{len(pieces)} smooth pieces of the feasible set meet there"
            raise OptionError(f"state {name!r}: {many}, {MOST_PIECES} are the most")
        for piece in pieces:
            if self.loose and not piece.regular:
                continue
            where = piece.pose(self.problem, self.places, share, name)
            self.balances.append((i, piece, where))

    def _energies(self) -> None:
        """Bound differences of energies, by rows."""
        p, v, t = self.problem, self.places, self.targets
        springs = SpringRows(t.model, t.kinds)
        at = {placed.target.name: placed.state.x for placed in t.placed}
        scale = _row(v.size, (v.scale, 1.0))
        for gap in t.energies:
            row = springs.energy(at[gap.first]) - springs.energy(at[gap.second])
            words = f"energy of {gap.first} above {gap.second}"
            for one in bounded(row, scale, gap.least, gap.most, words):
                p.add(one.cone, one.a, one.b, one.words)

    @cached_property
    def answer(self) -> ConicSolution:
        """The optimum, or the proof that there is no point."""
        return self.problem.maximise(self.aim)

    @property
    def margin(self) -> float:
        """Largest margin t; -inf where the rows contradict each other."""
        if self.answer.infeasible:
            return -math.inf
        return float(self.answer.v[self.places.margin]) if self.answer.solved else math.nan

    @property
    def feasible(self) -> bool:
        """Whether springs hold the states with a margin that is more than rounding."""
        return self.margin > DESIGN_MARGIN

    @property
    def refuted(self) -> bool:
        """Whether it is proved that no springs hold the states so, with a margin that is more than rounding.

        Not where a state is singular (flat-folded with creases that lose rank, say) or its contacts depend on each
        other: there the conditions prove a minimum, but a minimum need not fulfil them (`Balance.regular`).
        """
        if not all(balance.regular for _, balance, _ in self.balances):
            return False
        a = self.answer
        if self.feasible or not (a.infeasible or a.solved):
            return False
        # for every point 0 <= y . (A v + b): t <= y . b + (c + A' y) . v, where c = 0 if there is to be no point
        aim = np.zeros_like(self.aim) if a.infeasible else self.aim
        left = float(np.abs(aim + self.problem.pull(a.duals)) @ self.reach)
        return bool(a.bound + left < 0.0 if a.infeasible else a.bound + left <= DESIGN_MARGIN)

    @property
    def reach(self) -> np.ndarray:
        """How large each unknown can be where the margin is from 0 to its cap and all states are regular, [V]."""
        t, places = self.targets, self.places
        n, softest = float(self.count.sum()), t.stiffness[0]
        wound = max(map(abs, t.rest)) * n
        if not isinstance(t.preload, bool):
            wound += t.preload * n / softest
        out = np.zeros(self.problem.size)
        out[places.stiffness] = n
        out[places.torque] = wound
        out[places.scale] = n / softest
        out[places.margin] = LARGEST_MARGIN
        for _, balance, where in self.balances:
            torque = (np.abs(balance.stratum.state.x).max() * n + wound) * math.sqrt(n)
            out[where] = reach_of_multipliers(balance, torque, n)
        return out


def reach_of_multipliers(balance: Balance, torque: float, slope: float) -> float:
    """Return how large the multipliers that a balance leaves free can be: 0 where there are none.

    torque, slope: largest norms of the torques [N m] and of their slopes [N m/rad] of all creases, in its unit.
    """
    if balance.lost.shape[1]:  # one w, with H - w C >= 0 and C of both signs
        lam = np.linalg.norm(balance.to_closure, 2) * torque
        bent = slope + lam * sum(np.linalg.norm(c, 2) for c in balance.curvatures)
        values = balance.lost_modes[0]
        return float(ROOM * bent / min(values[-1], -values[0]))
    along = balance.stratum.slopes @ balance.kernel
    least = np.linalg.svd(along, compute_uv=False).min(initial=math.inf)
    return float(ROOM * torque / least)


def _row(size: int, *entries: tuple[int | slice, Any]) -> np.ndarray:
    """Return a row over the unknowns, zero but for some entries."""
    out = np.zeros(size)
    for where, value in entries:
        out[where] = value
    return out


def standing(targets: Targets, i: int) -> State:
    """Return a state, numbered from 0, in the problem in which it is to stand."""
    state, t = targets.placed[i].state, targets
    return state if t.free is t.model else State(t.free, t.free.reduce(t.model.expand(state.x)))


def scene_of(posed: ConvexDesign) -> Scene | Pattern:
    """Return the scene, or the pattern, with the springs of the optimum, which fulfil every equation to rounding.

    Bounds that are active stay exactly so; then unknowns move by the least that closes the equations.

    Parameters
    ----------
    posed
        A feasible problem.

    Returns
    -------
    Scene or Pattern
        A scene with a preload where no rest angle within [-pi, pi] gives the torque.
    """
    places = posed.places
    equal = [posed.problem.matrix(r) for r in posed.problem.rows if r.cone == EQUAL]
    right = np.concatenate([-r.b for r in posed.problem.rows if r.cone == EQUAL])
    rest, stiffness = _active(posed)
    # bounds that contradict the balance are no bounds
    for pinned in ((*rest, *stiffness), rest, ()):
        v = posed.answer.v.copy()
        a = np.vstack([*equal, *pinned])
        b = np.concatenate([right, np.zeros(len(pinned))])
        for _ in range(3):
            # step of least length back onto all equations; repeated, as one leaves rounding of its size
            v -= np.linalg.lstsq(a, a @ v - b, rcond=ROUNDED)[0]
        moved = np.abs(v - posed.answer.v)[: places.size].max()
        if np.abs(a @ v - b).max() <= ROUNDED * (1 + np.abs(v).max()) and moved <= MOVED:
            break
    scale = _scale(posed, v)
    return posed.targets.made(v[places.stiffness] / scale, v[places.torque] / scale)


def _active(posed: ConvexDesign) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return rows that keep rest angles, and stiffnesses, exactly at the bounds that they are at."""
    v, places, t = posed.answer.v, posed.places, posed.targets
    k, tau, size = v[places.stiffness], v[places.torque], posed.problem.size
    bounds = t.rest if isinstance(t.preload, bool) else ()
    kinds = range(len(k))
    rest = [
        _row(size, (places.torque.start + j, 1.0), (places.stiffness.start + j, -bound))
        for j, bound in itertools.product(kinds, bounds)
        if abs(tau[j] - bound * k[j]) <= DESIGN_ACTIVE * k[j]
    ]
    stiffness = [
        _row(size, (places.stiffness.start + j, 1.0), (places.scale, -bound))
        for j, bound in itertools.product(kinds, t.stiffness)
        if abs(k[j] - bound * v[places.scale]) <= DESIGN_ACTIVE * k[j]
    ]
    return rest, stiffness


def _scale(posed: ConvexDesign, v: np.ndarray) -> float:
    """Return 1 / mean stiffness: what energies ask for, or the geometric mean of what the bounds leave."""
    t = posed.targets
    levels = [e for gap in t.energies for e in (gap.least, gap.most)]
    levels += [e for ask in t.barriers for e in (ask.least, ask.most)]
    absolute = not isinstance(t.preload, bool)
    if absolute or any(math.isfinite(e) and e != 0.0 for e in levels):
        return float(v[posed.places.scale])
    k, (low, high) = v[posed.places.stiffness], t.stiffness
    # (which the bounds say, and a solver may leave by its accuracy)
    k = np.maximum(k, k.max() * low / high)
    return math.sqrt(float(k.max()) / high * float(k.min()) / low)


def solve(targets: Targets, more: Sequence[ConeRows] = ()) -> ConvexDesign:
    """Pose and solve a question, with contacts pressed, or else touching.

    A contact that can carry no moment is no hindrance where the state is in equilibrium without it.  Each choice of
    touching contacts is a convex program: first none, then all of some states, then one or more of all, at most
    `MOST_CHOICES`.  The first that is feasible is returned.  If none is, it is a refutation where already what all
    choices have in common has no answer (`ConvexDesign.loose`), or where each choice is refuted and no state has more
    than one contact.  (Where several touch without moments, stiffness in the directions that open them would do, which
    is no convex condition.)

    Parameters
    ----------
    targets
        The question.
    more
        See `ConvexDesign`.

    Returns
    -------
    ConvexDesign
        Solved; where not feasible that of the refutation, or of largest margin.
    """
    posed = ConvexDesign(targets, frozenset(), more)
    contacts = [
        sorted({c for p in standing(targets, i).pieces for c in p})
        for i in range(len(targets.placed))
    ]
    if posed.feasible or (not any(contacts) and all(b.regular for _, b, _ in posed.balances)):
        posed.every_refuted = posed.refuted
        return posed
    loose = ConvexDesign(targets, frozenset(), more, loose=True)
    loose.every_refuted = loose.refuted
    if loose.refuted:
        return loose
    best, tried = posed, 1
    refuted = posed.refuted and all(len(c) <= 1 for c in contacts)
    for touching in itertools.islice(_choices(contacts), MOST_CHOICES):
        posed, tried = ConvexDesign(targets, touching, more), tried + 1
        if posed.feasible:
            return posed
        refuted = refuted and posed.refuted
        if posed.margin > best.margin:
            best = posed
    # a refutation of all needs every subset tried
    best.every_refuted = refuted and tried == 2 ** sum(map(len, contacts))
    return best


def _choices(contacts: list[list[Contact]]) -> Iterator[frozenset[tuple[int, Contact]]]:
    """Return which contacts are to touch: all of some states, then some of all; none of them twice."""
    all_of = [frozenset((i, c) for c in some) for i, some in enumerate(contacts) if some]
    each = [frozenset([one]) for one in sorted(frozenset().union(*all_of))]
    seen = {frozenset[tuple[int, Contact]]()}
    for parts in (all_of, each):
        for k in range(1, len(parts) + 1):
            for some in itertools.combinations(parts, k):
                choice = frozenset[tuple[int, Contact]]().union(*some)
                if choice not in seen:
                    seen.add(choice)
                    yield choice
