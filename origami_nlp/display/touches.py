"""Where facets touch, marked in a drawing: a ring at each place, filled where the contact pushes, half where it may."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import to_hex, to_rgb
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from origami_nlp.display.papers import area_of
from origami_nlp.display.style import IDLE, PUSHES, UPPER, patch
from origami_nlp.kkt import ContactForce
from origami_nlp.numerics import CARRIES, INDEPENDENT
from origami_nlp.pattern import Pattern

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PUSH, SHARE, REST = (
    "contact with force",
    "contact forces statically indeterminate",
    "contact without force",
)
RING: dict[str, Any] = {"ls": "", "marker": "o", "ms": 7, "mew": 1.6}
LOOKS: dict[str, dict[str, Any]] = {
    PUSH: {**RING, "mec": PUSHES, "mfc": PUSHES},
    SHARE: {**RING, "mec": PUSHES, "mfc": PUSHES, "mfcalt": "white", "fillstyle": "left"},
    REST: {**RING, "mec": IDLE, "mfc": "white"},
}
"""Marks by how contacts push."""
TINT = 0.3
"""Share of the colour of contacts in that of facets that touch."""
TOUCHING = to_hex(
    tuple(np.average([to_rgb(UPPER), to_rgb(PUSHES)], axis=0, weights=(1 - TINT, TINT)))
)
"""Upper side of facets that touch."""


def touching_facets(contacts: Sequence[ContactForce]) -> list[int]:
    """Return the facets that touch, from 0, each once."""
    return sorted({f - 1 for c in contacts if not c.is_limit for f in c.facets})


def contact_places(
    pattern: Pattern, fold_angles: np.ndarray, contacts: Sequence[ContactForce]
) -> np.ndarray:
    """Return where facets touch in space.

    Parameters
    ----------
    pattern
        The sheet.
    fold_angles
        Of a closed state, [n] [rad].
    contacts
        Of that state; fold limits are left out.

    Returns
    -------
    numpy.ndarray
        A corner on a facet, where two sides meet, or a corner of an overlap, [t, 3].  A side that lies on a facet from
        a corner of it on, and leaves it, touches up to its border: the middle of that stretch is returned.
    """
    from origami_nlp.pattern_problem import PatternCrossings

    crossings = PatternCrossings(pattern)
    turn, shift = crossings.poses.motions(fold_angles)

    def point(corner: int, facet: int) -> np.ndarray:
        return np.asarray(turn[facet] @ pattern.corners[corner] + shift[facet])

    places = []
    for contact in contacts:
        if contact.is_limit:
            continue
        a, b = (f - 1 for f in contact.facets)
        if contact.type == "face-face":
            places.append(turn[b] @ np.array(contact.place) + shift[b])
            continue
        p, q, r, s = (c - 1 for c in contact.corners)
        if contact.type == "vertex-face":
            end = point(p, b)
            ring, own = (_corners(pattern, f) for f in (a, b))
            shared = sorted(set(ring) & set(own))
            if shared:
                start = point(shared[0], a)
                end = start + 0.5 * _within([point(v, a) for v in ring], start, end) * (end - start)
            places.append(end)
        else:
            u, v = point(q, a) - point(p, a), point(s, b) - point(r, b)
            off = point(r, b) - point(p, a)
            share = np.linalg.lstsq(np.column_stack([u, -v]), off, rcond=None)[0][0]
            places.append(point(p, a) + share * u)
    return np.array(places).reshape(-1, 3)


def _corners(pattern: Pattern, facet: int) -> list[int]:
    """Return the corners of the polygons of a facet, from 0."""
    each = zip(pattern.polygons, pattern.facet_of, strict=True)
    return [v for polygon, f in each if f == facet for v in polygon]


def _within(ring: Sequence[np.ndarray], start: np.ndarray, end: np.ndarray) -> float:
    """Return up to which share a segment in the plane of a convex polygon stays in it, at most 1."""
    x = np.array(ring)
    normal = area_of(x)
    inward = np.cross(normal, np.roll(x, -1, axis=0) - x)
    room, gone = np.einsum("qi,qi->q", inward, start - x), inward @ (end - start)
    leaves = gone < -INDEPENDENT * np.abs(inward @ (end - start)).max()
    return float(min(1.0, (room[leaves] / -gone[leaves]).min(initial=1.0)))


def mark_touches(
    axes: Axes, view: np.ndarray, places: np.ndarray, contacts: Sequence[ContactForce]
) -> None:
    """Draw the places of touch of `contact_places` [t, 3], seen by a view [3, 3], each as its contact pushes."""
    around = [withStroke(linewidth=2.5, foreground="white")]
    touches = [c for c in contacts if not c.is_limit]
    for k, ((x, y, _), contact) in enumerate(zip(places @ view.T, touches, strict=True)):
        axes.plot(x, y, **LOOKS[_how(contact)], path_effects=around, zorder=5)
        a, b = contact.facets
        up = 1 if k % 2 == 0 else -1
        axes.annotate(f"{a}|{b}", (x, y), xytext=(0, 9 * up), textcoords="offset points", ha="center",
                      va="bottom" if up > 0 else "top", fontsize=9, path_effects=around, zorder=6)  # fmt: skip


def contact_legend(contacts: Iterable[ContactForce]) -> list[Any]:
    """Return what the marks of contacts mean, those that occur.

    Parameters
    ----------
    contacts
        Of the states that are drawn.

    Returns
    -------
    list of matplotlib artists
        For a legend.
    """
    met = {_how(c) for c in contacts if not c.is_limit}
    marks = [Line2D([], [], label=how, **look) for how, look in LOOKS.items() if how in met]
    return [*marks, patch(TOUCHING, "facets that touch")] if met else marks


def _how(contact: ContactForce) -> str:
    """Describe a contact force, by the least and the largest force that balance the springs."""
    least, most = contact.multiplier_range
    return PUSH if least > CARRIES else SHARE if most > CARRIES else REST
