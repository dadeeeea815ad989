"""The contacts of a state: which are closed, what they carry, and between which bounds where that is not unique.

Only what is certain goes into a certificate.  Where features meet inside each other, facets that do not cross keep the
gap open, so that states beside a state that do not cross lie among those that closure and these gaps allow; what else
touches, at borders or face to face, only makes them fewer.  A strict minimum of a set is one of its parts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.facets import INSIDE, Choice, Features, Lying, Placed, Sheet, Touch, choices
from origami_nlp.numerics import (
    CLOSES,
    DEPENDENT,
    INDEPENDENT,
    SAME,
    extremes,
    nonnegative_least_squares,
    unbounded,
)
from origami_nlp.sheets.descent import AT_LIMIT
from origami_nlp.sheets.rows import Rows
from origami_nlp.sheets.state import SheetContact

SEEN = 1e-9
"""Gaps, over the sheet's size, within which features are looked at."""


@dataclass(frozen=True, eq=False)
class Balance:
    """Forces of closed contacts that balance the springs as well as can be.

    Attributes
    ----------
    forces
        Over the mean stiffness, [r]; >= 0.
    left
        Torque that closure and contacts leave, over the mean stiffness, [n].
    columns
        Torques of unit forces along free motions, of length one, [t, r], and those lengths, [r].
    """

    forces: np.ndarray
    left: np.ndarray
    columns: np.ndarray
    lengths: np.ndarray

    @property
    def unique(self) -> bool:
        """Whether no other forces give the same torque."""
        values = np.linalg.svd(self.columns, compute_uv=False)
        return self.columns.shape[1] == int((values > DEPENDENT).sum())

    def choices(self) -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
        """Return forces that give the same torque, and the least and largest force of each contact, inf if unbounded.

        Returns
        -------
        forces : list of numpy.ndarray
            Corners of the set, [r] each.
        least, most : numpy.ndarray
            Shape [r].
        """
        if self.unique:
            return [self.forces], self.forces, self.forces
        _, values, vt = np.linalg.svd(self.columns, full_matrices=False)
        rows = vt[values > DEPENDENT]
        bounded = ~unbounded(rows)
        felt = np.where(np.isfinite(self.lengths), self.lengths, 0.0)
        corners = np.array(extremes(rows, self.forces * felt, bounded))
        corners = corners / self.lengths
        return list(corners), corners.min(axis=0), np.where(bounded, corners.max(axis=0), math.inf)


def closed_contacts(sheet: Sheet, phi: np.ndarray, touching: bool = True) -> Rows:
    """Return the fold limits and gaps that are closed at a state.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state, [n] [rad].
    touching
        Whether features of facets are looked at.

    Returns
    -------
    Rows
        Gaps of features that meet inside each other; those that fold limits keep open are left to them.
    """
    limits = np.flatnonzero(np.abs(np.abs(phi) - math.pi) <= AT_LIMIT)
    features, touches = sheet.features, []
    if touching:
        place = Placed(sheet.crossings.poses, phi)
        for touch, gap in features.facing(place, SEEN, INSIDE):
            row = touch.row(place)
            others = np.abs(np.delete(row, limits)).max(initial=0.0)
            opened = (-np.sign(phi[limits]) * row[limits]).min(initial=0.0)  # less by a crease
            if gap <= CLOSES and max(others, -opened) > INDEPENDENT * sheet.crossings.size:
                touches.append(touch)
    return Rows.at(sheet, phi, limits, _without_borders(features, touches))


def _without_borders(features: Features, touches: list[Touch]) -> list[Touch]:
    """Leave out sides on borders of a facet that lie on it from a corner of it on: one contact, told twice."""
    lying = [(t.facets[0], t.corners[0]) for t in touches if t.type == "vertex-face"]

    def told(touch: Touch) -> bool:
        a, b, c, d = touch.corners
        return any(
            end == corner and {start, *border} <= features.rings[facet]
            for facet, corner in lying
            for start, end, border in (
                (a, b, (c, d)),
                (b, a, (c, d)),
                (c, d, (a, b)),
                (d, c, (a, b)),
            )
        )

    return [t for t in touches if t.type == "vertex-face" or not told(t)]


def closed_choices(sheet: Sheet, phi: np.ndarray) -> list[Choice]:
    """Return what keeps facets apart that meet at borders: of each choice one gap at least stays open.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state in which no facets cross, [n] [rad].

    Returns
    -------
    list of tuple of Touch
        Without those that have a gap which is closed on every piece anyway.
    """
    return choices(sheet.features, Placed(sheet.crossings.poses, phi))


def balance(sheet: Sheet, phi: np.ndarray, rows: Rows, z: np.ndarray) -> Balance:
    """Balance the springs of a closed state by contacts; z is a basis of what closure allows, [n, t]."""
    torque = sheet.torque(phi)
    columns = (rows.slopes @ z).T
    lengths = np.linalg.norm(columns, axis=0)
    lengths = np.where(lengths > INDEPENDENT, lengths, math.inf)  # closure keeps it closed
    columns = columns / lengths
    forces = nonnegative_least_squares(columns, z.T @ torque) / lengths
    left = z @ (z.T @ (torque - rows.slopes.T @ forces))
    return Balance(forces, left, columns, lengths)


def told_contacts(sheet: Sheet, rows: Rows, found: Balance) -> tuple[SheetContact, ...]:
    """Return the contacts with what they carry, in the units of the springs."""
    _, least, most = found.choices()
    out = []
    for k, (force, low, high) in enumerate(zip(found.forces, least, most, strict=True)):
        limit = k < len(rows.limits)
        unit = sheet.scale / (1.0 if limit else sheet.crossings.size)
        between = None if found.unique else (float(low * unit), float(high * unit))
        if limit:
            where: tuple[int, ...] = (int(rows.limits[k]),)
            out.append(SheetContact("fold-limit", where, float(force * unit), (), between))
        else:
            touch = rows.touches[k - len(rows.limits)]
            if isinstance(touch, Lying):
                lies = (), between, int(touch.sign), touch.place
                out.append(SheetContact(touch.type, touch.facets, float(force * unit), *lies))
                continue
            contact = touch.type, touch.facets, float(force * unit), touch.corners, between
            out.append(SheetContact(*contact))
    return tuple(out)


def joined_contacts(told: Sequence[tuple[SheetContact, ...]]) -> tuple[SheetContact, ...]:
    """Return the contacts of several pieces, each once, with bounds of what it carries on all."""
    found: dict[object, list[SheetContact]] = {}
    for contacts in told:
        for c in contacts:
            found.setdefault((c.type, c.where, c.corners, c.side, c.place), []).append(c)
    out = []
    for same in found.values():
        ends = [e for c in same for e in (c.between or (c.force, c.force))]
        ends += [0.0] * (len(same) < len(told))
        unique = max(ends) - min(ends) <= SAME * max(ends)
        out.append(replace(same[0], between=None if unique else (min(ends), max(ends))))
    return tuple(out)
