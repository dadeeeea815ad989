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
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.arguments import check_flag, check_number, check_type, check_whole
from origami_nlp.chart import BoundaryLine, chart_of, trace_boundary
from origami_nlp.continuation import BoundaryCurve, correct, follow_boundary
from origami_nlp.display import Content, Poser, Report, Section, record_table, shown
from origami_nlp.io import OneBased, ShortRepr
from origami_nlp.kkt import State, Stratum
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import NEAR_CONTACT, NEAR_SINGULAR_TOL
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem

SLOPE = 5e-3
"""Largest |dU/ds| / (pi sum k) of a metastable segment (the paper's tolerance for stationarity)."""
STIFFNESS = 5e-2
"""Largest |d2U/ds2| / (sum k) of a metastable segment."""
SAMPLES, NEAR = 60, 0.5
"""Random states from which boundaries without a stable state are looked for, of contacts that a step so long [rad]
closes."""
FROM_AFAR = 30
"""Newton steps that take them there."""


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
        For each curve the numbers (1-based) of the minima that it starts from, () where it was found by sampling.
    segments
        In order of curve and arclength.
    slope, stiffness
        The thresholds used.
    """

    scene: Scene
    curves: tuple[BoundaryCurve, ...]
    states: tuple[tuple[int, ...], ...]
    segments: tuple[Segment, ...]
    slope: float
    stiffness: float

    PICTURE, SCHEMA, READS, ROWS = "draw_segments", "origami-nlp/contacts/4", False, "segments"

    @property
    def length(self) -> float:
        """Total length of all metastable segments [rad]."""
        return sum(segment.length for segment in self.segments)

    @property
    def verdict(self) -> str:
        """How many segments there are, and what counts as one."""
        many = len(self.segments)
        return (
            f"{many or 'no'} metastable segment{'s' * (many != 1)} on {len(self.curves)} contact boundaries: |dU/ds| "
            f"/ (pi sum k) <= {self.slope:g}, |d2U/ds2| / (sum k) <= {self.stiffness:g}, every contact pushes"
        )

    def report_sections(self) -> Iterator[Section]:
        """Return the metastable segments, or that there are none."""
        yield record_table(self.segments, self.verdict) if self.segments else self.verdict


def find_segments(
    result: MinimaResult,
    *,
    every_boundary: bool = False,
    slope: float = SLOPE,
    stiffness: float = STIFFNESS,
    seed: int = 0,
) -> SegmentReport:
    """Follow the contact boundaries of a scene from its stable states, and find their metastable segments.

    Curves from a state whose contacts push end where one of them stops to; where a state only touches (its
    contacts carry nothing) each contact is held alone, and the curve goes on through changes of sign.

    Parameters
    ----------
    result
        Of `find_minima`.
    every_boundary
        Also follow contact boundaries on which no stable state lies (two degrees of freedom only): all those
        of the scene's chart where it has one (`chart.trace_boundary`), and those found from random states
        on each contact; no curve then ends where a contact stops pushing.
    slope
        Largest |dU/ds| / (pi sum k) of a metastable segment.
    stiffness
        Largest |d2U/ds2| / (sum k) of a metastable segment.
    seed
        Of the random states.

    Returns
    -------
    SegmentReport
        The curves, the states on them, and their metastable segments.

    Raises
    ------
    OptionError
        If the result is not that of one vertex, or an argument is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> [curve.contacts for curve in o.find_segments(result).curves]
    [('phi = -pi at crease 1',), ('phi = -pi at crease 4',)]
    """
    check_type("result", result, MinimaResult)
    check_flag("every_boundary", every_boundary)
    for name, value in (("slope", slope), ("stiffness", stiffness)):
        check_number(name, value, math.ulp(0.0))
    check_whole("seed", seed, 0)
    scene, model = result.scene, result.model
    curves: list[BoundaryCurve] = []
    states: list[tuple[int, ...]] = []

    def keep(curve: BoundaryCurve | None, *numbers: int) -> None:
        if curve is not None and len(curve.s) > 1:
            curves.append(curve)
            states.append(numbers)

    for number, minimum in enumerate(result.minima, start=1):
        state = result.state_of(minimum)
        pinned = any(contact.multiplier_range[1] > 0 for contact in minimum.contacts)
        for held in _held(state, one_at_a_time=not pinned):
            known = _on_known(held, curves)
            if known is not None:
                if number not in states[known]:
                    states[known] = (*states[known], number)
                continue
            curve = follow_boundary(held, stop_at_release=pinned and not every_boundary)
            keep(curve, number)
    # lines that no stable state lies on: of the chart, then through states drawn at random
    if every_boundary:
        for line in _chart_lines(scene):
            middle = model.reduce(line.fold_angles[len(line.fold_angles) // 2])
            for held in _held(State(model, middle, NEAR_CONTACT), one_at_a_time=True):
                if _on_known(held, curves) is None:
                    keep(follow_boundary(held, stop_at_release=False))
        for held in _boundary_states(model, np.random.default_rng(seed)):
            if _on_known(held, curves) is None:
                keep(follow_boundary(held, stop_at_release=False))
    total = sum(scene.stiffness)
    angles = [np.array(m.fold_angles) for m in result.minima]
    segments = [
        segment
        for number, curve in enumerate(curves)
        for segment in flat_parts(curve, number, total, slope, stiffness, angles)
    ]
    return SegmentReport(scene, tuple(curves), tuple(states), tuple(segments), slope, stiffness)


def _held(state: State, *, one_at_a_time: bool) -> list[Stratum]:
    """Return the sets of contacts to hold at a state; alternatives that describe one boundary are both listed."""
    choices = [rows for rows in state.pieces if rows]
    if one_at_a_time:
        choices = list(dict.fromkeys((row,) for rows in choices for row in rows))
    return [state.on(rows) for rows in choices]


def _on_known(held: Stratum, curves: list[BoundaryCurve]) -> int | None:
    """Return the curve that already runs along a state with the same contacts closed, if there is one."""
    model, x = held.state.problem, held.state.x
    for number, curve in enumerate(curves):
        at = curve.states
        distance = np.linalg.norm((at - x) * model.root, axis=1)
        k = int(distance.argmin())
        step = np.abs(np.diff(curve.s)).max(initial=NEAR_SINGULAR_TOL)
        if distance[k] > step:
            continue
        # the same boundary may be described by other contacts: they stay closed along it
        # three points to either side
        near = (at[max(k - 3, 0)], at[min(k + 3, len(at) - 1)])
        values = [model.local(y).openings(held.contacts)[0] for y in near]
        if np.abs(values).max() <= NEAR_CONTACT:
            return number
    return None


def _chart_lines(scene: Scene) -> tuple[BoundaryLine, ...]:
    """Return all contact boundaries of the scene's chart; none where it has no chart or not all contacts."""
    if scene.contact != "full" or chart_of(scene) is None:
        return ()
    return trace_boundary(scene).lines


def _boundary_states(model: PatternProblem, rng: np.random.Generator) -> Iterator[Stratum]:
    """Yield admissible states with one contact held closed, that were near it or drawn at random."""
    if not model.has_limits or model.dof != 2:
        return
    drawn = [rng.uniform(model.fold_limits.low, model.fold_limits.high) for _ in range(SAMPLES)]
    for x in (model.project(y)[0] for y in drawn):
        for row in (*model.limits, *model.about_to_close(x, NEAR)):
            exact = correct(State(model, x).on((row,)), FROM_AFAR)
            if exact is None or exact.refused:
                continue
            # a crease in the plane of a facet, but beside it, is no contact
            if any(row in choice for choice in exact.pieces):
                yield exact.on((row,))


def flat_parts(
    curve: BoundaryCurve,
    number: int,
    total: float,
    slope: float,
    stiffness: float,
    angles: list[np.ndarray],
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
    slope, stiffness
        The thresholds, as for `find_segments`.
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
    excess = np.maximum(steep / slope, bent / stiffness) - 1
    # runs of true: where the difference is 1 one begins, where it is -1 one has ended
    flat = (excess <= 0) & curve.pressed
    out = []
    edges = np.flatnonzero(np.diff(np.r_[False, flat, False].astype(int)))
    for first, last in zip(edges[::2], edges[1::2] - 1, strict=True):
        start = _edge(curve, excess, first, first - 1)
        end = _edge(curve, excess, last, last + 1)
        if end <= start:
            continue
        inside = slice(first, last + 1)
        energy = curve.energy[inside]
        near = [np.linalg.norm(curve.fold_angles[inside] - phi, axis=1).min() for phi in angles]
        on = [number for number, far in enumerate(near, start=1) if far <= NEAR_CONTACT]
        out.append(
            Segment(
                number,
                "; ".join(curve.contacts),
                float(start),
                float(end),
                tuple(on),
                float(energy.max() - energy.min()),
                float(steep[inside].max()),
                float(bent[inside].max()),
                float(curve.springs[inside].max()) / total,
                float(curve.multipliers[inside].min()),
            )
        )
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
        for m, n in zip(here, there, strict=True):
            if n <= 0 < m:
                part = min(part, m / (m - n))
    return float(curve.s[inside] + part * (curve.s[outside] - curve.s[inside]))


def add_segments(content: Content, segments: SegmentReport) -> Content:
    """Add the contact boundaries that were followed to the minima of a scene.

    Parameters
    ----------
    content
        Of `MinimaResult.view_content`.
    segments
        Of `find_segments`.

    Returns
    -------
    Content
        With a track for each boundary.
    """
    poser = Poser(segments.scene)
    tracks = [
        poser.track(
            _title(curve.contacts, numbers),
            curve.fold_angles,
            curve.energy,
            parameter=curve.s,
            label="arclength s [rad]",
        )
        for curve, numbers in zip(segments.curves, segments.states, strict=True)
    ]
    return replace(content, tracks=(*content.tracks, *tracks))


def _title(contacts: Sequence[str], numbers: Sequence[int]) -> str:
    through = f" through state {', '.join(map(str, numbers))}" if numbers else ""
    return f"contact boundary{through}: {'; '.join(contacts)}"
