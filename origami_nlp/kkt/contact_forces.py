"""What closed contacts of a state carry: one multiplier each, and its range where it is not unique."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt.certificates import BranchJudgement
from origami_nlp.kkt.multipliers import Multipliers
from origami_nlp.kkt.state import State
from origami_nlp.numerics import BALANCED, INDEPENDENT, INPUT_TOL, NONZERO
from origami_nlp.problem import STOP, Contact

OMIT = {"omit": True}
"""Of a field that is written to files only where it is not its default."""


@dataclass(frozen=True, repr=False)
class ContactForce(ShortRepr):
    """One closed contact of a state and what it carries.

    Attributes
    ----------
    type
        ``fold-limit``; of a vertex ``facet-pair``; of a sheet ``vertex-face``, ``edge-edge``
        or ``face-face``.
    multiplier
        Lagrange multiplier of the contact, positive where it pushes: a moment [N m per rad of opening, in the scene's
        units] at each single contact, where facets of a pattern touch a force [N m per unit of length]; where contacts
        are dependent, the entry of the multiplier vector of smallest norm.
    multiplier_range
        Smallest and largest value over the set of multipliers; inf where unbounded.
    text
        The contact in words.
    creases
        Who touches, 1-based, all images under the symmetry included for creases at a fold limit; empty where facets
        touch.
    facets
        The two facets that touch, 1-based, of a pattern that of the face first; of a vertex their touching crease is in
        `text`.
    corners
        Where facets of a pattern touch, 1-based: the corner that is on a face and three of the face, or two ends of
        each side; else empty.
    side
        Of facets face to face, as in faceOrders of a FOLD file: +1 where the second one lies on the side of the first
        one's normal, -1 where it lies on the other; else 0.
    place
        Of facets face to face, the point of the second one at which the force acts, in the sheet's reference state.
    contact
        The contact itself, as the problem knows it; None where it was read from a file, and in the states of a
        pattern that a search lists.
    """

    type: str
    multiplier: float
    multiplier_range: tuple[float, Unbounded]
    text: str
    creases: tuple[int, ...] = field(default=(), metadata=OMIT)
    facets: tuple[int, ...] = field(default=(), metadata=OMIT)
    corners: tuple[int, ...] = field(default=(), metadata=OMIT)
    side: int = field(default=0, metadata=OMIT)
    place: tuple[float, ...] = field(default=(), metadata=OMIT)
    contact: Contact | None = field(
        default=None, repr=False, compare=False, metadata={"plain": False}
    )

    @property
    def unique(self) -> bool:
        """Whether the moment is one number, and not any of a range."""
        low, high = self.multiplier_range
        return math.isclose(low, high, rel_tol=INPUT_TOL, abs_tol=NONZERO)

    @property
    def force(self) -> float:
        """The `multiplier`: what the contact carries, positive where it pushes."""
        return self.multiplier

    @property
    def is_limit(self) -> bool:
        """Whether it is a fold limit, and not facets that touch."""
        return self.type == "fold-limit"

    @property
    def is_stop(self) -> bool:
        """Whether it is a stop before facets meet: a fold limit at which no facets lie on each other."""
        return self.is_limit and STOP in self.text.partition(" at crease")[0]

    @property
    def is_force(self) -> bool:
        """Whether it is a force [N m per unit of length], as where facets of a pattern touch, and no moment [N m]."""
        return self.type in ("vertex-face", "edge-edge", "face-face")

    def words(self) -> str:
        """Describe what touches, 1-based, and the moment or force that it carries, or the range of it."""
        what, unit = ("force", "N m per unit of length") if self.is_force else ("moment", "N m")
        said = f"{self.text}: {what} {self.multiplier:.4g} {unit}"
        if self.unique:
            return said
        low, high = self.multiplier_range
        top = "inf" if math.isinf(high) else f"{high:.4g}"
        return f"{said} (any of {low:.4g} to {top})"


def contact_forces(state: State, contacts: Sequence[Contact]) -> tuple[ContactForce, ...]:
    """Return what contacts that are closed at a state carry, each with the range that balances the springs."""
    return _carried(state, tuple(contacts), state.on(contacts).multiplier_set)


def forces_of(state: State, branch: BranchJudgement) -> tuple[ContactForce, ...]:
    """Return what the contacts of a piece carry."""
    return _carried(state, branch.rows, branch.multipliers)


def _carried(state: State, rows: tuple[Contact, ...], m: Multipliers) -> tuple[ContactForce, ...]:
    """Turn contacts and their multipliers into moments."""
    out = []
    model = state.problem
    also: dict[Contact, list[str]] = {}
    for contact, same in state.contacts.implied:
        also.setdefault(same, []).append(model.name(contact))
    stationary = m.residual <= BALANCED * (1 + float(np.abs(m.smallest).max(initial=0)))
    for r, contact in enumerate(rows):
        who = model.words(contact, state.x)
        text = who.text
        if contact in also:
            text += " (so " + ", ".join(sorted(set(also[contact]))) + ")"
        # one multiplier of the reduced problem stands for all images of a contact; scaled energies become the scene's
        unit = model.scale / model.weight(contact)
        # where nothing balances there are no multipliers: the state is isolated, any contact may carry any moment >= 0
        values = (m.smallest[r], m.lower[r], m.upper[r]) if stationary else (0.0, 0.0, math.inf)
        moment, *spread = (float(v * unit) for v in values)
        touching = who.creases, who.facets, who.corners, who.side, who.place
        between = spread[0], spread[1]
        out.append(ContactForce(who.type, moment, between, text, *touching, contact))
    return tuple(out)


def joined_forces(state: State, pieces: list[tuple[ContactForce, ...]]) -> tuple[ContactForce, ...]:
    """Return the contacts of several pieces, each once, with the range of its multiplier on all of them.

    Contacts that meet at one place, with the same slope along closed motions, are one, told in two ways: that of a
    corner on a facet stands for both.  Of the multiplier the least is told: pieces come in no order.
    """
    p, x = state.problem, state.x
    every = (c.contact for piece in pieces for c in piece if c.contact is not None)
    gaps = tuple(dict.fromkeys(c for c in every if not c.is_limit)) if not p.sparse else ()
    same: dict[Contact, Contact] = {}
    if gaps:
        along = state.on(gaps).slopes @ state.kernel / np.array([[p.weight(c)] for c in gaps])
        seen = np.hstack([along, [p.meeting(c, x) for c in gaps]])
        for gap, row in zip(gaps, seen, strict=True):
            first = int(np.flatnonzero(np.abs(seen - row).max(axis=1) <= INDEPENDENT)[0])
            same[gap] = gaps[first]
    found: dict[object, list[tuple[int, ContactForce]]] = {}
    for k, contacts in enumerate(pieces):
        for c in contacts:
            key = same.get(c.contact, c.contact) if c.contact else c.text
            found.setdefault(key, []).append((k, c))
    out = []
    for one in found.values():
        ends = [e for _, c in one for e in c.multiplier_range]
        ends += [0.0] * (len({k for k, _ in one}) < len(pieces))
        first_told = min((c for _, c in one), key=lambda c: (len(c.corners) > 0, c.text))
        least, low, high = min(c.multiplier for _, c in one), min(ends), max(ends)
        # pieces know to rounding what is unique
        one_number = math.isclose(low, high, rel_tol=BALANCED, abs_tol=BALANCED)
        spread = (least, least) if one_number else (low, high)
        out.append(replace(first_told, multiplier=least, multiplier_range=spread))
    return tuple(out)
