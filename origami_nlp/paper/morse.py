"""What is known of a critical point, and of all of them together: the Morse identity."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from origami_nlp.display import Report, Section, Table, angle_columns
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
    fold_angles
        All N [rad].
    energy
        [the scene's units].
    index
        Number of negative curvatures along the stratum (0 to 2 in the interior, 0 or 1 on an edge); None for a
        vertex, which has no directions of its own, and where a curvature vanishes.
    contribution
        1 - chi(lower link): what the point adds to the Euler characteristic of X.
    stratum
        ``interior`` (nothing touches), ``boundary`` (an edge of X), ``handle`` (a one-dimensional part of X),
        ``corner`` (a vertex beside which X is one sector), ``singular`` (any other vertex: the flat state, ends
        of handles, isolated states).
    kind
        ``minimum`` (empty lower link), ``maximum`` (the whole link is lower, and it is a circle), ``saddle``
        (contribution below 0), ``pinch`` (another essential point), ``regular`` (contribution 0, so the
        topology of {U <= c} does not change there), ``undecided``.
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
    """

    fold_angles: tuple[float, ...]
    energy: float
    index: int | None
    contribution: int
    stratum: Part
    kind: Kind
    contacts: tuple[str, ...]
    multipliers: tuple[float, ...]
    residual: float
    how: str

    @property
    def essential(self) -> bool:
        """Whether the topology of {U <= c} changes at this point."""
        return self.contribution != 0


@dataclass(frozen=True)
class MinimaComparison:
    """Minima among the critical points against those of `find_minima`, matched in fold angles.

    Attributes
    ----------
    matched
        Pairs (position in CriticalPoints.points, position in the list of minima).
    only_critical
        Positions of minima that the search for minima misses.
    only_search
        Positions in the list of minima that are no minimum here.
    """

    ALSO = ("agree",)

    matched: tuple[tuple[int, int], ...]
    only_critical: tuple[int, ...]
    only_search: tuple[int, ...]

    @property
    def agree(self) -> bool:
        """Whether both lists hold the same states."""
        return not self.only_critical and not self.only_search


@dataclass(frozen=True)
class MorseVerdict:
    """The identity sum of contributions = Euler characteristic of X, and what it says of the minima.

    Attributes
    ----------
    morse_sum
        Sum of the contributions.
    euler_characteristic
        Of X, obtained without the energy.
    closes
        Whether the identity holds.
    text
        One sentence for people.
    """

    morse_sum: int
    euler_characteristic: int
    closes: bool
    text: str


@dataclass(frozen=True, repr=False)
class CriticalPoints(Report):
    """Critical points of the energy on the contact-admissible symmetric set X.

    Attributes
    ----------
    scene
        The scene.
    points
        In order of energy.
    comparison
        With a list of minima, where one was given.
    doubts
        What could not be decided or checked, in words; empty in the regular case.
    morse
        What the Morse identity says, where the Euler characteristic of X is known (`verdict`).

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_critical_points(o.examples.degree6("pi/4", ratio=0.01), samples=16)
    >>> found.count(kind="minimum"), found.verdict(euler_characteristic=1).closes
    (2, True)
    """

    scene: Scene
    points: tuple[CriticalPoint, ...]
    comparison: MinimaComparison | None = None
    doubts: tuple[str, ...] = field(default=())
    morse: MorseVerdict | None = None

    WIDTH, SCHEMA = 160, "origami-nlp/landscape/2"
    ALSO = ("morse_sum",)

    @property
    def morse_sum(self) -> int:
        """Sum of all contributions."""
        return sum(p.contribution for p in self.points)

    @property
    def minima(self) -> tuple[CriticalPoint, ...]:
        """Points with an empty lower link."""
        return tuple(p for p in self.points if p.kind == "minimum")

    def count(self, kind: str | None = None, stratum: str | None = None) -> int:
        """Count points.

        Parameters
        ----------
        kind
            Only of this kind, see `CriticalPoint`.
        stratum
            Only on this stratum.

        Returns
        -------
        int
            How many there are.
        """
        return sum(
            (kind is None or p.kind == kind) and (stratum is None or p.stratum == stratum)
            for p in self.points
        )

    def verdict(self, euler_characteristic: int) -> MorseVerdict:
        """Compare with the Euler characteristic of X, obtained without the energy.

        Parameters
        ----------
        euler_characteristic
            Such as `Space.euler_characteristic`.

        Returns
        -------
        MorseVerdict
            Whether the contributions sum to it.
        """
        total = self.morse_sum
        closes = total == euler_characteristic
        identity = f"Morse sum {total}, Euler characteristic {euler_characteristic}"
        if not closes:
            text = f"{identity}: at least one critical point is missing or misjudged"
        elif self.doubts:
            text = f"{identity}: the count closes, but with doubts ({'; '.join(self.doubts)})"
        elif self.comparison is None:
            text = f"{identity}: the count closes"
        elif self.comparison.agree:
            text = (
                f"{identity}: the count closes and both lists hold the same "
                f"{len(self.minima)} minima, complete up to this identity"
            )
        else:
            text = (
                f"{identity}: the count closes, but the lists of minima differ: "
                f"{len(self.comparison.only_critical)} only among the critical points, "
                f"{len(self.comparison.only_search)} only in the search"
            )
        return MorseVerdict(total, euler_characteristic, closes, text)

    def table(self, verbose: bool = False) -> Table:
        """Return one row a critical point.

        Parameters
        ----------
        verbose
            Also those that are not essential.

        Returns
        -------
        Table
            Number, energy, stratum, kind, index, contribution and residual.
        """
        shown = self._shown(verbose)
        hidden = len(self.points) - len(shown)
        title = f"{self.scene.label or repr(self.scene.vertex)}\n{len(shown)} critical points"
        title += f" ({hidden} more are not essential)" if hidden else ""
        rows = [
            (
                str(number),
                f"{p.energy:.9g}",
                p.stratum,
                p.kind,
                "-" if p.index is None else str(p.index),
                f"{p.contribution:+d}" if p.contribution else "0",
                residual_words(p.residual),
            )
            for number, p in enumerate(shown, start=1)
        ]
        heads = ("#", "energy [J]", "stratum", "kind", "index", "adds", "residual")
        return Table(heads, rows, title, "rrllrrr")

    def lines(self, verbose: bool = False) -> list[str]:
        """Return two lines a point: where it is, and what touches and decides there.

        Parameters
        ----------
        verbose
            Also those that are not essential.

        Returns
        -------
        list of str
            The lines, below a first that says what they hold.
        """
        creases = [ray.crease for ray in self.scene.group.rays if ray.crease is not None]
        numbers = ", ".join(str(c + 1) for c in creases)
        lines = [f"fold angles of creases {numbers} [deg], contacts, and what decides:"]
        for number, p in enumerate(self._shown(verbose), start=1):
            angles = " ".join(f"{math.degrees(p.fold_angles[c]):8.3f}" for c in creases)
            contacts = "; ".join(p.contacts) if p.contacts else "nothing touches"
            lines.append(f"#{number}  {angles.replace('-0.000', ' 0.000')}  {contacts}")
            moments = ", ".join(f"{v:.4g}" for v in p.multipliers)
            lines.append(f"    {p.how}" + (f"; moment {moments} N m" if moments else ""))
        return lines

    def _shown(self, verbose: bool) -> list[CriticalPoint]:
        """Return the points that a person wants to see: the essential ones, or all of them."""
        return [p for p in self.points if verbose or p.essential or p.kind == "undecided"]

    def report_sections(self) -> Iterator[Section]:
        """Return the table, the points and the Morse sum."""
        yield self.table()
        yield from self.lines()
        yield f"Morse sum {self.morse_sum}"
        yield from (f"doubt: {doubt}" for doubt in self.doubts)

    def _rows(self) -> Iterator[dict[str, object]]:
        for number, p in enumerate(self.points, start=1):
            row = {"scene": self.scene.label, "number": number, "energy_J": p.energy}
            row |= {
                "kind": p.kind,
                "stratum": p.stratum,
                "index": p.index,
                "contribution": p.contribution,
            }
            row["contacts"] = "; ".join(p.contacts)
            yield row | angle_columns(p.fold_angles)
