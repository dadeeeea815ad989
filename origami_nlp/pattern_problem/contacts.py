"""Contacts of a pattern: fold limits of creases, and gaps between features of facets over the sheet's size.

Of a gap one touch is kept, whichever the side from which it is seen: a contact names it by its number and its side.
What is no single inequality is a choice between several: facets that meet at borders (of several gaps one stays open)
and facets that lie face to face in an order that is not forced.

The pieces of `closed` are larger than the set of states beside the one asked for: gaps that are certain are kept, what
else touches only makes the states beside it fewer.  A minimum of a larger set is one; that a state is not a minimum is
shown by a lower state alone (`ClosedContacts.complete`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from origami_nlp.numerics import ANSWERED, CLOSURE_TOL, CONTACT_TOL, INSIDE, LOADED, OUTSIDE, Matrix
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.borders import choices, without_passing
from origami_nlp.pattern_problem.contact_pairs import ContactPair, FoldedGeometry, gaps_and_rows
from origami_nlp.pattern_problem.equations import MOST_DENSE, PatternEquations
from origami_nlp.pattern_problem.faces import CoplanarContact, Faces
from origami_nlp.pattern_problem.meeting_features import contact_pair_words, needed_rows, touches_at
from origami_nlp.pattern_problem.orbits import Orbits
from origami_nlp.problem import ClosedContacts, Contact, ContactWords, FoldLimits, Local

Choice: TypeAlias = tuple[tuple[Contact, ...], ...]
"""Contacts of which those of one option at least stay open."""


@dataclass(frozen=True, eq=False)
class PatternLocal(Local):
    """Values and first derivatives at one state of a pattern; gaps, over a length, are evaluated once, when asked."""

    placed: Callable[[np.ndarray], FoldedGeometry]
    touch: Callable[[Contact], ContactPair]
    length: float
    known: dict[Contact, tuple[float, np.ndarray]]

    def openings(self, contacts: Sequence[Contact]) -> tuple[np.ndarray, np.ndarray]:
        """How far contacts are open (>= 0 where they are), [r], and the gradients of that, [r, n]."""
        values, slopes = np.zeros(len(contacts)), np.zeros((len(contacts), len(self.x)))
        new = [c for c in contacts if not c.is_limit and c not in self.known]
        if new:
            gaps, rows = gaps_and_rows([self.touch(c) for c in new], self.placed(self.x))
            both = zip(gaps / self.length, rows / self.length, strict=True)
            self.known.update(zip(new, both, strict=True))
        for r, contact in enumerate(contacts):
            if contact.is_limit:
                values[r] = contact.at - contact.side * self.x[contact.index]
                slopes[r, contact.index] = -contact.side
            else:
                values[r], slopes[r] = self.known[contact]
        return values, slopes


MOST_NEAR = 150
"""Pieces up to which it is asked of all pairs at once whether any are near: with more that costs more than it saves."""


class PatternContacts(PatternEquations):
    """Contacts of a pattern, and what is known of its facets at a state.

    Parameters
    ----------
    pattern
        With its springs.
    contact
        Whether facets must not cross; without, only fold limits count.
    orbits
        Of states that keep a symmetry: contacts that are images of each other are one.
    limited
        Whether there are fold limits.

    Attributes
    ----------
    origin
        Where the pattern's corners are counted from, [3]: of one that was moved to its middle, what to add to a place
        before it is reported.
    told
        What describes a contact in the words of one vertex; None for those of a sheet.
    """

    def __init__(
        self,
        pattern: Pattern,
        contact: bool = True,
        orbits: Orbits | None = None,
        limited: bool = True,
    ) -> None:
        super().__init__(pattern, orbits)
        self.contact, self.has_limits = contact, limited
        if not limited:  # each further turn repeats the shape
            self.fold_limits = FoldLimits(*(2 * math.pi * np.outer((-1, 1), np.ones(self.size))))
        self.origin = np.zeros(3)
        self.told: Callable[[Any, ContactPair, np.ndarray | None], str] | None = None
        self._touches: list[tuple[ContactPair, ContactPair]] = []
        self._numbers: dict[object, int] = {}
        self._images: list[int] = []
        self._contacts: dict[ContactPair, Contact] = {}

    @property
    def limits(self) -> tuple[Contact, ...]:
        """Both fold limits of every variable, where there are some."""
        return self.fold_limits.both if self.has_limits else ()

    def local(self, x: np.ndarray) -> PatternLocal:
        """Evaluate values and first derivatives at a state [n]; dense, but for problems that are `sparse`."""
        if self.sparse:
            return self.rows(x)
        found: PatternLocal = self.kept("local", x, lambda: self._dense(x.copy()))
        return found

    def _dense(self, x: np.ndarray) -> PatternLocal:
        c, j = self.closure(x)
        return self._local(x, c, j)

    def rows(self, x: np.ndarray) -> PatternLocal:
        """Evaluate the same with the Jacobian of closure as `jacobian` has it."""
        at = self.closure.turned(x)
        return self._local(x, self.closure.values(x, at), self.closure.jacobian(x, at))

    def _local(self, x: np.ndarray, c: np.ndarray, j: Matrix) -> PatternLocal:
        none, size = np.zeros((0, self.size)), self.crossings.size
        known: dict[Contact, tuple[float, np.ndarray]] = self.kept("gaps", x, dict)
        return PatternLocal(
            x, self.torque(x), c, j, none[:, 0], none, self.placed, self.touch, size, known
        )

    def contact_of(self, touch: ContactPair) -> Contact:
        """Return the contact of a touch."""
        if (known := self._contacts.get(touch)) is not None:
            return known
        # one number for both sides, whichever facet passed on which: a curve of states keeps its contacts by number
        first, many, key = touch, 1, object()
        if self.orbits is None:
            key = replace(touch, sign=1.0)
        else:
            images = self.orbits.images_of(touch)
            (*key, _), first = next(iter(images.items()))
            key, many = tuple(key), len(images)
        number = self._numbers.setdefault(key, len(self._touches))
        if number == len(self._touches):
            same = replace(first, sign=1.0)
            self._touches.append((same, replace(same, sign=-1.0)))
            self._images.append(many)
        contact = self._contacts[touch] = Contact("gap", number, 1 if first.sign > 0 else -1)
        return contact

    def touch(self, contact: Contact) -> ContactPair:
        """Return the touch of a contact."""
        return self._touches[contact.index][contact.side < 0]

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

    @property
    def touching(self) -> bool:
        """Whether facets are looked at where they touch."""
        return self.contact and self.size <= MOST_DENSE

    def apart(self, x: np.ndarray) -> bool:
        """Return whether no facets are near each other but at creases: then nothing touches or crosses."""
        found: bool = self.kept("apart", x, lambda: self._apart(x))
        return found

    def _apart(self, x: np.ndarray) -> bool:
        c = self.crossings
        if c.cell is not None or len(c.pieces) > MOST_NEAR:
            return False
        return not c.near(x, 2 * INSIDE * c.size).any()

    def closed(self, x: np.ndarray, tolerance: float = CONTACT_TOL) -> ClosedContacts:
        """Find the contacts of a state that are closed, and the choices that keep facets apart."""
        near = (self.fold_limits.room(x) <= tolerance) & self.has_limits
        at_limit, limits = np.flatnonzero(near), self.fold_limits.contacts(x, near)
        if not self.touching or (tolerance <= CONTACT_TOL and self.apart(x)):
            return ClosedContacts(limits, (), ())
        faces, place = self.faces(x), self.placed(x)
        # states that are exact close gaps to rounding; of others it is asked what is closed next to them
        within = CLOSURE_TOL if tolerance <= CONTACT_TOL else tolerance

        def closed(pair: int, above: bool) -> list[Contact]:
            near = CLOSURE_TOL * self.crossings.size
            return [self.contact_of(t) for t in faces.closed(pair, above, near)]

        meeting = [self.contact_of(t) for t in touches_at(self, x, at_limit, within)]
        known = [c for each, above in faces.known for c in closed(each, above)]
        edges = choices(self.features, place, 0.0 if tolerance <= CONTACT_TOL else tolerance)
        # a choice: one of these gaps stays open, whichever; the set of states is the union over them
        branches = [
            tuple(tuple(self.contact_of(t) for t in option) for option in choice)
            for choice in without_passing(self.features, edges)
        ]
        branches += [(tuple(closed(k, False)), tuple(closed(k, True))) for k in faces.open]
        if self.orbits is not None:
            branches, forced = self._each_once(branches)
            meeting, known = [*dict.fromkeys(meeting)], [*dict.fromkeys([*known, *forced])]
        base = self._needed(x, (*limits, *meeting), known)
        whole = not (meeting or known or branches or faces.reason)
        return ClosedContacts(base, tuple(branches), (), complete=whole)

    @staticmethod
    def _each_once(choices: list[Choice]) -> tuple[list[Choice], list[Contact]]:
        """Return choices of which none is the image of another, and contacts of those that leave no choice."""
        found: dict[frozenset[frozenset[Contact]], Choice] = {}
        for choice in choices:
            options = {frozenset(option): tuple(dict.fromkeys(option)) for option in choice}
            found.setdefault(frozenset(options), tuple(options.values()))
        several = [choice for choice in found.values() if len(choice) > 1]
        return several, [c for choice in found.values() if len(choice) == 1 for c in choice[0]]

    def _needed(
        self, x: np.ndarray, sure: tuple[Contact, ...], more: Iterable[Contact]
    ) -> tuple[Contact, ...]:
        """Leave out contacts that stay open to first order as long as the others do."""
        rows = [*dict.fromkeys((*sure, *more))]
        if len(rows) == len(sure):
            return sure
        # along closed motions: a contact may follow from others only there
        slopes = self.local(x).openings(rows)[1] / self.root
        keep = needed_rows(slopes @ self.kernel(x), len(sure))
        return tuple(c for c, on in zip(rows, keep, strict=True) if on)

    def to_second_order(self, contacts: tuple[Contact, ...]) -> tuple[Contact, ...]:
        """Return contacts that stay open to second order too: corners of overlaps are moved inside both facets."""
        moved = []
        for contact in contacts:
            touch = None if contact.is_limit else self.touch(contact)
            moved.append(
                self.contact_of(touch.inside()) if isinstance(touch, CoplanarContact) else contact
            )
        return tuple(moved)

    def about_to_close(self, x: np.ndarray, length: float) -> tuple[Contact, ...]:
        """Return contacts that are open, but closed by a step of `length` [rad] at most."""
        slack = self.fold_limits.room(x)
        # twice the step: room for the way back onto closure
        near = (slack > CONTACT_TOL) & (slack <= 2 * length) & self.has_limits
        found = list(self.fold_limits.contacts(x, near))
        if self.touching:
            facing = self.features.facing(self.placed(x), 2 * length)
            found += [self.contact_of(t) for t, gap in facing if gap > CONTACT_TOL]
        return tuple(found)

    def within(self, x: np.ndarray, tolerance: float) -> np.ndarray:
        """Return which fold angles [..., n] are within the limits that are imposed, up to a tolerance."""
        return self.fold_limits.inside(x, tolerance) | (not self.has_limits)

    def beyond(self, x: np.ndarray, tolerance: float = OUTSIDE) -> tuple[Contact, ...]:
        """Return the fold limits that a state is beyond by more than `tolerance`."""
        return self.fold_limits.contacts(x, ~self.within(x, tolerance))

    def guess(self, x: np.ndarray, pull: np.ndarray) -> tuple[Contact, ...]:
        """Guess which contacts an answer of a solver closes: slack smaller than force, or both tiny."""
        slack = self.fold_limits.room(x)
        at_limit = (slack <= ANSWERED) | ((slack <= LOADED) & (np.abs(pull) > slack))
        found = list(self.fold_limits.contacts(x, at_limit & self.has_limits))
        if self.touching:
            facing = self.features.facing(self.placed(x), ANSWERED, INSIDE)
            found += [self.contact_of(t) for t, _ in facing]
        return tuple(found)

    def name(self, contact: Contact) -> str:
        """Describe which contact it is; creases, facets and corners 1-based."""
        if contact.is_limit:
            creases = self.creases_of(contact.index)
            where = f"at crease{'s' * (len(creases) > 1)} " + ", ".join(map(str, creases))
            return f"phi = {contact.where} {where}"
        touch = self.touch(contact)
        if self.told is not None:
            return self.told(self, touch, None)
        return contact_pair_words(touch, self._place(touch))

    def words(self, contact: Contact, x: np.ndarray) -> ContactWords:
        """Name the facets and creases that touch in a contact."""
        if contact.is_limit:
            creases = self.creases_of(contact.index)
            return ContactWords("fold-limit", creases, (), self.name(contact))
        touch = self.touch(contact)
        a, b = (f + 1 for f in touch.facets)
        if self.told is not None:
            return ContactWords("facet-pair", (), (a, b), self.told(self, touch, x))
        corners = () if isinstance(touch, CoplanarContact) else tuple(c + 1 for c in touch.corners)
        side = int(touch.sign) if isinstance(touch, CoplanarContact) else 0
        text, place = self.name(contact), self._place(touch)
        return ContactWords(touch.type, (), (a, b), text, corners, side, place)

    def _place(self, touch: ContactPair) -> tuple[float, ...]:
        """Return where the second of two facets that lie face to face is pressed, in the user's coordinates."""
        if not isinstance(touch, CoplanarContact):
            return ()
        return tuple((np.array(touch.place) + self.origin).tolist())

    def meeting(self, contact: Contact, x: np.ndarray) -> np.ndarray:
        """Return where the features of a gap meet at a state, [3], over the sheet's size."""
        return self.touch(contact).place_in_space(self.placed(x)) / self.crossings.size

    def margin(self, contact: Contact, x: np.ndarray) -> float:
        """How far inside each other the features of a contact are at a state, over their size; see `Features`."""
        touch = None if contact.is_limit else self.touch(contact)
        if touch is None or isinstance(touch, CoplanarContact):
            return math.inf
        return self.features.margin(touch, self.placed(x))

    def creases_of(self, variable: int) -> tuple[int, ...]:
        """Return the creases (1-based) that follow a variable (0-based)."""
        if self.orbits is None:
            return (variable + 1,)
        return tuple((np.flatnonzero(self.orbits.orbit == variable) + 1).tolist())

    def weight(self, contact: Contact) -> float:
        """Return what a multiplier is divided by: single contacts that it stands for, gaps over the sheet's size.

        So moments are in N m, forces in N.
        """
        if contact.is_limit:
            return float(self.multiplicity[contact.index])
        return self.crossings.size * self._images[contact.index]
