"""A problem as CasADi symbols, for any solver: energy, closure and gaps, with springs and corners as parameters.

Written from the folds alone, by turns of quaternions along loops and of points along walks of facets; CasADi
differentiates.  The compiled functions of `closure` and `facets` are held against it point by point.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.numerics import RANK, dense, quaternion as quat
from origami_nlp.pattern import HingeLaw, Loop
from origami_nlp.pattern_problem.contact_pairs import ContactPair
from origami_nlp.pattern_problem.faces import CoplanarContact
from origami_nlp.problem import Contact, Nlp

ASIDE = 0.1
"""How far beside a singular state rows of closure are counted [rad]."""


class Symbols:
    """Symbols of min U(y) subject to closure(y) = 0 and gaps(y) >= 0.

    Parameters
    ----------
    problem
        Of a vertex or a sheet, without forces in space.

    Attributes
    ----------
    y
        Variables, [n] [rad].
    springs
        Stiffness, rest angles and load of the variables over `scale`, and weights and shifts of their laws.
    corners
        Of the paper in its reference state, [V, 3].
    energy
        Over `scale`.
    closure
        Of all loops, [m]; rows may depend on each other.
    solvers
        Programs with their solvers, by what they were made for: one serves states with as many rows and the same gaps.

    Raises
    ------
    OptionError
        Where forces pull in space.

    Examples
    --------
    >>> import casadi as ca, origami_nlp as o
    >>> from origami_nlp.pattern_problem import pose
    >>> symbols = pose(o.examples.degree6("pi/3", ratio=1)).symbols()
    >>> symbols.y.shape, symbols.closure.shape, ca.jacobian(symbols.closure, symbols.corners).shape
    ((4, 1), (3, 1), (3, 21))
    """

    def __init__(self, problem: Any) -> None:
        p = problem.parameters
        if p.dead is not None:
            raise OptionError(
                "forces in space have no symbols for IPOPT: descents take them, which need a C compiler, or state "
                "torques on creases"
            )
        self.problem, n, pattern = problem, problem.size, problem.pattern
        self.solvers: dict[Any, tuple[Nlp, Any]] = {}
        self.y = ca.SX.sym("y", n)
        k, rest, load = (ca.SX.sym(name, n) for name in ("k", "rest", "load"))
        laws = () if p.laws is None else p.laws.laws
        weight, shift = ca.SX.sym("w", len(laws)), ca.SX.sym("d", len(laws))
        linear = ca.DM([float(law is None) for law in laws]) if laws else ca.DM.ones(n)
        energy = 0.5 * ca.dot(linear * k, (self.y - rest) ** 2) - ca.dot(load, self.y)
        for v, law in enumerate(laws):
            if law is not None:
                energy += weight[v] * law_energy(law, self.y[v] - shift[v])
        self.energy: ca.SX = energy
        self.springs = ca.vertcat(k, rest, load, weight, shift)
        self.corners = ca.SX.sym("X", len(problem.crossings.poses.pattern.corners), 3)
        orbits = problem.orbits
        phi = self.y if orbits is None else ca.DM(orbits.sign) * self.y[orbits.orbit.tolist(), 0]
        self._turns = phi - ca.DM(pattern.reference)
        turning = (*pattern.vertices, *pattern.generators)
        loops = [self._loop(loop, hole=False)[:3] for loop in turning]
        for loop in pattern.holes:
            whole, moved = self._loop(loop, hole=True), ca.DM(loop.moved or (0.0, 0.0, 0.0))
            loops.append(ca.vertcat(whole[:3], (whole[3:] + moved) / problem.closure.size))
        self.closure: ca.SX = ca.vertcat(ca.SX(0, 1), *loops)

    @cached_property
    def values(self) -> np.ndarray:
        """Numbers of `springs` and then `corners`, as `nlp` takes them."""
        p = self.problem.parameters
        laws = np.zeros(0) if p.laws is None else p.laws.vector
        corners = self.problem.crossings.poses.pattern.corners
        return np.concatenate([p.stiffness, p.rest, p.load, laws, corners.T.ravel()])

    def gap(self, contact: Contact) -> ca.SX:
        """Return the gap of a contact over the sheet's size, positive where facets are apart."""
        return self._gap(self.problem.touch(contact)) / self.problem.crossings.size

    def nlp(self, y0: np.ndarray, contacts: Sequence[Contact] = ()) -> Nlp:
        """Return the program near a state, for IPOPT.

        Parameters
        ----------
        y0
            A state [n]: closure is projected on its row space at the closed state beside it (off closure dependent rows
            have another rank), so that rows are independent; where that is singular, as the flat one, beside it again.
        contacts
            Gaps that stay open.

        Returns
        -------
        Nlp
            Its parameters are `values`; fold limits are bounds for the caller to set.
        """
        return self.program(ca.DM(self.row_space(y0)), contacts)

    def row_space(self, y0: np.ndarray) -> np.ndarray:
        """Return a basis of the row space of closure near a state [n], orthonormal combinations of its rows [m, r]."""
        beside, _ = self.problem.project(np.asarray(y0, float))
        aside, _ = self.problem.project(beside + ASIDE * np.sin(1.0 + np.arange(len(beside))))
        if self.problem.rank(aside) > self.problem.rank(beside):
            beside = aside
        u, sizes, _ = np.linalg.svd(dense(self.problem.jacobian(beside)))
        return np.asarray(u[:, : int((sizes > RANK).sum())])

    def program(self, rows: ca.DM | ca.SX, contacts: Sequence[Contact] = ()) -> Nlp:
        """Return the program with combinations `rows` [m, r] of closure; they are parameters where they are symbols."""
        gaps = [self.gap(c) for c in contacts if not c.is_limit]
        p = ca.vertcat(self.springs, ca.vec(self.corners))
        if isinstance(rows, ca.SX):
            p = ca.vertcat(p, ca.vec(rows))
        lower, upper = np.zeros(rows.shape[1] + len(gaps)), np.zeros(rows.shape[1] + len(gaps))
        upper[rows.shape[1] :] = math.inf
        g = ca.vertcat(rows.T @ self.closure, *gaps)
        return Nlp(self.y, p, self.energy, g, lower, upper)

    def _corner(self, number: int) -> ca.SX:
        return self.corners[number, :].T

    def _fold(self, ends: Any, turn: ca.SX, sign: float) -> tuple[Any, ca.SX]:
        """Return a fold about the line from one corner to another as a quaternion, and a point on its axis."""
        start, end = (self._corner(int(c)) for c in ends)
        axis = sign * (end - start) / ca.norm_2(end - start)
        return quat.fold(ca.cos(0.5 * turn), ca.sin(0.5 * turn), ca.vertsplit(axis)), start

    def _loop(self, loop: Loop, hole: bool) -> ca.SX:
        """Return where the folds round a loop lead: vector part of the turn, and shift round a hole, [6]."""
        q, shift, p = quat.IDENTITY, ca.SX.zeros(3), self.problem.pattern
        copies = loop.shifts or ((0, 0),) * len(loop.creases)
        for crease, sign, copy in zip(loop.creases, loop.signs, copies, strict=True):
            fold, point = self._fold(p.ends[crease], self._turns[crease], sign)
            if p.cell:
                point = point + ca.DM(np.array(copy) @ p.cell.lattice)
            after = quat.multiply(q, fold)
            if hole:
                at = ca.vertsplit(point)
                shift += ca.vertcat(*quat.rotate(q, at)) - ca.vertcat(*quat.rotate(after, at))
            q = after
        return ca.vertcat(*(-x if loop.moved else x for x in q[1:]), shift)

    def _gap(self, touch: ContactPair) -> ca.SX:
        """Return the gap of two features, seen from the first facet."""
        poses = self.problem.crossings.poses
        p, (first, second) = poses.pattern, touch.facets

        def seen(x: ca.SX) -> ca.SX:
            """Move a point of the second facet as the folds between the two do."""
            here = x
            for crease, sign in reversed(poses.path(first, second)):
                turn = self._turns[int(poses.cell.crease_of[crease]) if poses.cell else crease]
                fold, point = self._fold(p.ends[crease], turn, sign)
                here = ca.vertcat(*quat.rotate(fold, ca.vertsplit(here - point))) + point
            return here

        if touch.type == "edge-edge":
            a, b, c, d = (self._corner(i) for i in touch.corners)
            e, f = seen(c), seen(d)
            normal, off = ca.cross(b - a, f - e), e - a
        else:
            b, c, d = (self._corner(i) for i in touch.corners[1:])
            on = touch.place if isinstance(touch, CoplanarContact) else None
            of = self._corner(touch.corners[0]) if on is None else ca.SX(ca.DM(np.array(on)))
            normal, off = ca.cross(c - b, d - b), seen(of) - b
        return touch.sign * ca.dot(off, normal) / ca.norm_2(normal)


def law_energy(law: HingeLaw, phi: ca.SX) -> ca.SX:
    """Return the energy of a law as symbols: its own pieces, chosen by the fold angle."""
    breaks, coefficients = law.energy_pieces
    at, *pieces = (ca.pw_const(phi, breaks[1:-1], c) for c in (breaks[:-1], *coefficients))
    energy: ca.SX = ca.SX(0)
    for c in pieces:
        energy = energy * (phi - at) + c
    return energy
