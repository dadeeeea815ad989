"""A pattern as a nonlinear programme: all that solvers and certificates see of it (`programme.protocol.Programme`).

The energy and the closure of `PatternEquations`; as contacts the fold limits of creases and the gaps between features
of facets, over the sheet's size.  Of a gap one touch is kept, whichever the side from which it is seen: a contact names
it by its number and its side.  What is no single inequality is a choice between several: facets that meet at borders
(of several gaps one stays open) and facets that lie face to face in an order that is not forced.

The pieces of `closed` are larger than the set of states beside the one asked for: gaps that are certain are kept, what
else touches only makes the states beside it fewer.  A minimum of a larger set is one; that a state is none is shown by
a lower state alone (`ClosedContacts.complete`).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.facets.borders import choices
from origami_nlp.facets.closure import Matrix
from origami_nlp.facets.equations import MOST_DENSE, PatternEquations
from origami_nlp.facets.faces import Faces, Lying
from origami_nlp.facets.features import INSIDE
from origami_nlp.facets.layers import Layers, order_layers
from origami_nlp.facets.linear import dense
from origami_nlp.facets.local import PatternLocal
from origami_nlp.facets.meeting import needed_rows, touch_words, touches_at
from origami_nlp.facets.touches import Placed, Touch
from origami_nlp.numerics import CLOSES, OUTSIDE, TOUCHES
from origami_nlp.pattern import Pattern
from origami_nlp.programme import (
    ClosedContacts,
    Contact,
    ContactWords,
    Local,
    LoopClosure,
    Parameters,
    fold_limit,
)


class Sheet(PatternEquations):
    """The nonlinear programme of a pattern (`programme.protocol.Programme`); states are its n fold angles.

    Parameters
    ----------
    pattern
        With its springs.
    contact
        Whether facets must not cross; without, only fold limits count.

    Attributes
    ----------
    contact
        As given.
    multiplicity
        Ones, [n]: every crease stands for itself.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.facets import Sheet
    >>> problem = Sheet(o.examples.pattern("miura", 1, 2).with_springs(1.0, 0.5))
    >>> o.classify(o.State(problem, np.array([-0.5]))).verdict
    'minimum'
    """

    symmetry = "none"
    bound = math.pi
    has_limits = True

    def __init__(self, pattern: Pattern, contact: bool = True) -> None:
        super().__init__(pattern)
        self.contact = contact
        self.multiplicity = np.ones(self.size, int)
        self._load = np.zeros(self.size)
        self._touches: list[tuple[Touch, Touch]] = []
        self._numbers: dict[Touch, int] = {}
        self._seen: dict[str, tuple[bytes, Any]] = {}

    @cached_property
    def parameters(self) -> Parameters:
        """Springs and load over `scale`."""
        return Parameters(np.zeros(0), self.stiffness, self.pattern.rest, self._load)

    @cached_property
    def root(self) -> np.ndarray:
        """The metric of all fold angles: ones, [n]."""
        return np.ones(self.size)

    @property
    def equation_count(self) -> int:
        """Number of closure equations m; they depend on each other as a rule."""
        return self.closure.count

    @property
    def freedom(self) -> int:
        """Degrees of freedom at least: creases less equations."""
        return max(self.size - self.closure.count, 0)

    @property
    def step_noise(self) -> float:
        """Length of a Newton step [rad] that is only rounding."""
        return max(1e-10, 1e-15 / self.parameters.softness)

    @property
    def own_symmetries(self) -> tuple[tuple[np.ndarray, int], ...]:
        """The identity: images of states are looked for by the search."""
        return ((np.arange(self.size), 1),)

    @cached_property
    def limits(self) -> tuple[Contact, ...]:
        """Both fold limits of every crease."""
        return tuple(Contact("limit", v, side) for v in range(self.size) for side in (-1, 1))

    @property
    def every_gap(self) -> tuple[Contact, ...]:
        """None: gaps are listed where facets meet."""
        return ()

    @property
    def gaps(self) -> tuple[Contact, ...]:
        """None: gaps are listed where facets meet."""
        return ()

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Gradient of the energy over `scale`, [n]."""
        return super().torque(phi) - self._load

    def energy(self, x: np.ndarray) -> float:
        """Energy of a state [n] in the units of the springs, less the work of the load if there is one."""
        return self.scale * (self.scaled_energy(x) - float(self._load @ x))

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Energies of states [..., n], shape [...]."""
        return np.apply_along_axis(self.energy, -1, np.asarray(x))

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> float:
        """Energy of y less that of x, without cancellation for nearby states."""
        return self.scale * float((y - x) @ (0.5 * (self.torque(x) + self.torque(y))))

    def excess(self, x: np.ndarray) -> float:
        """Energy above that of springs at rest, over `scale`."""
        return float(self.parameters.excess(x))

    def expand(self, x: np.ndarray) -> np.ndarray:
        """Return the fold angles, which the variables are."""
        return np.asarray(x)

    reduce = expand

    def creases_of(self, variable: int) -> tuple[int, ...]:
        """Return the crease (1-based) of a variable (0-based)."""
        return (variable + 1,)

    def local(self, x: np.ndarray) -> PatternLocal:
        """Evaluate values and first derivatives at a state [n]; dense."""
        c, j = self.closure(x)
        none, size = np.zeros((0, self.size)), self.crossings.size
        known: dict[Contact, tuple[float, np.ndarray]] = self.kept("gaps", x, dict)
        return PatternLocal(
            x, self.torque(x), c, j, none[:, 0], none, self.placed, self.touch, size, known
        )

    def constraints(
        self, x: np.ndarray, contacts: Sequence[Contact] = ()
    ) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate closure and the openings of contacts, [..., m + r], and their Jacobian [..., m + r, n]."""
        if x.ndim > 1:
            each = [self.constraints(one, contacts) for one in x]
            return np.array([v for v, _ in each]), np.array([j for _, j in each])
        local = self.local(x)
        values, slopes = local.openings(contacts)
        return np.append(local.closure, values), np.vstack([local.closure_jacobian, slopes])

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
            h = weight * dense(self.hessian(x, multipliers[:m] / weight))
        else:
            h = -dense(self.closure.hessian(x, multipliers[:m]))
        for force, contact in zip(multipliers[m:], contacts, strict=True):
            if force and not contact.is_limit:
                touch, place = self.touch(contact), self.placed(x)
                creases, _ = touch.slopes(place)
                h[np.ix_(creases, creases)] -= force / self.crossings.size * touch.bends(place)
        return h

    def loops(self, x: np.ndarray) -> list[LoopClosure]:
        """Return closure to second order at a state [n], of each vertex and hole by itself."""
        return self.closure.loops(x)

    def on_sheet(self, x: np.ndarray) -> Any:
        """Tell whether states [..., n] are on the sheet q = +1."""
        if x.ndim == 1:
            return self.closure.on_sheet(x)
        return np.array([self.closure.on_sheet(one) for one in x], bool)

    def contact_of(self, touch: Touch) -> Contact:
        """Return the contact of a touch."""
        same = replace(touch, sign=1.0)
        number = self._numbers.setdefault(same, len(self._touches))
        if number == len(self._touches):
            self._touches.append((same, replace(same, sign=-1.0)))
        return Contact("gap", number, 1 if touch.sign > 0 else -1)

    def touch(self, contact: Contact) -> Touch:
        """Return the touch of a contact."""
        return self._touches[contact.index][contact.side < 0]

    def kept(self, what: str, x: np.ndarray, make: Any) -> Any:
        """Return what is asked for several times of one state."""
        key = x.tobytes()
        if what not in self._seen or self._seen[what][0] != key:
            self._seen[what] = key, make()
        return self._seen[what][1]

    def placed(self, x: np.ndarray) -> Placed:
        """Return the facets in space at a state."""
        placed: Placed = self.kept("placed", x, lambda: Placed(self.crossings.poses, x))
        return placed

    def faces(self, x: np.ndarray) -> Faces:
        """Return the facets that lie face to face at a state in which no facets cross."""
        faces: Faces = self.kept("faces", x, lambda: Faces(self, x))
        return faces

    @property
    def sparse(self) -> bool:
        """Whether the pattern is too large for singular values and kernels."""
        return self.size > MOST_DENSE

    def jacobian(self, x: np.ndarray) -> Matrix:
        """Jacobian of closure, [m, n]; sparse for all but small patterns."""
        return self.closure.jacobian(x)

    def with_contact(self, contact: bool) -> Sheet:
        """Return the same programme with facets that must not cross, or may."""
        if contact == self.contact:
            return self
        other = self._other()
        other.contact = contact
        return other

    @property
    def touching(self) -> bool:
        """Whether facets are looked at where they touch."""
        return self.contact and self.size <= MOST_DENSE

    def closed(
        self, x: np.ndarray, tolerance: float = TOUCHES, local: Local | None = None
    ) -> ClosedContacts:
        """Find the contacts of a state that are closed, and the choices that keep facets apart."""
        shut = np.flatnonzero(math.pi - np.abs(x) <= tolerance)
        limits = tuple(fold_limit(int(v), x[v]) for v in shut)
        if not self.touching:
            return ClosedContacts(limits, (), ())
        faces, place = self.faces(x), self.placed(x)

        def closed(pair: int, above: bool) -> list[Contact]:
            every = faces.touches(pair, above)
            near = CLOSES * self.crossings.size
            return [self.contact_of(t) for t in every if t.gap(place) <= near]

        meeting = [self.contact_of(t) for t in touches_at(self, x, shut)]
        known = [c for pair, above in faces.known for c in closed(pair, above)]
        base = self._needed(x, (*limits, *meeting), known)
        edges = choices(self.features, place)
        branches: list[tuple[tuple[Contact, ...], ...]]
        branches = [tuple((self.contact_of(t),) for t in choice) for choice in edges]
        branches += [(tuple(closed(k, False)), tuple(closed(k, True))) for k in faces.open]
        whole = not (meeting or known or branches or faces.reason)
        return ClosedContacts(base, tuple(branches), (), complete=whole)

    def _needed(
        self, x: np.ndarray, sure: tuple[Contact, ...], more: Iterable[Contact]
    ) -> tuple[Contact, ...]:
        """Leave out contacts that stay open to first order as long as the others do."""
        rows = [*dict.fromkeys((*sure, *more))]
        if len(rows) == len(sure):
            return sure
        keep = needed_rows(self.local(x).openings(rows)[1] @ self.kernel(x), len(sure))
        return tuple(c for c, on in zip(rows, keep, strict=True) if on)

    def to_second_order(self, contacts: tuple[Contact, ...]) -> tuple[Contact, ...]:
        """Return contacts that stay open to second order too: corners of overlaps are moved inside both facets."""
        moved = []
        for contact in contacts:
            touch = None if contact.is_limit else self.touch(contact)
            moved.append(self.contact_of(touch.inside()) if isinstance(touch, Lying) else contact)
        return tuple(moved)

    def about_to_close(self, x: np.ndarray, length: float) -> tuple[Contact, ...]:
        """Return contacts that are open, but closed by a step of `length` [rad] at most."""
        slack = math.pi - np.abs(x)
        near = np.flatnonzero((slack > TOUCHES) & (slack <= 2 * length))
        found = [fold_limit(int(v), x[v]) for v in near]
        if self.touching:
            facing = self.features.facing(self.placed(x), 2 * length)
            found += [self.contact_of(t) for t, gap in facing if gap > TOUCHES]
        return tuple(found)

    def beyond(self, x: np.ndarray, tolerance: float = OUTSIDE) -> tuple[Contact, ...]:
        """Return the fold limits that a state is beyond by more than `tolerance`."""
        over = np.flatnonzero(np.abs(x) > math.pi + tolerance)
        return tuple(fold_limit(int(v), x[v]) for v in over)

    def guess(self, x: np.ndarray, pull: np.ndarray, pair_force: object) -> tuple[Contact, ...]:
        """Guess which contacts an answer of a solver closes: slack smaller than force, or both tiny."""
        slack = math.pi - np.abs(x)
        shut = np.flatnonzero((slack <= 1e-6) | ((slack <= 1e-2) & (np.abs(pull) > slack)))
        found = [fold_limit(int(v), x[v]) for v in shut]
        if self.touching:
            facing = self.features.facing(self.placed(x), 1e-6, INSIDE)
            found += [self.contact_of(t) for t, _ in facing]
        return tuple(found)

    def together(self, x: np.ndarray, contacts: Sequence[Contact]) -> list[tuple[Contact, ...]]:
        """Return the gaps as one set: facets that touch at several places may stay so at all of them."""
        return [tuple(contacts)] if len(contacts) > 1 else []

    def crossed(self, x: np.ndarray, tolerance: float = OUTSIDE) -> tuple[tuple[int, int], ...]:
        """Return the pairs of facets (0-based) that cross at a state."""
        return tuple(self.crossings.find(x)) if self.contact else ()

    def refuses(self, x: np.ndarray, tolerance: float = OUTSIDE) -> str:
        """Say why a closed state is not admissible; "" where it is: sheet, fold limits, crossings, order of layers."""
        if not self.on_sheet(x):
            return "closes on the other sheet, q = -1, round a vertex"
        if (np.abs(x) > math.pi + tolerance).any():
            return "a fold angle is beyond pi"
        crossed = self.crossed(x)
        if crossed:
            many = f"{len(crossed)} pairs of facets" if len(crossed) > 1 else "two facets"
            return f"{many} pass through each other"
        if not self.contact:
            return ""
        return "" if self._layers(x).verdict == "ordered" else self._layers(x).reason

    def _layers(self, x: np.ndarray) -> Layers:
        layers: Layers = self.kept("layers", x, lambda: order_layers(self, x))
        return layers

    def doubt(self, x: np.ndarray) -> str:
        """Say why it is not known whether a closed state is admissible; "" where it is."""
        if not self.contact or self.crossed(x):
            return ""
        if self._layers(x).verdict == "not decided":
            return self._layers(x).reason
        if not self.touching:
            return ""
        place, shut = self.placed(x), np.flatnonzero(math.pi - np.abs(x) <= TOUCHES)
        gaps = (t.gap(place) / self.crossings.size for t in touches_at(self, x, shut))
        deepest = min([self.faces(x).reach(), *gaps])
        if deepest >= -10 * CLOSES:
            return ""
        return f"facets reach into each other by {-deepest:.1e} of the sheet's size"

    def admissible(self, x: np.ndarray, tolerance: float = OUTSIDE) -> np.ndarray:
        """Tell which closed states [K, n] are admissible; layers are not ordered."""
        good = np.isfinite(x).all(axis=1) & (np.abs(x) <= math.pi + tolerance).all(axis=1)
        for k in np.flatnonzero(good):
            good[k] = self.on_sheet(x[k]) and not self.crossed(x[k])
        return good

    def name(self, contact: Contact) -> str:
        """Say in words which contact it is; creases, facets and corners 1-based."""
        if contact.is_limit:
            return f"phi = {'+' if contact.side > 0 else '-'}pi at crease {contact.index + 1}"
        return touch_words(self.touch(contact))

    def words(self, contact: Contact, x: np.ndarray) -> ContactWords:
        """Say who touches in a contact."""
        if contact.is_limit:
            return ContactWords("fold-limit", (contact.index + 1,), (), self.name(contact))
        touch = self.touch(contact)
        a, b = (f + 1 for f in touch.facets)
        return ContactWords(touch.type, (), (a, b), self.name(contact))

    def weight(self, contact: Contact) -> float:
        """Return what a multiplier is divided by: gaps are over the sheet's size, so that forces are in N."""
        return 1.0 if contact.is_limit else self.crossings.size

    def _other(self) -> Sheet:
        other = copy.copy(self)
        for name in ("parameters", "stiffness"):
            vars(other).pop(name, None)
        other._seen = {}
        return other

    def loaded(self, load: np.ndarray) -> Sheet:
        """Return the same programme with energy U - load . phi; load over `scale`, [n]."""
        other = self._other()
        other._load = np.asarray(load, float)
        return other

    def varied(self, parameters: Parameters, sector_angles: np.ndarray | None = None) -> Sheet:
        """Return the same programme with other springs and loads, over the same `scale`."""
        if sector_angles is not None:
            raise NotImplementedError("sector angles of a pattern are not varied")
        other = self._other()
        stiffness = parameters.stiffness * self.scale
        other.pattern = replace(self.pattern, stiffness=stiffness, rest=parameters.rest)
        other._load = parameters.load
        return other

    def drift(
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact],
        change: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Differentiate the KKT system along a change of `parameters.vector`: of springs and load alone."""
        stiffness, rest, load = change.reshape(3, -1)
        p = self.parameters
        torque = stiffness * (x - p.rest) - p.stiffness * rest - load
        return torque, np.zeros(len(multipliers))
