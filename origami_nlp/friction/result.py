"""What dry friction at hinges makes of stable states: regions, in words and as plain data.

Angles in radians, torques in N m.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.display import Details, Report, Section, Table, angle_columns
from origami_nlp.io import ShortRepr
from origami_nlp.minima import JudgedState, MinimaResult
from origami_nlp.numerics import INPUT_TOL

MOST_SHOWN = 4
"""Modes of one state whose sizes stand in the table."""
FAR = 0.3
"""Beyond so large a change of a fold angle [rad] the first order is called rough."""


@dataclass(frozen=True, repr=False)
class FrictionMode(ShortRepr):
    """How far a region reaches along one degree of freedom.

    Attributes
    ----------
    stiffness
        Second derivative of the energy per unit length in the space of all N fold angles [N m/rad].
    direction
        Unit change of the N fold angles, the largest entry positive, [N].
    low, high
        Reach along it to first order [rad], from `low` <= 0 to `high` >= 0.
    """

    stiffness: float
    direction: np.ndarray
    low: float
    high: float


@dataclass(frozen=True, repr=False)
class FrictionRegion(ShortRepr):
    """The states around one minimum that friction holds.

    Attributes
    ----------
    number
        Of the minimum (1-based).
    minimum
        The minimum.
    held
        Names of the loaded contacts, which stay closed.
    low, high
        Least and largest fold angles to first order, all N [rad]; each by itself, not all at once.
    modes
        Reach along each degree of freedom, softest first.
    exact
        With one degree of freedom: fold angles at both ends of the region, each with why it ends there; else None.
    why
        Why nothing is known; empty where it is.
    """

    number: int
    minimum: JudgedState
    held: tuple[str, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    modes: tuple[FrictionMode, ...]
    exact: tuple[tuple[tuple[float, ...], str], tuple[tuple[float, ...], str]] | None
    why: str

    def because(self, why: str) -> FrictionRegion:
        """Return it with the reason why nothing is known."""
        return replace(self, why=why)

    @property
    def widest(self) -> int:
        """The crease (1-based) whose fold angle reaches farthest; of equal ones the first."""
        width = np.subtract(self.high, self.low)
        return int(np.flatnonzero(width >= width.max() * (1 - INPUT_TOL))[0]) + 1


@dataclass(frozen=True, repr=False)
class Friction(Report):
    """Regions of states that dry friction at hinges holds.

    Attributes
    ----------
    result
        All minima.
    torque
        Largest friction torque of each crease [N m].
    regions
        Of the minima that were looked at.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.pattern("miura", 2, 2).with_springs(1.0, 0.8))
    >>> found = o.find_friction(result, 0.05)
    >>> region = found.regions[0]
    >>> region.low[0] < region.minimum.fold_angles[0] < region.high[0]
    True
    """

    result: MinimaResult
    torque: tuple[float, ...]
    regions: tuple[FrictionRegion, ...]

    PICTURE, SCHEMA = "draw_friction", "origami-nlp/friction/1"

    @property
    def label(self) -> str:
        """Whose minima these are."""
        return self.result.title

    def table(self) -> Table:
        """Return one row a state: reach of the fold angle that moves farthest, and along each mode."""
        rows = []
        for region in self.regions:
            if region.why:
                rows.append([f"#{region.number}", "not known", "", ""])
                continue
            i = region.widest
            at = math.degrees(region.minimum.fold_angles[i - 1])
            exact = ""
            if region.exact is not None:
                a, b = sorted(math.degrees(phi[i - 1]) for phi, _ in region.exact)
                exact = f"{a:.2f} .. {b:.2f}"
            reach = (
                f"{math.degrees(region.low[i - 1]):.2f} .. {math.degrees(region.high[i - 1]):.2f}"
            )
            modes = [
                f"{math.degrees(m.low):+.2f} {math.degrees(m.high):+.2f}"
                for m in region.modes[:MOST_SHOWN]
            ]
            more = [f"({len(region.modes) - MOST_SHOWN} more)"] * (len(region.modes) > MOST_SHOWN)
            crease = f"crease {i}, {at:.2f}: {reach}" if region.modes else "nothing moves"
            rows.append([f"#{region.number}", crease, exact, "; ".join(modes + more)])
        heads = ["state", "reaches farthest [deg]", "exact [deg]", "along each mode [deg]"]
        if not any(r.exact for r in self.regions):
            heads, rows = [heads[k] for k in (0, 1, 3)], [[r[k] for k in (0, 1, 3)] for r in rows]
        most = max(self.torque)
        same = "" if min(self.torque) == most else "at most "
        title = f"{self.label}: states that friction of {same}{most:g} N m at the hinges holds"
        return Table(heads, rows, title, "lLll"[: len(heads)])

    def report_sections(self) -> Iterator[Section]:
        """Return the table, what limits it, and all fold angles."""
        yield self.table()
        yield (
            "Reach is to first order: closure and energy linearised at the minimum, loaded contacts held; each fold "
            "angle by itself. Exact: followed along the one degree of freedom to where friction is overcome."
        )
        for region in self.regions:
            if region.why:
                yield f"#{region.number}: {region.why}"
            elif region.modes and np.subtract(region.high, region.low).max() > 2 * FAR:
                yield f"#{region.number}: the reach is large, first order is rough there"
            if region.held:
                yield f"#{region.number} held closed: " + "; ".join(region.held)
            for _, why in region.exact or ():
                if why != "friction is overcome":
                    yield f"#{region.number}: one end is where {why}"
        tables = []
        for region in self.regions:
            if region.why or not region.modes:
                continue
            heads = ["crease", "minimum [deg]", "least", "largest"]
            each = zip(region.minimum.fold_angles, region.low, region.high, strict=True)
            rows = [
                [str(i), *(f"{math.degrees(v) + 0.0:.3f}" for v in row)]
                for i, row in enumerate(each, start=1)
            ]
            title = f"#{region.number}: fold angles to first order"
            tables.append(Table(heads, rows, title, "rrrr"))
        if tables:
            yield Details(tuple(tables), "Fold angles")

    def _rows(self) -> Iterator[dict[str, object]]:
        for region in self.regions:
            for bound, phi in (("low", region.low), ("high", region.high)):
                if phi:
                    yield {"state": region.number, "bound": bound} | angle_columns(phi)
