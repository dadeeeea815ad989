"""What is known of a critical point, and of all of them together: the Morse identity."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, Literal

from origami_nlp.errors import SceneFileError
from origami_nlp.pattern import Scene, scene_from_dict, scene_to_dict

SCHEMA = "origami-nlp/critical/1"

Stratum = Literal["interior", "boundary", "corner", "handle", "singular"]
Kind = Literal["minimum", "saddle", "maximum", "regular", "pinch", "undecided"]
ROUNDING = 1e-15
"""Multipliers smaller than this [N m] are rounding and are stated as 0."""


@dataclass(frozen=True)
class CriticalPoint:
    """A critical point of the energy on the admissible set X, in the sense of stratified Morse theory.

    fold_angles: all N [rad].  energy: [the scene's units].
    index: number of negative curvatures along the stratum (0 to 2 in the interior, 0 or 1 on an edge); None for
    a vertex, which has no directions of its own, and where a curvature vanishes.
    contribution: 1 - chi(lower link): what the point adds to the Euler characteristic of X.
    stratum: ``interior`` (nothing touches), ``boundary`` (an edge of X), ``handle`` (a one-dimensional part of X),
    ``corner`` (a vertex beside which X is one sector), ``singular`` (any other vertex: the flat state,
    ends of handles, isolated states).
    kind: ``minimum`` (empty lower link), ``maximum`` (the whole link is lower, and it is a circle),
    ``saddle`` (contribution below 0), ``pinch`` (another essential point), ``regular`` (contribution 0, so
    the topology of {U <= c} does not change there), ``undecided``.
    contacts: those closed, in words.  multipliers: moment at each single contact [N m per rad of opening],
    positive where it pushes; on an edge that of its contact, whatever its sign; at a vertex the smallest
    non-negative ones, empty where no non-negative ones balance the springs.
    residual: largest entry of closure and closed contacts and, except at vertices, of stationarity.
    how: what decided the contribution.
    """

    fold_angles: tuple[float, ...]
    energy: float
    index: int | None
    contribution: int
    stratum: Stratum
    kind: Kind
    contacts: tuple[str, ...]
    multipliers: tuple[float, ...]
    residual: float
    how: str

    @property
    def essential(self) -> bool:
        """Whether the topology of {U <= c} changes at this point."""
        return self.contribution != 0

    def to_dict(self) -> dict[str, Any]:
        """Return a dictionary of plain values."""
        return {
            "fold_angles": list(self.fold_angles),
            "energy": self.energy,
            "index": self.index,
            "contacts": list(self.contacts),
            "contribution": self.contribution,
            "stratum": self.stratum,
            "kind": self.kind,
            "multipliers": list(self.multipliers),
            "residual": self.residual,
            "how": self.how,
        }

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> CriticalPoint:
        """Read back what `to_dict` returned."""
        values = {f.name: data[f.name] for f in fields(cls)}
        for name in ("fold_angles", "multipliers", "contacts"):
            values[name] = tuple(values[name])
        return cls(**values)


@dataclass(frozen=True)
class MinimaComparison:
    """Minima among the critical points against those of `find_minima`, matched in fold angles.

    matched: pairs (position in CriticalPoints.points, position in the list of minima).
    only_critical: positions of minima that the search for minima misses.
    only_search: positions in the list of minima that are no minimum here.
    """

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

    closes: whether the identity holds.  text: one sentence for people.
    """

    morse_sum: int
    euler_characteristic: int
    closes: bool
    text: str


@dataclass(frozen=True)
class CriticalPoints:
    """All critical points found, in order of energy.

    comparison: with a list of minima, where one was given.
    doubts: what could not be decided or checked, in words; empty in the regular case.
    """

    scene: Scene
    points: tuple[CriticalPoint, ...]
    comparison: MinimaComparison | None = None
    doubts: tuple[str, ...] = field(default=())

    @property
    def morse_sum(self) -> int:
        """Sum of all contributions."""
        return sum(p.contribution for p in self.points)

    @property
    def minima(self) -> tuple[CriticalPoint, ...]:
        """Points with an empty lower link."""
        return tuple(p for p in self.points if p.kind == "minimum")

    def count(self, kind: str | None = None, stratum: str | None = None) -> int:
        """Count points of a kind, on a stratum."""
        return sum(
            (kind is None or p.kind == kind) and (stratum is None or p.stratum == stratum)
            for p in self.points
        )

    def verdict(self, euler_characteristic: int) -> MorseVerdict:
        """Compare with the Euler characteristic of X, obtained without the energy."""
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

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data: scene, points, Morse sum, comparison and doubts."""
        found: dict[str, Any] = {
            "schema": SCHEMA,
            "scene": scene_to_dict(self.scene),
            "critical_points": [p.to_dict() for p in self.points],
            "morse_sum": self.morse_sum,
            "doubts": list(self.doubts),
        }
        if self.comparison is not None:
            found["minima"] = {
                "agree": self.comparison.agree,
                "matched": [list(pair) for pair in self.comparison.matched],
                "only_critical": list(self.comparison.only_critical),
                "only_search": list(self.comparison.only_search),
            }
        return found

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> CriticalPoints:
        """Read back what `to_dict` returned.

        Raises
        ------
        SceneFileError
            If the schema is another one, or a field is missing or of the wrong form.
        """
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            found = data.get("schema") if isinstance(data, dict) else data
            raise SceneFileError(f"schema = {found!r}: this reads {SCHEMA!r}")
        try:
            points = tuple(CriticalPoint.from_dict(p) for p in data["critical_points"])
            lists = data.get("minima")
            comparison = None
            if lists is not None:
                comparison = MinimaComparison(
                    tuple((int(a), int(b)) for a, b in lists["matched"]),
                    tuple(int(k) for k in lists["only_critical"]),
                    tuple(int(k) for k in lists["only_search"]),
                )
            scene = scene_from_dict(data["scene"])
            return cls(scene, points, comparison, tuple(data["doubts"]))
        except (KeyError, TypeError, ValueError) as error:
            raise SceneFileError(
                f"critical points cannot be read: {error!r}; write them anew"
            ) from None

    def __repr__(self) -> str:
        from origami_nlp.critical.table import as_text  # tables are told, not judged

        return as_text(self)
