"""A pattern as a nonlinear program: all that solvers and certificates see of it (`problem.protocol.Problem`).

The energy and the closure of `PatternEquations`, the contacts of `PatternContacts`, and loads.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy as sp

from origami_nlp.io import PrettyRepr, to_plain
from origami_nlp.numerics import CLOSURE_TOL, CONTACT_TOL, OUTSIDE, Matrix, dense
from origami_nlp.pattern import Contact as Mode, Pattern
from origami_nlp.pattern_problem.closure import Closure
from origami_nlp.pattern_problem.contact_pairs import ContactPair
from origami_nlp.pattern_problem.contacts import PatternContacts
from origami_nlp.pattern_problem.equations import MOST_DENSE
from origami_nlp.pattern_problem.labels import CanonicalLabelling, as_stated, find_labels, image
from origami_nlp.pattern_problem.layers import Layers, order_layers
from origami_nlp.pattern_problem.meeting_features import touches_at
from origami_nlp.pattern_problem.orbits import Orbits
from origami_nlp.pattern_problem.work import Work, Worked
from origami_nlp.problem import Contact, Energies, LoopClosure, Parameters, openings

if TYPE_CHECKING:
    from origami_nlp.pattern_problem.symbols import Symbols

MOST_NAMED = 40
"""Variables whose creases are listed."""


class PatternProblem(PatternContacts, Energies, PrettyRepr):
    """The nonlinear program of a pattern (`problem.protocol.Problem`); states are n variables, its fold angles.

    Parameters
    ----------
    pattern
        With its springs.
    contact
        Whether facets must not cross; without, only fold limits count.
    orbits
        Of states that keep a symmetry: variables are then fewer than creases.
    limited
        Whether there are fold limits.

    Attributes
    ----------
    contact
        As given.
    besides
        What of the origami as stated is not modelled, and why.
    symmetry
        Group that states and loads keep, by its name; ``none``: any are states of it.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import PatternProblem
    >>> problem = PatternProblem(o.examples.pattern("miura", 1, 2).with_springs(1.0, 0.5))
    >>> o.classify(o.State(problem, np.array([-0.5]))).verdict
    'minimum'
    """

    def __init__(
        self,
        pattern: Pattern,
        contact: bool = True,
        orbits: Orbits | None = None,
        limited: bool = True,
    ) -> None:
        super().__init__(pattern, contact, orbits, limited)
        self.symmetry = "none"
        self._load = np.zeros(self.size)
        self._dead: Any = None
        self._symbols: Symbols | None = None
        self.besides: tuple[tuple[str, str], ...] = ()

    @cached_property
    def parameters(self) -> Parameters:
        """Springs and load over `scale`."""
        known = self.springs
        return replace(known, load=known.load + self._load, dead=self._dead or known.dead)

    @property
    def mode(self) -> Mode:
        """The contact that was asked for, in one word."""
        return "full" if self.contact else "fold-limits" if self.has_limits else "none"

    @property
    def bound(self) -> float:
        """Largest |fold angle| within the limits."""
        return float(np.abs([self.fold_limits.low, self.fold_limits.high]).max(initial=0.0))

    @property
    def equation_count(self) -> int:
        """Number of closure equations m; they depend on each other as a rule."""
        return self.closure.count

    @cached_property
    def labels(self) -> CanonicalLabelling:
        """The order of its variables that does not depend on how creases are numbered, and symmetries of states."""
        if self.parameters.dead is not None:  # forces count from a facet
            return as_stated(self.pattern.creases, self.size)
        load = self.expand(self.springs.load / self.multiplicity) * self.scale
        return find_labels(self.pattern, load, self.orbits)

    @property
    def moves(self) -> list[Callable[[np.ndarray], np.ndarray]]:
        """Its symmetries with springs and loads, of states [..., n]."""
        return [partial(image, one) for one in self.labels.symmetries]

    @property
    def canonical(self) -> tuple[PatternProblem, np.ndarray] | None:
        """The same origami under labels that all agree on, to the last bit, and the crease that each of them names.

        None where only the order of `labels` is one that they agree on.
        """
        return None

    @property
    def whole(self) -> PatternProblem:
        """The problem of all fold angles, whatever symmetry is imposed on this one."""
        return self

    def winding(self, x: np.ndarray) -> int:
        """Return how often a closed state winds round the axis of an imposed symmetry; 0 where none is asked for."""
        return 1

    def shape(self, sector_angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return corners and fold angles of a reference state of one vertex with given sector angles."""
        raise NotImplementedError("sector angles of a sheet are not varied")

    @cached_property
    def dof(self) -> int:
        """Degrees of freedom at a regular state: variables less the rank of closure there; of large sheets at least."""
        if self.size <= MOST_DENSE:
            # any state in general position, and one beside it where that does not close
            for start in (np.sin(1.0 + np.arange(self.size)), np.cos(2.0 * np.arange(self.size))):
                x, residual = self.project(start)
                if residual <= CLOSURE_TOL:
                    return self.size - self.rank(x)
        return max(self.size - self.closure.count, 0)

    @cached_property
    def flattened(self) -> np.ndarray | None:
        """The corners where the sheet lies flat, [V, 3]; None where it does not."""
        if self.pattern.lies_flat:
            return self.pattern.corners
        zero = np.zeros(self.size)
        return None if self.residual(zero) > CLOSURE_TOL else self.crossings.poses.corners(zero)

    @property
    def left_out(self) -> tuple[tuple[str, str], ...]:
        """What is not modelled, and why."""
        left = list(self.besides)
        if self.orbits is not None:
            tied = len(self.orbits.orbit) - self.size
            left.append(
                (f"{tied} fold angles", f"the symmetry {self.symmetry} ties them to the others")
            )
        if self.contact:
            left.append(("pairs of facets at a crease", "fold limits keep them apart"))
        else:
            left.append(("crossing of facets", "the contact asked for leaves it out"))
        if not self.has_limits:
            left.append(("fold limits", "the contact asked for leaves them out"))
            left.append(("fold angles beyond 2 pi", "each further turn repeats the shape"))
        return tuple(left)

    def __repr__(self) -> str:
        counts = f"{self.size} fold angles, {self.equation_count} equalities"
        return f"PatternProblem({self.pattern.title}: {counts}, symmetry {self.symmetry})"

    def __str__(self) -> str:
        n, loops = self.size, len(self.pattern.vertices) + len(self.pattern.holes)
        tied = ["+".join(map(str, self.creases_of(v))) for v in range(n)]
        names = f" of creases {', '.join(tied)}" if n <= MOST_NAMED else ""
        limits = f"{2 * n} fold limits" if self.has_limits else "none"
        facets = "; facets that do not cross, by the gaps of what is near" * self.contact
        lines = [
            f"  variables     {n}: fold angles{names}",
            f"  equalities    {self.equation_count}: closure round {loops} vertices and holes, of rank {n - self.dof}",
            f"  inequalities  {limits}{facets}",
            "  left out",
            *(f"                  {what}: {why}" for what, why in self.left_out),
        ]
        return "\n".join([f"Problem of {self.pattern.title}", *lines])

    def _to_plain(self) -> dict[str, Any]:
        left = [{"what": what, "why": why} for what, why in self.left_out]
        size = {"variables": self.size, "equalities": self.equation_count, "left_out": left}
        return to_plain(size)  # type: ignore[no-any-return]

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Gradient of the energy, load included, over `scale`, [n]."""
        return self.parameters.torque(phi)

    def hessian(self, phi: np.ndarray, multipliers: np.ndarray) -> Matrix:
        """Hessian of U - multipliers . closure, load included, over `scale`, [n, n]."""
        plain = super().hessian(phi, multipliers)
        dead = self.parameters.dead
        bent = None if dead is None else dead.hessian(self.parameters.sectors, phi)
        if bent is None:
            return plain
        return plain + (bent if isinstance(plain, np.ndarray) else sp.sparse.csr_array(bent))

    def scaled_energy(self, phi: np.ndarray) -> float:
        """Energy, load included, over `scale`."""
        return float(self.parameters.energy(phi))

    def constraints(
        self, x: np.ndarray, contacts: Sequence[Contact] = ()
    ) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate closure and the openings of contacts, [..., m + r], and their Jacobian [..., m + r, n]."""
        if x.ndim > 1:
            if len(x) and all(c.is_limit for c in contacts):
                c, j = map(np.array, zip(*map(self.closure, x), strict=True))
                none = np.zeros((len(x), 0))
                values, slopes = openings(x, none, np.zeros((len(x), 0, self.size)), contacts)
                return np.hstack([c, values]), np.concatenate([j, slopes], axis=1)
            each = [self.constraints(one, contacts) for one in x]
            count, m = len(x), self.closure.count + len(contacts)  # there may be no state
            values = np.array([v for v, _ in each]).reshape(count, m)
            return values, np.array([j for _, j in each]).reshape(count, m, self.size)
        local = self.local(x)
        values, slopes = local.openings(contacts)
        return np.append(local.closure, values), np.vstack([dense(local.closure_jacobian), slopes])

    def lagrangian_hessian(
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact] = (),
        weight: float = 1.0,
    ) -> np.ndarray:
        """Hessian of weight U - multipliers . (closure, openings) over `scale` at a state, [n, n]; dense."""
        m = self.closure.count
        if weight:
            # weight U - lam . c = weight (U - (lam / weight) . c)
            h = weight * dense(self.hessian(x, multipliers[:m] / weight))
        else:
            h = -dense(self.closure.hessian(x, multipliers[:m]))
        return h - self._bent(x, multipliers[m:], contacts)

    def curvature(
        self, x: np.ndarray, multipliers: np.ndarray, contacts: Sequence[Contact]
    ) -> Matrix:
        """Hessian of U - multipliers . (closure, openings) over `scale` at a state, [n, n]; sparse where large."""
        m = self.closure.count
        h = self.hessian(x, multipliers[:m])
        if all(c.is_limit for c in contacts):
            return h
        bent = self._bent(x, multipliers[m:], contacts)
        return h - bent if isinstance(h, np.ndarray) else h - sp.sparse.csr_array(bent)

    def _bent(self, x: np.ndarray, forces: np.ndarray, contacts: Sequence[Contact]) -> np.ndarray:
        """Hessian of forces . openings, [n, n]."""
        h = np.zeros((self.size, self.size))
        known: dict[Contact, np.ndarray] = self.kept("bends", x, dict)
        for force, contact in zip(forces, contacts, strict=True):
            if force and not contact.is_limit:
                if contact not in known:
                    known[contact] = self._bends(x, self.touch(contact))
                h += force * known[contact]
        return h

    def _bends(self, x: np.ndarray, touch: ContactPair) -> np.ndarray:
        """Hessian of an opening, [n, n]: of a gap over the sheet's size."""
        place, h = self.placed(x), np.zeros((self.size, self.size))
        creases = touch.creases(place)
        # a walk may cross copies of one crease, or several that follow one variable
        np.add.at(h, np.ix_(creases, creases), touch.bends(place) / self.crossings.size)
        return h

    def symbols(self) -> Symbols:
        """Return energy, closure and gaps as CasADi symbols, with springs and corners as parameters."""
        from origami_nlp.pattern_problem.symbols import Symbols

        if self._symbols is None:
            self._symbols = Symbols(self)
        return self._symbols

    def __getstate__(self) -> dict[str, Any]:
        return vars(self) | {"_symbols": None, "_last": None}  # which do not pickle

    def loops(self, x: np.ndarray) -> list[LoopClosure]:
        """Return closure to second order at a state [n], of each vertex and hole by itself."""
        return self.closure.loops(x)

    def lifts_to_one(self, x: np.ndarray) -> Any:
        """Return whether states [..., n] are on the lift q = +1."""
        if x.ndim == 1:
            return self.closure.lifts_to_one(x)
        return np.array([self.closure.lifts_to_one(one) for one in x], bool)

    def with_contact(self, contact: bool) -> PatternProblem:
        """Return the same problem with facets that must not cross, or may."""
        if contact == self.contact:
            return self
        other = self._other()
        other.contact = contact
        return other

    def crossed(self, x: np.ndarray) -> tuple[tuple[int, int], ...]:
        """Return the pairs of facets (0-based) that cross at a state."""
        if not self.contact:
            return ()
        self.check_time()
        found: tuple[tuple[int, int], ...] = self.kept(
            "crossed", x, lambda: tuple(self.crossings.find(x))
        )
        return found

    def refuses(self, x: np.ndarray, tolerance: float = OUTSIDE) -> str:
        """Return why a closed state is not admissible, or "": lift, fold limits, crossings, order of layers."""
        if not self.lifts_to_one(x):
            return "closes with q = -1 round a vertex: not a sheet of paper"
        if over := self.beyond(x, tolerance):
            return f"beyond the fold limit {self.name(over[0])}"
        if not self.contact or self.apart(x):
            return ""
        crossed = self.crossed(x)
        if crossed:
            many = f"{len(crossed)} pairs of facets" if len(crossed) > 1 else "two facets"
            return f"{many} intersect"
        return "" if self._layers(x).verdict == "ordered" else self._layers(x).reason

    def _layers(self, x: np.ndarray) -> Layers:
        layers: Layers = self.kept("layers", x, lambda: order_layers(self, x))
        return layers

    def doubt(self, x: np.ndarray) -> str:
        """Return why it is not known whether a closed state is admissible; "" where it is."""
        if not self.contact or self.apart(x) or self.crossed(x):
            return ""
        if self.pattern.cell and (why := self.crossings.unseen(x)):
            return why
        if self._layers(x).verdict == "not decided":
            return self._layers(x).reason
        if not self.touching:
            return ""
        place, at_limit = self.placed(x), np.flatnonzero(self.fold_limits.room(x) <= CONTACT_TOL)
        gaps = (t.gap(place) / self.crossings.size for t in touches_at(self, x, at_limit))
        # rounding of a closed state is some `CLOSURE_TOL`: what reaches in deeper is no closed contact
        deepest = min([self.faces(x).reach(), *gaps])
        if deepest >= -10 * CLOSURE_TOL:
            return ""
        return f"facets reach into each other by {-deepest:.1e} of the sheet's size"

    def admissible(self, x: np.ndarray, tolerance: float = OUTSIDE) -> np.ndarray:
        """Return which closed states [K, n] are admissible; layers are not ordered."""
        good = np.isfinite(x).all(axis=1) & self.within(x, tolerance).all(axis=1)
        for k in np.flatnonzero(good):
            good[k] = self.lifts_to_one(x[k]) and not self.crossed(x[k])
        return good

    def numbered_as(self, other: PatternProblem) -> PatternProblem:
        """Take scale, numbers of contacts and limit of time of another pattern of the same facets and creases.

        Parameters
        ----------
        other
            Its problem.

        Returns
        -------
        PatternProblem
            This one.
        """
        self.springs = self.springs.scaled(self.scale / other.scale)
        self._load = self._load * (self.scale / other.scale)
        self.scale, self._end = other.scale, other._end
        self._touches, self._numbers = other._touches, other._numbers
        self._images, self._contacts = other._images, other._contacts
        vars(self).pop("parameters", None)
        return self

    def _other(self) -> PatternProblem:
        other = copy.copy(self)
        vars(other).pop("parameters", None)
        other._seen = {}
        return other

    def under(self, work: Work, t: float) -> PatternProblem:
        """Return the problem of the pattern under the load t on what it works on.

        Parameters
        ----------
        work
            What the load works on.
        t
            The load.

        Returns
        -------
        PatternProblem
            With the energy U - t w(phi); what is known of closure and of facets is shared.
        """
        other = self._other()
        other._dead = Worked(work, t / self.scale)
        return other

    def loaded(self, load: np.ndarray) -> PatternProblem:
        """Return the same problem with energy U - load . phi; load over `scale`, [n]."""
        other = self._other()
        other._load = np.asarray(load, float)
        return other

    def varied(self, parameters: Parameters) -> PatternProblem:
        """Return the same problem with other springs and loads, over the same `scale`."""
        other, p = self._other(), self.parameters
        same = p.laws is parameters.laws or (
            p.laws is not None
            and parameters.laws is not None
            and p.laws.laws == parameters.laws.laws
            and np.array_equal(p.laws.vector, parameters.laws.vector)
        )
        if not (
            same
            and np.array_equal(p.rest, parameters.rest)
            and np.array_equal(p.stiffness, parameters.stiffness)
        ):
            if self.orbits is None:
                other.pattern = replace(
                    self.pattern,
                    stiffness=parameters.stiffness * self.scale,
                    rest=parameters.rest,
                    laws=() if parameters.laws is None else parameters.laws.made(self.scale),
                )
            other.springs = replace(parameters, load=np.zeros(self.size), dead=None)
        other._load, other._dead = parameters.load, parameters.dead
        return other

    def shaped(self, sector_angles: np.ndarray) -> PatternProblem:
        """Return the same problem of one vertex with other sector angles [N] [rad]."""
        corners, reference = self.shape(sector_angles)
        other = self._measured(replace(self.pattern, corners=corners, reference=reference))
        other.springs = replace(self.springs, sectors=sector_angles)
        return other

    def arranged(self) -> PatternProblem:
        """Return the same problem with loops that begin where `labels` say, about its middle."""
        other = self._measured(self.labels.arranged(self.pattern))
        other.origin = self.pattern.corners.mean(axis=0) * (self.pattern.cell is None)
        return other

    def _measured(self, pattern: Pattern) -> PatternProblem:
        """Return the same problem measured in another reference state of its pattern."""
        other = self._other()
        other.pattern, other.closure = pattern, Closure(pattern, self.orbits)
        other.crossings = self.crossings if pattern.cell else self.crossings.moved(pattern)
        other._last, other._decomposed, other._stacks = None, {}, {}
        vars(other).pop("features", None)
        return other

    def drift(
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact],
        change: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Differentiate the KKT system along a change of `parameters.vector`: of springs and loads alone."""
        p, first = self.parameters, len(self.parameters.sectors)
        stiffness, rest, load = change[first : first + 3 * self.size].reshape(3, -1)
        torque = stiffness * (x - p.rest) - p.stiffness * rest
        if p.laws is not None:
            torque = p.laws.linear(torque) + p.laws.drift(x, change[-2 * self.size :])
        torque = torque - load
        if p.dead is not None:
            torque = torque + p.dead.drift(p.sectors, x, change[first + 3 * self.size :])
        return torque, np.zeros(len(multipliers))
