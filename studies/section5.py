"""Every number of stable states printed in section 5, under each reading of what was counted.

The paper counts interior minima with a relative depth above 1e-3, with the rest angles it prints, on the
roots it prints (which turn back beyond contact), over an interval of nu_0 that is the mirror image of the
one its own convention gives (errata: s5.rest-state, s4.partial-valley, s5.range-6-8).  Here each statement
is looked for under readings that change one of these at a time; the verdict is the first reading, from
exact physics towards the printed formulas, in which it shows.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.paper.cone import Cone, class_energy, count_map, energy_classes

DEPTH = 1e-3
"""The paper's threshold (footnote of section 5)."""
STEPS = 400
"""Elevations of the dense scan on printed roots."""
ALWAYS = 0.98
"""A statement "everywhere" holds from this share of the grid points of its region on (lines of boundaries remain)."""


@dataclass(frozen=True)
class Reading:
    """One way to read what was counted.

    mirrored: whether the paper's nu_0 is minus ours (its intervals are mirror images of those its Q(e2, v) gives).
    depth: threshold on relative depth, 0 for none.  contact: whether minima at the end of a branch count.
    rest: rule for the rest state.  roots: "exact", or "printed": with the moduli, to |v| = pi/2.
    """

    name: str
    why: str
    mirrored: bool
    depth: float
    contact: bool
    rest: str
    roots: str


READINGS = (
    Reading("exact", "exact counts", True, 0.0, True, "waterbomb", "exact"),
    Reading("exact, nu_0 as printed", "exact counts", False, 0.0, True, "waterbomb", "exact"),
    Reading("depth", "the depth threshold", True, DEPTH, True, "waterbomb", "exact"),
    Reading("interior", "leaving contact out", True, 0.0, False, "waterbomb", "exact"),
    Reading("depth, interior", "threshold and contact", True, DEPTH, False, "waterbomb", "exact"),
    Reading(
        "depth, interior, nu_0 as printed",
        "threshold, contact and sign",
        False,
        DEPTH,
        False,
        "waterbomb",
        "exact",
    ),
    Reading("printed rest", "the printed rest angles", False, DEPTH, False, "paper", "exact"),
    Reading("printed roots", "the root beyond contact", True, DEPTH, False, "waterbomb", "printed"),
    Reading(
        "printed rest and roots",
        "printed rest angles and root beyond contact",
        False,
        DEPTH,
        False,
        "paper",
        "printed",
    ),
)
"""From exact physics towards the printed formulas."""


@dataclass(frozen=True)
class Statement:
    """A number of stable states printed in section 5.

    where: the words.  count: states, of 2^(N/2+1).  region: (low, high) of the paper's nu_0 [rad] and of r.
    kind: "somewhere" (the number occurs there), "everywhere", "most" (more often than any other number),
    "largest" (of the whole map), or "flat" (at nu_0 = 0, where the flat state itself is counted).
    """

    degree: int
    where: str
    count: int
    nu: tuple[float, float]
    ratio: tuple[float, float]
    kind: str

    @property
    def fraction(self) -> str:
        """As printed, "7/16"."""
        return f"{self.count}/{2 ** (self.degree // 2 + 1)}"


_PI = math.pi
LOW, HIGH = 1e-2, 1e2
"""Ratios of the whole map: the text speaks of 0.1 to 25, bands included."""
PLATEAU = (1e2, 1e4)
"""Ratios "above a threshold"."""


def _whole(degree: int) -> tuple[float, float]:
    """Return the paper's interval of nu_0."""
    return (-_PI / 2, Cone(degree).steep_end)


def _below(degree: int) -> tuple[float, float]:
    return (-_PI / 2, 0.0)


def _above(degree: int) -> tuple[float, float]:
    return (0.0, Cone(degree).steep_end)


def _both(degree: int, count: int, where: str) -> list[Statement]:
    """Bands on both sides of the flat state."""
    return [
        Statement(degree, f"{where}, nu_0 < 0", count, _below(degree), (LOW, HIGH), "somewhere"),
        Statement(degree, f"{where}, nu_0 > 0", count, _above(degree), (LOW, HIGH), "somewhere"),
    ]


def _ranges(degree: int, least: int, most: int) -> list[Statement]:
    return [
        Statement(
            degree, "nu_0 = 0, any r (smallest number)", least, (0.0, 0.0), (LOW, HIGH), "flat"
        ),
        Statement(degree, "largest number", most, _whole(degree), (LOW, HIGH), "largest"),
    ]


STATEMENTS: tuple[Statement, ...] = (
    *_ranges(6, 1, 11),
    Statement(6, "region -pi/5 < nu_0 < -pi/12, r < 10", 4, (-_PI / 5, -_PI / 12), (LOW, 10), "somewhere"),
    Statement(6, "region -pi/5 < nu_0 < -pi/12, r < 10", 7, (-_PI / 5, -_PI / 12), (LOW, 10), "somewhere"),
    Statement(6, "band r ~ 1, nu_0 < -pi/6", 5, (-_PI / 2, -_PI / 6), (0.3, 3), "somewhere"),
    Statement(6, "band r ~ 10, nu_0 > 0", 5, (0, _PI / 6), (3, 30), "somewhere"),
    Statement(6, "region nu_0 ~ pi/6, r < 0.1", 11, (_PI / 8, _PI / 6), (LOW, 0.1), "somewhere"),
    Statement(6, "otherwise, a large portion", 2, _whole(6), (LOW, HIGH), "most"),
    *_ranges(8, 1, 16),
    *_both(8, 12, "band"),
    *_both(8, 16, "band"),
    Statement(8, "above a threshold of r", 10, _whole(8), PLATEAU, "everywhere"),
    *_ranges(10, 1, 42),
    *_both(10, 17, "two bands"),
    *_both(10, 32, "two bands"),
    Statement(10, "above a threshold of r", 42, _whole(10), PLATEAU, "everywhere"),
    *_ranges(12, 1, 64),
    Statement(12, "band", 43, _whole(12), (LOW, HIGH), "somewhere"),
    Statement(12, "band", 58, _whole(12), (LOW, HIGH), "somewhere"),
    Statement(12, "band", 64, _whole(12), (LOW, HIGH), "somewhere"),
    Statement(12, "above a threshold of r", 56, _whole(12), PLATEAU, "everywhere"),
)  # fmt: skip
"""In the order of the text, captions included where they add a number."""


@dataclass(frozen=True)
class Finding:
    """What one statement becomes under each reading.

    shares: share of grid points of the region with that number, for each reading.  values: (smallest, largest, most
    frequent) number there.  holds: whether the statement is true.
    """

    statement: Statement
    shares: tuple[float, ...]
    values: tuple[tuple[int, int, int], ...]
    holds: tuple[bool, ...]

    @property
    def first(self) -> Reading | None:
        """The first reading under which the statement holds."""
        return next((r for r, ok in zip(READINGS, self.holds, strict=True) if ok), None)

    @property
    def verdict(self) -> str:
        """In words, with the share of the region where the number stands in the first reading that has it."""
        if self.first is None:
            return "in no reading"
        if self.first.name.startswith("exact"):
            return "physics" + ("" if self.first.mirrored else " (with nu_0 as printed)")
        share = self.shares[READINGS.index(self.first)]
        return f"drawn by {self.first.why} ({share:.1%})"


def check_statements(
    size: int = 40,
    degrees: tuple[int, ...] = (6, 8, 10, 12),
    progress: Callable[[int, int], None] | None = None,
) -> list[Finding]:
    """Look for every printed number under every reading, on `size` x `size` points of its region.

    Points avoid the lines nu_0 = 0 and contact; ratios are spaced geometrically.
    """
    wanted = [s for s in STATEMENTS if s.degree in degrees]
    found = []
    for done, statement in enumerate(wanted, start=1):
        shares, values, holds = [], [], []
        for reading in READINGS:
            counts = region_counts(statement, reading, size)
            share, value, ok = _assess(statement, counts)
            shares.append(share)
            values.append(value)
            holds.append(ok)
        found.append(Finding(statement, tuple(shares), tuple(values), tuple(holds)))
        if progress:
            progress(done, len(wanted))
    return found


def _assess(statement: Statement, counts: np.ndarray) -> tuple[float, tuple[int, int, int], bool]:
    if counts.size == 0:
        return math.nan, (0, 0, 0), False
    numbers, often = np.unique(counts, return_counts=True)
    value = (int(numbers[0]), int(numbers[-1]), int(numbers[often.argmax()]))
    if statement.kind == "flat":  # the maps count minima off the flat state only
        counts, value = counts + 1, (value[0] + 1, value[1] + 1, value[2] + 1)
    share = float((counts == statement.count).mean())
    ok = {
        "flat": share == 1,
        "somewhere": share > 0,
        "everywhere": share >= ALWAYS,
        "largest": value[1] == statement.count,
        "most": value[2] == statement.count,
    }[statement.kind]
    return share, value, bool(ok)


def region_counts(statement: Statement, reading: Reading, size: int) -> np.ndarray:
    """Count stable states on a grid of the statement's region, under one reading; empty if it has no points."""
    cells = (np.arange(size) + 0.5) / size
    low, high = statement.nu
    nu = low + (high - low) * cells
    nu = -nu if reading.mirrored else nu
    if reading.rest == "waterbomb":
        first, last = Cone(statement.degree).rest_range
        nu = nu[(nu > first) & (nu < last)]
    # grid points avoid the line nu_0 = 0; at the middle of a symmetric interval they meet it to a few eps
    nu = np.zeros(1) if statement.kind == "flat" else nu[np.abs(nu) > DUPLICATE_TOL]
    if nu.size == 0:
        return np.zeros((0, size), dtype=int)
    bottom, top = np.log(statement.ratio)
    ratios = np.exp(bottom + (top - bottom) * cells)
    if reading.roots == "printed":
        return scan_counts(statement.degree, ratios, nu, reading)
    return exact_counts(statement.degree, ratios, nu, reading)


def scan_counts(degree: int, ratios: np.ndarray, nu: np.ndarray, reading: Reading) -> np.ndarray:
    """Count minima by a dense scan of every class, shape [nu, ratios]; for roots that are not smooth.

    "printed" roots: |rho| = arccos |..|, which turns back at pi/2; branches run to |v| = pi/2.
    """
    total = np.zeros((len(nu), len(ratios)), dtype=np.int64)
    printed = reading.roots == "printed"
    r = ratios[:, None]
    for branches in energy_classes(Cone(degree, reading.rest)):
        t = np.linspace(0, math.pi / 2 if printed else branches.end, STEPS + 1)
        energy = class_energy(branches, t, nu[:, None])
        if printed:
            size = energy.creases.size.copy()
            size[:, 1] = np.minimum(size[:, 1], 2 * math.pi - size[:, 1])  # S = 2 |rho_steep|
            size[:, 2] = (size[:, 1] - size[:, 0]) / 2
            energy = replace(energy, creases=replace(energy.creases, size=size))
        (well_a, well_b), (flat_a, flat_b) = energy.wells, energy.flat
        well = well_a[:, None] + r * well_b[:, None]  # [nu, ratio, t], U_flat - U
        flat = flat_a + ratios * flat_b
        minimum = (well[..., 1:-1] > well[..., :-2]) & (well[..., 1:-1] >= well[..., 2:])
        if reading.depth > 0:
            minimum &= well[..., 1:-1] > reading.depth * flat[..., None]
        found = minimum.sum(axis=-1)
        if reading.contact:
            pinned = well[..., -1] > well[..., -2]
            found = found + (pinned & (well[..., -1] > reading.depth * flat))
        total += branches.multiplicity * found
    return total


def exact_counts(degree: int, ratios: np.ndarray, nu: np.ndarray, reading: Reading) -> np.ndarray:
    """Count minima exactly (`cone.count_map`), shape [nu, ratios]."""
    counts = count_map(Cone(degree, reading.rest), ratios, nu, depth=reading.depth)
    return (counts.interior + reading.contact * counts.at_end).T
