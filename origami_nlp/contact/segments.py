"""Metastable segments: stretches of a contact boundary along which the energy is nearly flat.

A boundary is followed from every stable state with a closed contact (`continuation.follow_boundary`), the contact
held.  A stretch of it is metastable where, at every point,

- |dU/ds| / (pi sum k) <= 5e-3: the paper's own tolerance for a stationary state;
- |d2U/ds2| / (sum k) <= 5e-2: then the slope needs at least 0.1 pi rad = 18 degrees of arclength to cross half of
  that band, so that the flat part is long on the scale of a fold angle (5e-3 pi / 5e-2 = 0.1 pi).  N equal
  springs along a straight path would give 1/N, 0.17 for degree 6;
- every held contact pushes (its multiplier is positive): the state is pinned across the boundary.

All three are free of units: they do not change with the scale of stiffness, and s is a fold angle.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.continuation import BoundaryCurve, follow_boundary
from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.io import OneBased, ShortRepr
from origami_nlp.kkt import Stratum
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import BALANCED, NEAR_CONTACT, NEAR_SINGULAR_TOL
from origami_nlp.pattern import Scene

SLOPE = 5e-3
"""Largest |dU/ds| / (pi sum k) of a metastable segment (the paper's tolerance for stationarity)."""
STIFFNESS = 5e-2
"""Largest |d2U/ds2| / (sum k) of a metastable segment."""


@dataclass(frozen=True, repr=False)
class Segment(ShortRepr):
    """One metastable stretch of a boundary curve.

    Attributes
    ----------
    curve
        Position in `SegmentReport.curves`.
    contacts
        That are closed on it.
    start, end
        Arclength [rad].
    states
        Numbers (1-based) of the stable states on it.
    energy_change
        Largest less smallest energy on it.
    slope, stiffness
        Largest |dU/ds| / (pi sum k) and |d2U/ds2| / (sum k) on it.
    springs
        Largest t . K t / (sum k) on it: above the threshold, only cancellation between springs and the bend of
        the boundary makes it flat; below, the creases that move are soft anyway.
    moment
        Smallest contact moment on it [N m].
    """

    ALSO = ("length",)

    curve: OneBased = field(metadata=shown())
    contacts: str = field(metadata=shown("contact"))
    start: float = field(metadata=shown("from s", "rad", ".2f"))
    end: float = field(metadata=shown("to s", "rad", ".2f"))
    states: tuple[int, ...] = field(metadata=shown("states"))
    energy_change: float = field(metadata=shown("energy change", "J", ".3g"))
    slope: float = field(metadata=shown("slope", spec=".2g"))
    stiffness: float = field(metadata=shown("stiffness", spec=".2g"))
    springs: float = field(metadata=shown("of springs", spec=".2g"))
    moment: float = field(metadata=shown("moment", "N m", ".3g"))

    @property
    def length(self) -> float:
        """Arclength [rad] in the space of all N fold angles."""
        return self.end - self.start


@dataclass(frozen=True, repr=False)
class SegmentReport(Report):
    """Boundary curves of a scene, the stable states on them, and their metastable segments.

    Attributes
    ----------
    scene
        The scene.
    curves
        The contact boundaries that were followed.
    states
        For each curve the numbers (1-based) of the minima that lie on it.
    segments
        In order of curve and arclength.
    """

    scene: Scene
    curves: tuple[BoundaryCurve, ...]
    states: tuple[tuple[int, ...], ...]
    segments: tuple[Segment, ...]

    SCHEMA, READS, ROWS = "origami-nlp/contacts/4", False, "segments"

    @property
    def length(self) -> float:
        """Total length of all metastable segments [rad]."""
        return sum(segment.length for segment in self.segments)

    @property
    def verdict(self) -> str:
        """How many segments there are, and what counts as one."""
        return (
            f"{len(self.segments)} metastable segment(s) on {len(self.curves)} contact boundaries: |dU/ds| "
            f"/ (pi sum k) <= {SLOPE:g}, |d2U/ds2| / (sum k) <= {STIFFNESS:g}, every contact pushes"
        )

    def report_sections(self) -> Iterator[Section]:
        """Return the metastable segments, or that there are none."""
        yield record_table(self.segments, self.verdict) if self.segments else self.verdict


def find_segments(result: MinimaResult) -> SegmentReport:
    """Follow the contact boundaries of a scene from its stable states, and find their metastable segments.

    Curves from a state whose contacts push end where one of them stops to; where a state only touches (its
    contacts carry nothing) each contact is held alone, and the curve goes on through changes of sign.

    Parameters
    ----------
    result
        Of `find_minima`.

    Returns
    -------
    SegmentReport
        The curves, the states on them, and their metastable segments.

    Raises
    ------
    OptionError
        If the result is not that of one vertex.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> [curve.contacts for curve in o.find_segments(result).curves]
    [('phi = -pi at crease 1',), ('phi = -pi at crease 4',)]
    """
    check_type("result", result, MinimaResult)
    scene, curves = result.scene, list[BoundaryCurve]()
    states: list[list[int]] = []
    for number, minimum in enumerate(result.minima, start=1):
        state = result.state_of(minimum)
        pinned = any(contact.multiplier_range[1] > 0 for contact in minimum.contacts)
        choices = [rows for rows in state.pieces if rows]
        if not pinned:  # alternatives that describe one boundary are both listed
            choices = list(dict.fromkeys((row,) for rows in choices for row in rows))
        for held in map(state.on, choices):
            known = _on_known(held, curves)
            if known is None:
                curve = follow_boundary(held, stop_at_release=pinned)
                if curve is None or len(curve.s) < 2:
                    continue
                known = len(curves)
                curves.append(curve)
                states.append([])
            if number not in states[known]:
                states[known].append(number)
    angles = [np.array(m.fold_angles) for m in result.minima]
    total = sum(scene.stiffness)
    segments = [s for k, c in enumerate(curves) for s in flat_parts(c, k, total, angles)]
    return SegmentReport(scene, tuple(curves), tuple(map(tuple, states)), tuple(segments))


def _on_known(held: Stratum, curves: list[BoundaryCurve]) -> int | None:
    """Return the curve that already runs along a state with the same contacts closed, if there is one."""
    model, x = held.state.problem, held.state.x
    for number, curve in enumerate(curves):
        at = curve.states
        distance = np.linalg.norm((at - x) * model.root, axis=1)
        k = int(distance.argmin())
        if distance[k] > np.abs(np.diff(curve.s)).max(initial=NEAR_SINGULAR_TOL):
            continue
        # the same boundary may be described by other contacts: they stay closed three points to either side
        near = (at[max(k - 3, 0)], at[min(k + 3, len(at) - 1)])
        values = [model.local(y).openings(held.contacts)[0] for y in near]
        if np.abs(values).max() <= NEAR_CONTACT:
            return number
    return None


def flat_parts(
    curve: BoundaryCurve, number: int, total: float, angles: Sequence[np.ndarray]
) -> list[Segment]:
    """Cut the metastable stretches out of one curve; their ends are interpolated between points.

    Parameters
    ----------
    curve
        With energies.
    number
        Of the curve, as `Segment.curve`.
    total
        Sum of all stiffnesses.
    angles
        Fold angles of the minima, [N] each [rad].

    Returns
    -------
    list of Segment
        In order of arclength.
    """
    # paper, eq. 3.5 and 3.6, free of units
    steep = np.abs(curve.slope) / (math.pi * total)
    bent = np.abs(curve.stiffness) / total
    excess = np.maximum(steep / SLOPE, bent / STIFFNESS) - 1
    # runs of true: where the difference is 1 one begins, where it is -1 one has ended
    flat = (excess <= 0) & curve.pressed
    out = []
    edges = np.flatnonzero(np.diff(np.r_[False, flat, False].astype(int)))
    for first, last in zip(edges[::2], edges[1::2] - 1, strict=True):
        start = _edge(curve, excess, first, first - 1)
        end = _edge(curve, excess, last, last + 1)
        if end <= start:
            continue
        part = slice(first, last + 1)
        near = [np.linalg.norm(curve.fold_angles[part] - phi, axis=1).min() for phi in angles]
        on = tuple(number for number, far in enumerate(near, start=1) if far <= NEAR_CONTACT)
        change, least = float(np.ptp(curve.energy[part])), float(curve.multipliers[part].min())
        slope, stiffness, springs = (float(v[part].max()) for v in (steep, bent, curve.springs))
        where = number, "; ".join(curve.contacts), start, end, on
        least *= least > BALANCED * total  # where the contact stops pushing only rounding is left
        out.append(Segment(*where, change, slope, stiffness, springs / total, least))
    return out


def _edge(curve: BoundaryCurve, excess: np.ndarray, inside: int, outside: int) -> float:
    """Return the arclength at which a segment ends between a point inside and its neighbour outside."""
    if not 0 <= outside < len(excess):  # end of the curve
        return float(curve.s[inside])
    part = 1.0
    if excess[outside] > 0:
        # linear in between: `excess` changes sign at the end of the segment
        part = -excess[inside] / (excess[outside] - excess[inside])
    if not curve.pressed[outside]:  # where the moment that changes sign vanishes
        here, there = curve.multipliers[inside], curve.multipliers[outside]
        lost = (there <= 0) & (here > 0)
        part = min([part, *(here[lost] / (here[lost] - there[lost]))])
    return float(curve.s[inside] + part * (curve.s[outside] - curve.s[inside]))
