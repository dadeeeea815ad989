"""Equilibria of a sheet over a load, as a curve for the tracer of `path`, with contacts held.

Creases at their fold limits are no unknowns; gaps g of features that touch are equations beside closure c, and their
multipliers the forces by which facets push.

The curve lives in (phi, T), T the load over the mean stiffness.  Newton carries multipliers along: those of least
squares change so fast beside the flat state that it would be slow there.  One vertex is followed by `path.Web`, which
picks independent rows of closure and decomposes dense matrices; a sheet has redundant rows as a rule and may be large.
Here linear systems are those of the proximal method, in which no rank is decided:

    F = (U' - T w' - J' lam, (c, g)),   [ H  -w'  J' ] [ d  ]
                                        [ r   r_T 0  ] [ dT ]
                                        [ J   0  -eps] [-dlam],        r: one more equation.

`eps` is taken back by refinement, so that what is found does not know it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy import sparse

from origami_nlp.facets import Factor, Matrix, Normal, Sheet
from origami_nlp.numerics import (
    CLOSES,
    EPS,
    INDEPENDENT,
    OUTSIDE,
    ROUNDED,
    SAME,
    STATIONARY,
    null_space,
    unbounded,
)
from origami_nlp.path import Tally
from origami_nlp.sheet_loading.held import Contact, creases_of, touches_of, touching_rows
from origami_nlp.sheet_loading.loaded import LoadedSheet
from origami_nlp.sheet_loading.work import Work

NEWTON = 10
"""Steps of the corrector: from a predicted point it needs two to four."""
LONGEST = 0.5
"""A Newton step longer than this has left the neighbourhood of the predicted point."""
ASIDE = 0.3
"""A point found further from the predicted one than this share of the step lies on another curve."""
REFINED = 8
"""Solutions of one system at most, each of what the ones before leave."""

Row = Callable[[np.ndarray, "System"], tuple[np.ndarray, float]]
"""One more equation at (phi, T): its row over (dphi, dT), and what that shall be."""


class System:
    """The equations of a point (phi, T) with contacts held, and their linear systems.

    Attributes
    ----------
    sheet
        Under the load.
    held
        Creases, then touches.
    closure
        What must vanish, gaps of touches last, [m + t].
    multipliers
        Of closure and touches, [m + t]; of smallest norm where none are given.
    balance
        Torque over the mean stiffness that is left, all creases, [n].
    residual
        Largest entry of both equations, torques relative to the largest.
    """

    def __init__(
        self,
        sheet: Sheet,
        work: Work,
        point: np.ndarray,
        held: tuple[Contact, ...],
        multipliers: np.ndarray | None = None,
    ) -> None:
        sheet.check_time()
        phi, size = point[:-1], len(point) - 1
        self.held, self.creases = held, creases_of(held)
        self.free = np.setdiff1d(np.arange(size), self.creases)
        self.sheet = LoadedSheet(sheet, work, float(point[-1]) * sheet.scale)
        self.phi, self.pulled = phi, work.gradient(phi)
        at = sheet.closure.turned(phi)
        self.closure = sheet.closure.values(phi, at)
        self._whole = sheet.closure.jacobian(phi, at)
        self._rows = touching_rows(sheet, phi, touches_of(held))
        if self._rows.touches:
            self.closure = np.concatenate([self.closure, self._rows.gaps])
            self._whole = _stacked(self._whole, self._rows.slopes)
        self.jacobian: Matrix = self._whole[:, self.free]
        torque = self.sheet.torque(phi)
        if multipliers is None:
            multipliers = Normal(self.jacobian).multipliers(torque[self.free])
        self.multipliers = multipliers
        self.balance = torque - self._whole.T @ self.multipliers
        self.size = 1.0 + float(np.abs(torque).max(initial=0.0))
        self._count = len(self.closure) - len(self._rows.touches)
        hessian = self.sheet.hessian(phi, self.multipliers[: self._count])
        if self._rows.touches:
            hessian = hessian - self._rows.bent(sheet, phi, self.multipliers[self._count :])
        self.hessian = hessian

    @property
    def residual(self) -> float:
        """Largest entry of the equations."""
        left = float(np.abs(self.balance[self.free]).max(initial=0.0)) / self.size
        return max(left, self.missing)

    @property
    def missing(self) -> float:
        """Largest entry of closure and gaps."""
        return float(np.abs(self.closure).max(initial=0.0))

    @property
    def forces(self) -> np.ndarray:
        """Moments of the limits held, and forces of touches times the sheet's size, positive where they push, [r].

        Over the mean stiffness.
        """
        limits = -np.sign(self.phi[self.creases]) * self.balance[self.creases]
        return np.concatenate([limits, self.multipliers[self._count :]])

    def step(self, row: np.ndarray, right: float) -> tuple[np.ndarray, np.ndarray] | None:
        """Return Newton's step (dphi, dT) [n + 1] under row . step = right, and the multipliers after it.

        None where the system is singular.
        """
        found = self._solve(row, -self.balance[self.free], right, -self.closure)
        return None if found is None else (found[0], self.multipliers - found[1])

    def along(self, row: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the direction (dphi, dT) [n + 1] of the curve with row . direction = 1, and the change of `forces`."""
        nothing = np.zeros(len(self.free))
        found = self._solve(row, nothing, 1.0, np.zeros(len(self.closure)))
        if found is None:
            return None
        d, change = found
        held = self.creases
        left = self.hessian[held] @ d[:-1] - d[-1] * self.pulled[held]
        left = left + (self._whole.T @ change)[held]
        limits = -np.sign(self.phi[held]) * left
        return d, np.concatenate([limits, -change[self._count :]])

    def _solve(
        self, row: np.ndarray, top: np.ndarray, right: float, bottom: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Solve with one more row for (d, dT) [n + 1] and minus the change of multipliers [m]."""
        f = self.free
        # curvature that multipliers add beside the flat state would let eps be taken back slowly
        size = max(1.0, float(abs(self.hessian).max()))
        h, w, top = self.hessian[f][:, f] / size, -self.pulled[f][:, None] / size, top / size
        last = np.append(row[:-1][f], row[-1])[None]
        if isinstance(self.jacobian, np.ndarray):
            matrix: Matrix = np.vstack([np.hstack([h, w]), last])
            jacobian: Matrix = np.hstack([self.jacobian, np.zeros((len(bottom), 1))])
        else:
            rows = [[sparse.csr_array(h), sparse.csr_array(w)]]
            matrix = sparse.vstack([sparse.hstack(rows[0]), sparse.csr_array(last)]).tocsr()
            empty = sparse.csr_array((len(bottom), 1))
            jacobian = sparse.hstack([self.jacobian, empty]).tocsr()
        try:
            factor = Factor(matrix, jacobian)
        except RuntimeError:  # of a sparse matrix that is exactly singular
            return None
        want = np.append(top, right)
        d, change = np.zeros(len(f) + 1), np.zeros(len(bottom))
        left = math.inf
        for _ in range(REFINED):
            more = factor.solve(want - matrix @ d - jacobian.T @ change, bottom - jacobian @ d)
            d, change = d + more[0], change + more[1]
            before, left = left, float(np.abs(more[0]).max())
            if not left < before or left <= EPS * float(np.abs(d).max()):
                break
        if not np.isfinite(d).all():
            return None
        whole = np.zeros(len(row))
        whole[f], whole[-1] = d[:-1], d[-1]
        return whole, size * change

    def eigenvalues(self, idle: np.ndarray) -> np.ndarray:
        """Of the Hessian on what closure and contacts leave free, over the mean stiffness, ascending.

        idle: contacts that carry nothing, of bool [r].  They hold nothing, unless forces on them can cancel each other:
        such forces can be added, however small.
        """
        many, holding = len(self.creases), ~idle
        if idle.any():
            sides = np.zeros((many, len(self.phi)))
            sides[np.arange(many), self.creases] = -np.sign(self.phi[self.creases])
            columns = (np.vstack([sides, self._rows.slopes]) @ self.sheet.kernel(self.phi)).T
            lengths = np.linalg.norm(columns, axis=0)
            felt = lengths > INDEPENDENT
            holding[felt] |= unbounded(columns[:, felt] / lengths[felt])
        z = self.sheet.kernel(self.phi, np.array(self.creases, int)[holding[:many]])
        if holding[many:].any():
            z = z @ null_space(self._rows.slopes[holding[many:]] @ z)
        return np.linalg.eigvalsh(z.T @ (self.hessian @ z))


def _stacked(matrix: Matrix, rows: np.ndarray) -> Matrix:
    """Return a matrix with more rows."""
    if isinstance(matrix, np.ndarray):
        return np.vstack([matrix, rows])
    return sparse.vstack([matrix, sparse.csr_array(rows)]).tocsr()


@dataclass(frozen=True, eq=False)
class LoadedState:
    """A point of the curve, a `tracer.Frame`.

    Attributes
    ----------
    x
        Fold angles and load over the mean stiffness, (phi, T) [n + 1].
    tangent
        Of length 1 in the metric, [n + 1].
    system
        Of this point.
    rates
        Change of `System.forces` along the tangent, [r].
    """

    x: np.ndarray
    tangent: np.ndarray
    system: System
    rates: np.ndarray

    @property
    def bend(self) -> np.ndarray:
        """Not known: steps are straight."""
        return np.zeros(len(self.x))

    @property
    def phi(self) -> np.ndarray:
        """Fold angles [rad], [n]."""
        return self.x[:-1]

    @property
    def t(self) -> float:
        """The load."""
        return float(self.x[-1]) * self.system.sheet.scale

    @property
    def held(self) -> tuple[Contact, ...]:
        """Contacts that are held."""
        return self.system.held

    @property
    def ahead(self) -> float:
        """Change of the load along the tangent."""
        return float(self.tangent[-1])

    @cached_property
    def eigenvalues(self) -> np.ndarray:
        """Of the Hessian on what is left free, over the mean stiffness, ascending.

        Contacts that carry nothing, and will not, hold nothing.
        """
        least = INDEPENDENT * self.system.size
        idle = (np.abs(self.system.forces) <= least) & (np.abs(self.rates) <= least)
        return self.system.eigenvalues(idle)

    @property
    def lowest(self) -> float:
        """Smallest eigenvalue over the mean stiffness; inf where nothing is left free."""
        values = self.eigenvalues
        return float(values[0]) if len(values) else math.inf

    @property
    def index(self) -> int:
        """Number of directions in which the energy falls."""
        return int((self.eigenvalues < 0).sum())


@dataclass(frozen=True, eq=False)
class LoadCurve:
    """Equilibria over the load with contacts held; a `tracer.Curve`.

    Attributes
    ----------
    sheet
        Without the load.
    work
        What the load works on.
    held
        Creases at their fold limit, then features that touch.
    tally
        What following cost.
    """

    sheet: Sheet
    work: Work
    held: tuple[Contact, ...]
    tally: Tally
    _known: list[tuple[np.ndarray, System]] = field(default_factory=list)
    _last: list[np.ndarray] = field(default_factory=list)

    @cached_property
    def root(self) -> np.ndarray:
        """Metric of (phi, T): the root of the mean square of the angles; a load that could turn all springs is 1."""
        n = self.sheet.size
        weight = self.work.arm * self.sheet.scale / float(self.sheet.pattern.stiffness.sum())
        return np.append(np.full(n, 1 / math.sqrt(n)), weight)

    def system(self, point: np.ndarray, multipliers: np.ndarray | None = None) -> System:
        """Evaluate the equations at (phi, T)."""
        self.tally.evaluations += 1
        return System(self.sheet, self.work, point, self.held, multipliers)

    def solve(self, point: np.ndarray, row: Row) -> tuple[np.ndarray, System] | None:
        """Solve the equations with one more by Newton from (phi, T); None if that fails."""
        multipliers = None
        for _ in range(NEWTON):
            system = self.system(point, multipliers)
            found = system.step(*row(point, system))
            if found is None:
                return None
            step, multipliers = found
            length = float(np.linalg.norm(self.root * step))
            if not length <= LONGEST:
                return None
            if length <= ROUNDED:
                break
            point = point + step
            if length <= SAME:  # its square is rounding
                system = self.system(point, multipliers)
                # off closure a gap is one along a tree, its slope one along a walk: one step more
                if system.missing <= (ROUNDED if touches_of(self.held) else CLOSES):
                    break
        else:
            return None
        beyond = np.abs(point[:-1]) - math.pi
        if 0.0 < beyond.max(initial=0.0) <= OUTSIDE:  # touches keep a crease shut, to rounding
            point = np.append(np.clip(point[:-1], -math.pi, math.pi), point[-1])
            system = self.system(point, multipliers)
        self._known[:] = [(point, system)]
        good = system.missing <= CLOSES and system.residual <= STATIONARY
        return (point, system) if good and self.sheet.closure.on_sheet(point[:-1]) else None

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        """Move (phi, T) [n + 1] onto the curve by steps across the direction in which it went last."""

        def across(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
            return self.root * self._last[0], 0.0

        found = self.solve(x, across)
        return None if found is None else found[0]

    def frame(self, x: np.ndarray, along: np.ndarray) -> LoadedState | None:
        """Return the point (phi, T) with its tangent on the side of `along` [n + 1]; None where it has none."""
        known = [system for point, system in self._known if point is x]
        return self.frame_of(x, known[0] if known else self.system(x), along)

    def frame_of(self, x: np.ndarray, system: System, along: np.ndarray) -> LoadedState | None:
        """Return the frame of a point whose system is known."""
        found = system.along(along * self.root)
        if found is None:
            return None
        way, rates = found
        size = float(np.linalg.norm(self.root * way))
        if not np.isfinite(size) or size == 0.0:
            return None
        self._last[:] = [self.root * way / size]
        return LoadedState(x, self._last[0], system, rates / size)

    def beside(self, frame: LoadedState, h: float) -> LoadedState | None:
        """Return the point of the curve whose step from `frame` has length h along its tangent."""
        if h == 0.0:
            return frame

        def plane(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
            gone = float(frame.tangent @ (self.root * (point - frame.x)))
            return frame.tangent * self.root, h - gone

        ahead = frame.x + h * frame.tangent / self.root
        found = self.solve(ahead, plane)
        if found is None or np.linalg.norm(self.root * (found[0] - ahead)) > ASIDE * abs(h) + SAME:
            return None
        return self.frame_of(*found, frame.tangent)

    def where(
        self, point: np.ndarray, entry: int, value: float, along: np.ndarray
    ) -> LoadedState | None:
        """Return the point of the curve near (phi, T) at which an entry, a fold angle or T (-1), has a value."""

        def fixed(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
            row = np.zeros(len(point))
            row[entry] = 1.0
            return row, value - point[entry]

        found = self.solve(point, fixed)
        if found is None:
            return None
        at = found[0].copy()
        at[entry] = value
        return self.frame_of(at, found[1], along)
