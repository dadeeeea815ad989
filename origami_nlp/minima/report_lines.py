"""Lines and tables below the list of states: fold angles, lattices of cells, what is known of one state."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from string import ascii_uppercase
from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.display import Table
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.rows import rounded

if TYPE_CHECKING:
    from origami_nlp.pattern_problem import FoldedLattice, FoldedTube

MOST_ANGLES = 24
"""Fold angles of a state up to which they are written out; those of larger ones are in the JSON."""


def letter(number: int) -> str:
    """Return the name of a contact of a state, from 0, in a report and on a page."""
    return ascii_uppercase[number % 26]


def state_lines(m: JudgedState) -> Iterator[str]:
    """Say what is known of a minimum: certificate, contacts, escape path, and its full space."""
    yield m.certificate
    for k, c in enumerate(m.contacts):
        if len(m.fold_angles) <= MOST_ANGLES or not c.is_limit:
            yield f"contact {letter(k)}: {c.words()}"
    if (e := m.escape) is not None and m.local_dimension:
        to = f"#{e.to}" if e.to else "a state that is not listed"
        yield f"escape path: {e.method}" + (f", towards {to}" if e.known else f": {e.why}")
    if m.solver is not None and m.solver.came_back != "same":
        yield f"IPOPT does not come back: {m.solver.status}, {m.solver.moved:.1g} rad away"
    if f := m.full_space:
        yield f"full space: {f.verdict}: {f.certificate}"
        if f.lands_on:
            name = (
                f"state #{f.lands_on.symmetric}" if f.lands_on.symmetric else "an asymmetric state"
            )
            way = f"descent that {f.unstable_mode} lands on" if f.unstable_mode else "it lands on"
            yield f"{way} {name}: {f.lands_on.kind}, {f.lands_on.energy:.6g} J"


def angle_lines(minima: Sequence[JudgedState], numbers: Sequence[int]) -> Iterator[str]:
    """Return the fold angles of the states of these numbers (from 1), a line each."""
    if not numbers:
        return
    n = len(minima[0].fold_angles)
    if n > MOST_ANGLES:
        yield f"fold angles of the {n} creases: -o FILE.json"
        return
    yield f"fold angles of creases 1..{n} [deg]"
    for k in numbers:
        m = minima[k - 1]
        digits = 3 if n <= 9 else 2
        shown = np.round(np.degrees(m.fold_angles), digits) + 0.0
        angles = " ".join(f"{a:{digits + 5}.{digits}f}" for a in shown)
        winds = f"   winds {m.winding} times round the axis" * (m.winding > 1)
        yield f"{f'#{k}':>5} {angles}{winds}"


def lattice_table(
    lattices: Sequence[FoldedLattice | FoldedTube], numbers: Sequence[int] = (), first: str = "#"
) -> Table:
    """Return the folded lattice of states of a cell, or their tubes, and how each gives way, a row each."""
    from origami_nlp.pattern_problem import FoldedTube  # only cells need them

    heads = [first, "a", "b", "angle\n[deg]"]
    heads += [f"{what}\nalong {x}" for what in ("Poisson", "stiffness") for x in "ab"]
    title = "lattice vectors a and b of a cell; a force along one of them, the other free; stiffness in N m/length^2"
    if isinstance(lattices[0], FoldedTube):
        heads = [first, "radius", "from", "to"]
        heads += [f"{what}\nalong {x}" for what in ("turn [deg]", "advance") for x in "ab"]
        heads.append("length\na cell")
        title = "copies of a cell lie round an axis: the next along a or b is turned about it and advanced along it"
    each = zip(numbers or range(1, len(lattices) + 1), lattices, strict=False)
    rows = [[str(number), *_measures(one)] for number, one in each]
    return Table(heads, rows, title, "r" * len(heads), framed=False, narrow=True)


def _measures(one: FoldedLattice | FoldedTube) -> list[str]:
    """Return the cells of a row of `lattice_table`."""
    from origami_nlp.pattern_problem import FoldedTube

    def text(x: float, size: float = 0.0, digits: int = 6) -> str:
        if math.isfinite(x):
            return f"{rounded(x, size):.{digits}g}"
        return "-" if math.isnan(x) else "rigid"

    if isinstance(one, FoldedTube):
        places = one.radius, *one.radii, *one.advances, one.length
        size = max((abs(x) for x in places if math.isfinite(x)), default=1.0)
        said = [text(x, size) for x in places]
        return [*said[:3], *(text(math.degrees(x)) for x in one.turns), *said[3:]]
    lengths = (text(x, max(one.lengths)) for x in one.lengths)
    gives = [*map(text, one.poisson), *(text(x, 0.0, 4) for x in one.stiffness)]
    return [*lengths, text(math.degrees(one.angle)), *gives]
