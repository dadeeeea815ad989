"""Tables and lines of a list of minima: states, fold angles, what is not decided."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.display import KINDS, Cell, Table, Words
from origami_nlp.kkt import Escape
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.full_space import FullSpace
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import isolated_foldings, number_words
from origami_nlp.minima.summary import energy_words
from origami_nlp.numerics import BALANCED, STATIONARY, residual_words
from origami_nlp.pattern import Scene, tapered_limit

if TYPE_CHECKING:
    from origami_nlp.pattern_problem import FoldedLattice, FoldedTube

MOST_ANGLES = 24
"""Fold angles of a state up to which they are written out; those of larger ones are in the JSON."""
MOST_UNDECIDED = 12
"""States without a verdict that are named; there are many where whole sets of states are level."""
FEW_ANGLES = 9
"""Fold angles that are written to a thousandth of a degree in one line; more, to a hundredth."""
KIND_STYLE = {
    "interior": "green",
    "contact-pinned": "yellow",
    "contact-touching": "cyan",
    "degenerate": "magenta",
}


def dof_words(dimension: int, full: int) -> str:
    """Say what the local dimension of the feasible set means."""
    if dimension == full:
        return f"{dimension}"
    return {0: "0 isolated", 1: "1 handle"}.get(dimension, f"{dimension} of {full}")


def moment_words(moment: Sequence[float], residual: float, degree: int) -> str:
    """Report the constant internal moment, or that there is none."""
    largest = max(map(abs, moment))
    vector = ", ".join(f"{v:.6g}" if abs(v) > STATIONARY * largest else "0" for v in moment)
    if residual > BALANCED * (1 + largest):
        return (
            f"no constant internal moment: ({vector}) N m leaves up to {residual:.2g} N m at a free "
            "crease, which facets that touch carry"
        )
    return (
        f"constant internal moment: ({vector}) N m, seen from the facet between creases {degree} and 1, "
        f"residual {residual_words(residual)} N m"
    )


def full_space_lines(f: FullSpace) -> list[str]:
    """Say what becomes of a state when its symmetry may break."""
    lines = [f"full space: {f.verdict}: {f.certificate}"]
    if f.unstable_mode:
        lines.append(f"the descent {f.unstable_mode}")
    if f.lands_on:
        name = f"state #{f.lands_on.symmetric}" if f.lands_on.symmetric else "an asymmetric state"
        angles = " ".join(f"{a:.2f}" for a in np.round(np.degrees(f.lands_on.fold_angles), 2) + 0.0)
        lines.append(
            f"it lands on {name} at {f.lands_on.energy:.6g} J, {f.lands_on.kind}: {angles} deg"
        )
    return lines


def undecided_lines(search: SearchReport) -> list[str]:
    """Name states that may be minima, but were neither certified nor refuted, the first of them."""
    left = len(search.undecided) - MOST_UNDECIDED
    return [
        *(
            f"not decided: energy {r.energy:.9g} J{_where(r)}: {r.certificate}"
            for r in search.undecided[:MOST_UNDECIDED]
        ),
        *[f"not decided: {left} more states, in -o FILE.json"] * (left > 0),
    ]


def undecided_line(search: SearchReport) -> str:
    """Count states that may be minima, but were neither certified nor refuted; "" for none."""
    many = len(search.undecided)
    if not many:
        return ""
    energies = [r.energy for r in search.undecided]
    span = f"{min(energies):.6g}" + f" to {max(energies):.6g}" * (many > 1)
    words = "1 state is" if many == 1 else f"{many} states are"
    return f"{words} not decided, energy {span} J: --verbose says why"


def _where(state: JudgedState) -> str:
    if len(state.fold_angles) > MOST_ANGLES:
        return ""
    angles = " ".join(f"{a:.6g}" for a in np.round(np.degrees(state.fold_angles), 9) + 0.0)
    return f", hits {state.hits}, fold angles [deg] {angles}"


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
        digits = 3 if n <= FEW_ANGLES else 2
        shown = np.round(np.degrees(m.fold_angles), digits) + 0.0
        angles = " ".join(f"{a:{digits + 5}.{digits}f}" for a in shown)
        winds = f"   winds {m.winding} times round the axis" * (m.winding > 1)
        yield f"{f'#{k}':>5} {angles}{winds}"


def survival_lines(minima: Sequence[JudgedState], is_pattern: bool, lies: bool) -> Iterator[str]:
    """Say what the column of survivals counts; lies: whether the pattern lies flat."""
    found = [m.survival for m in minima if m.survival]
    if not found:
        return
    errors = "rest and sector angles"
    if is_pattern:
        errors = "rest angles, of sector angles (vertices moved in the flat sheet)"
        if not lies:
            errors = "rest angles (not of sector angles: the pattern does not lie flat)"
    degrees = max(s.degrees for s in found)
    yield (
        f"survives: those of {found[0].trials} draws of random errors, {degrees:g} deg (standard deviation) of "
        f"{errors} and {math.radians(degrees):.2g} of stiffnesses, in which the state could be followed, as the errors "
        "grow, to a certified minimum"
    )
    if any(s.springs is not None for s in found):
        yield (
            "closure has as many equations as there are creases, and with errors of positions rigid facets do not "
            'fold: "springs" counts draws that are survived with errors of rest angles and stiffnesses alone'
        )


def lattice_table(
    lattices: Sequence[FoldedLattice | FoldedTube], numbers: Sequence[int] = (), first: str = "#"
) -> Table:
    """Return the folded lattice of states of a cell, or their tubes, and how each gives way, a row each."""
    from origami_nlp.pattern_problem import FoldedLattice, FoldedTube  # only cells need them

    each = [str(k) for k in numbers or range(1, len(lattices) + 1)]
    if isinstance(lattices[0], FoldedTube):
        return _tube_table([x for x in lattices if isinstance(x, FoldedTube)], each, first)
    heads = [first, "a", "b", "angle\n[deg]"]
    heads += [f"{what}\nalong {x}" for what in ("Poisson", "stiffness") for x in "ab"]
    rows: list[list[Cell]] = []
    for number, one in zip(each, lattices, strict=False):
        assert isinstance(one, FoldedLattice)
        row: list[Cell] = [number, *(energy_words(x, max(one.lengths)) for x in one.lengths)]
        row.append("-" if math.isnan(one.angle) else f"{math.degrees(one.angle):.6g}")
        row += ["-" if math.isnan(x) else f"{x:.6g}" for x in one.poisson]
        row += [
            "rigid" if math.isinf(x) else "-" if math.isnan(x) else f"{x:.4g}"
            for x in one.stiffness
        ]
        rows.append(row)
    title = "lattice vectors a and b of a cell; a force along one of them, the other free; stiffness in N m/length^2"
    return Table(heads, rows, title, "rrrrrrrr", framed=False, narrow=True)


def _tube_table(tubes: Sequence[FoldedTube], numbers: Sequence[str], first: str) -> Table:
    """Return the table of cells that are rolled up."""
    heads = [first, "radius", "from", "to"]
    heads += [f"{what}\nalong {x}" for what in ("turn [deg]", "advance") for x in "ab"]
    heads.append("length\na cell")
    rows: list[list[Cell]] = []
    for number, one in zip(numbers, tubes, strict=False):
        places = one.radius, *one.radii, *one.advances, one.length
        size = max((abs(x) for x in places if math.isfinite(x)), default=1.0)
        said = ["-" if math.isnan(x) else energy_words(x, size) for x in places]
        turns = ["-" if math.isnan(x) else f"{math.degrees(x):.6g}" for x in one.turns]
        rows.append([number, *said[:3], *turns, *said[3:]])
    title = "copies of a cell lie round an axis: the next along a or b is turned about it and advanced along it"
    return Table(heads, rows, title, "r" * len(heads), framed=False, narrow=True)


def flag_lines(flags: ResultFlags) -> list[str]:
    """Name the flags that are up."""
    if not flags:
        return []
    return [f"flags up: {', '.join(flags.up)} (causes and cures: docs/flags.md, result.flags)"]


def scene_lines(scene: Scene) -> list[str]:
    """Say what is loaded, what is left out of panels, and how far sector angles were moved to make relations exact."""
    lines, found = list(scene.load_lines), scene.relations
    if scene.panels:
        most = math.degrees(tapered_limit(*scene.panels))
        lines.append(
            f"panels {scene.panels[0]:g} mm thick, tapered beside their hinges: stops at {most:.4g} degrees; not "
            "modelled: contact of panels that share no crease, corners at the vertex, shifted hinges (another "
            "kinematics)"
        )
    if found.made_exact:
        lines.append(
            f"sector angles moved by up to {found.moved:.1e} rad, so that {found.made_exact} nearly special "
            "relations hold exactly"
        )
    return lines


def kinds_table(
    numbers: Sequence[int],
    minima: Sequence[JudgedState],
    free: Sequence[int],
    last: tuple[str, ...],
    cells: Sequence[Sequence[str]],
) -> Table:
    """Return one row a minimum: its energy to 9 digits, kind and local dimension, and what `cells` say under `last`.

    free: of each minimum the dimension of closed states beside it.
    """
    rows: list[list[Cell]] = [
        [
            str(k),
            f"{m.energy:.9g}",
            Words(m.kind, KIND_STYLE[m.kind], KINDS[m.kind].colour),
            dof_words(m.local_dimension, most),
            *more,
        ]
        for k, m, most, more in zip(numbers, minima, free, cells, strict=True)
    ]
    columns = "rrlr" + ("L" if len(last) == 1 else "r" * len(last))
    heads = ["#", "energy [J]", "kind", "dimension", *last]
    return Table(heads, rows, "", columns, framed=False, narrow=True)


def state_lines(minima: Sequence[JudgedState]) -> list[str]:
    """Return certificate, contact moments and escape path of each minimum, a few lines each."""
    lines, grouped = [], isolated_foldings(minima)
    for number, m in enumerate(minima, start=1):
        if number in grouped:
            continue
        lines.append(f"#{number} {m.certificate}")
        shown = [c for c in m.contacts if len(m.fold_angles) <= MOST_ANGLES or not c.is_limit]
        lines += [f"   contact {c.words()}" for c in shown]
        if m.escape is not None and m.local_dimension:
            lines.append(f"   {escape_words(m.escape)}")
        if m.moment is not None:
            lines.append(f"   {moment_words(m.moment, m.moment_residual, len(m.fold_angles))}")
        if m.solver is not None and m.solver.came_back != "same":
            lines.append(
                f"   IPOPT, started beside it, does not come back: {m.solver.status}, {m.solver.moved:.1g} rad away"
            )
        if m.full_space:
            lines += [f"   {words}" for words in full_space_lines(m.full_space)]
    if grouped:
        lines.append(
            f"#{number_words(grouped)}: {len(grouped)} isolated flat foldings, creases unfolded or fully folded and no "
            "other admissible state near: contact alone holds them, whatever the springs (all are in the JSON)"
        )
    return lines


def escape_words(e: Escape) -> str:
    """Say where the escape path over the barrier of the summary leads, and how it was found."""
    if not e.known:
        return f"escape barrier {e.method}: {e.why}"
    to = f"#{e.to}" if e.to else "a state that is not listed"
    return f"escape path towards {to}: {e.method}"


def residual_cells(m: JudgedState) -> list[str]:
    """Return residuals and hits."""
    return [*map(residual_words, (m.closure_residual, m.kkt_residual)), str(m.hits)]


def touching_cells(m: JudgedState) -> list[str]:
    """Return which facets touch, and which creases are at their fold limit."""
    limits = [str(k) for c in m.contacts if not c.is_stop for k in c.creases]
    stops = [str(k) for c in m.contacts if c.is_stop for k in c.creases]
    touched = dict.fromkeys(c.facets for c in m.contacts if not c.is_limit)
    words = [f"facets {_few([f'{a}|{b}' for a, b in touched])} touch"] * bool(touched)
    words += [f"fold limit of {_few(limits)}"] * bool(limits)
    words += [f"stop of {_few(stops)}"] * bool(stops)
    return ["; ".join(words)]


def _few(names: Sequence[str]) -> str:
    return ", ".join([*names[:3], *["..."] * (len(names) > 3)])
