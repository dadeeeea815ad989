"""What is known of a critical point, and of all of them together: the Morse identity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from origami_nlp.display import Report, Section, angle_columns, record_row, record_table, shown
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import residual_words
from origami_nlp.pattern import Scene

Part = Literal["interior", "boundary", "corner", "handle", "singular"]
Kind = Literal["minimum", "saddle", "maximum", "regular", "pinch", "undecided"]
ROUNDING = 1e-15
"""Multipliers smaller than this [N m] are rounding and are stated as 0."""


@dataclass(frozen=True, repr=False)
class CriticalPoint(ShortRepr):
    """A critical point of the energy on the admissible set X, in the sense of stratified Morse theory.

    Attributes
    ----------
    energy
        [the scene's units].
    stratum
        ``interior`` (nothing touches), ``boundary`` (an edge of X), ``handle`` (a one-dimensional part of X),
        ``corner`` (a vertex beside which X is one sector), ``singular`` (any other vertex: the flat state, ends
        of handles, isolated states).
    kind
        ``minimum`` (empty lower link), ``maximum`` (the whole link is lower, and it is a circle), ``saddle``
        (contribution below 0), ``pinch`` (another essential point), ``regular`` (contribution 0, so the
        topology of {U <= c} does not change there), ``undecided``.
    contribution
        1 - chi(lower link): what the point adds to the Euler characteristic of X.
    fold_angles
        All N [rad].
    contacts
        Those closed, in words.
    multipliers
        Moment at each single contact [N m per rad of opening], positive where it pushes; on an edge that of its
        contact, whatever its sign; at a vertex the smallest non-negative ones, empty where no non-negative ones
        balance the springs.
    residual
        Largest entry of closure and closed contacts and, except at vertices, of stationarity.
    how
        What decided the contribution.
    index
        Number of negative curvatures along the stratum (0 to 2 in the interior, 0 or 1 on an edge); None for a
        vertex, which has no directions of its own, and where a curvature vanishes.
    """

    energy: float = field(metadata=shown("energy", "J", ".9g"))
    stratum: Part = field(metadata=shown("stratum"))
    kind: Kind = field(metadata=shown("kind"))
    contribution: int = field(metadata=shown("adds", "", "+d"))
    fold_angles: tuple[float, ...] = field(metadata=shown("fold angles", "rad", "z.3f"))
    contacts: tuple[str, ...] = field(
        metadata=shown("contacts", missing="nothing touches", between="; ")
    )
    multipliers: tuple[float, ...] = field(metadata=shown("multipliers", "N m", ".4g"))
    residual: float = field(metadata=shown("residual", "", residual_words))
    how: str = field(metadata=shown("how"))
    index: int | None = field(metadata=shown())

    @property
    def essential(self) -> bool:
        """Whether the topology of {U <= c} changes at this point."""
        return self.contribution != 0


@dataclass(frozen=True, repr=False)
class CriticalPoints(Report):
    """Critical points of the energy on the contact-admissible symmetric set X.

    Attributes
    ----------
    scene
        The scene.
    points
        In order of energy.
    euler_characteristic
        Of X, obtained without the energy.
    doubts
        What could not be decided or checked, in words; empty in the regular case.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_critical_points(o.examples.degree6("pi/4", ratio=0.01), rings=12)
    >>> len(found.minima), found.morse_sum, found.closes
    (2, 1, True)
    """

    scene: Scene
    points: tuple[CriticalPoint, ...]
    euler_characteristic: int
    doubts: tuple[str, ...] = ()

    WIDTH, SCHEMA = 160, "origami-nlp/landscape/2"
    ALSO = ("morse_sum", "closes")

    @property
    def morse_sum(self) -> int:
        """Sum of all contributions."""
        return sum(p.contribution for p in self.points)

    @property
    def minima(self) -> tuple[CriticalPoint, ...]:
        """Points with an empty lower link."""
        return tuple(p for p in self.points if p.kind == "minimum")

    @property
    def closes(self) -> bool:
        """Whether the Morse identity holds; if not, at least one point is missing or misjudged."""
        return self.morse_sum == self.euler_characteristic

    def report_sections(self) -> Iterator[Section]:
        """Return a table of the points that are essential, or undecided, the Morse sum, and what is said of it."""
        told = [p for p in self.points if p.essential or p.kind == "undecided"]
        title = f"{self.scene.label or repr(self.scene.vertex)}\n{len(told)} critical points"
        if hidden := len(self.points) - len(told):
            title += f" ({hidden} more are not essential)"
        yield record_table(told, title)
        words = "closes" if self.closes else "does not close: a point is missing or misjudged"
        yield (
            f"Morse sum {self.morse_sum}, Euler characteristic {self.euler_characteristic}: the count {words}"
        )
        yield from (f"doubt: {doubt}" for doubt in self.doubts)

    def _rows(self) -> Iterator[dict[str, object]]:
        for p in self.points:
            row = record_row(p)
            del row["fold_angles_rad"]
            yield row | angle_columns(p.fold_angles)
