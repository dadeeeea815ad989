"""Cones as tables for a terminal: counted minima, foldings, one state, phase diagrams, verdicts in the full space."""

from __future__ import annotations

import re
from collections import Counter

import numpy as np
from rich.console import Console

from origami_nlp.display import Table, folding_table
from origami_nlp.paper.cone.branches import ConeBranch
from origami_nlp.paper.cone.classes import EnergyClass
from origami_nlp.paper.cone.flaps import write_flaps
from origami_nlp.paper.cone.minima import ConeCount
from origami_nlp.paper.cone.necklaces import foldings, number_of_foldings
from origami_nlp.paper.cone.phase import PhaseDiagram
from origami_nlp.paper.cone.stability import ConeFullSpace, JudgedMinimum
from origami_nlp.pattern import format_angle

MOST_ROWS, MOST_TIES = 60, 8
"""Minima and ties that are printed one by one."""
SMALL = 1e-3
"""Elevations below this are written with an exponent: seven decimals would leave less than four digits [rad]."""
COUNT_HEADS = ("branches", "changes", "number", "elevation [rad]", "energy/k_odd", "depth", "kind")
FULL_HEADS = ("flaps", "copies", "kind", "|v|", "depth", "slope", "verdict", "why")
LONGEST_NUMBER = 9
"""Digits of an integer written out in tables."""


def number_words(number: int) -> str:
    """Write an integer with separators, or as 1.23e150 where it is long.

    Parameters
    ----------
    number
        The integer.

    Returns
    -------
    str
        Its text.
    """
    text = str(number)
    if len(text) <= LONGEST_NUMBER:
        return f"{number:,}"
    return f"{text[0]}.{text[1:4]}e{len(text) - 1}"


def share_words(part: int, whole: int) -> str:
    """Write part/whole as a decimal, also for integers beyond the range of floats."""
    return f"{part * 10**8 // whole / 10**8:.6g}"


def print_count(count: ConeCount, console: Console) -> None:
    """Print the numbers of branch minima, then a row for each class and minimum, deepest first.

    Parameters
    ----------
    count
        Of `count`.
    console
        Of rich.
    """
    whole = count.branches
    rest = count.rest
    console.print(
        f"cone of degree {count.degree}, r_k = {count.ratio:g}, rest elevation "
        f"{format_angle(rest.elevation)} ({count.cone.rest}), branches end by the {count.cone.end} rule"
    )
    for name, number in (
        ("interior minima", count.stable_interior),
        ("minima pinned by contact", count.stable_contact),
        ("falling at their cut, where nothing touches", count.falling_at_cut),
        ("branches with a minimum", count.branches_with_minimum),
    ):
        if name.startswith("falling") and not number:
            continue
        console.print(
            f"  {name}: {number_words(number)} of {number_words(whole)} branches "
            f"({share_words(number, whole)})"
        )
    if count.depth > 0:
        console.print(f"  counted: wells deeper than {count.depth:g} of the flat state's energy")
    for tied in count.undecided[:MOST_TIES]:
        name = EnergyClass(count.cone, *tied).name
        console.print(f"  tie to rounding on {name}: slope 0 at an end, or a double zero")
    if len(count.undecided) > MOST_TIES:
        console.print(f"  and ties on {len(count.undecided) - MOST_TIES} more classes")
    if not len(count.minima):
        return
    console.print(count_table(count))
    if len(count.minima) > MOST_ROWS:
        console.print(f"{len(count.minima) - MOST_ROWS} more rows: -o FILE.json has all")


def count_table(count: ConeCount) -> Table:
    """Return one row a class and minimum, deepest first; those at an end with their multiplier."""
    m, rows = count.minima, []
    for k in np.argsort(-m.depth, kind="stable")[:MOST_ROWS].tolist():
        own = EnergyClass(count.cone, int(m.valleys[k]), int(m.changes[k]), int(m.direction[k]))
        row = (
            own.name.split(" (")[0],
            str(own.changes),
            number_words(m.multiplicity[k]),
            f"{m.elevation[k]:.7f}" if abs(m.elevation[k]) > SMALL else f"{m.elevation[k]:.3e}",
            f"{m.energy[k]:.5g}",
            f"{m.depth[k]:.4g}",
            "interior" if m.interior[k] else f"{m.kind[k]}, {m.multiplier[k]:.4g}",
        )
        rows.append(row)
    return Table(COUNT_HEADS, rows, "", "lrrrrrl", framed=False, narrow=True)


def print_foldings(degree: int, console: Console, listed: bool) -> None:
    """Print how many foldings of a degree differ.

    Parameters
    ----------
    degree
        N, even, at least 6.
    console
        Of rich.
    listed
        Whether to print which.
    """
    turned, mirrored = (number_of_foldings(degree, mirrors_differ=m) for m in (True, False))
    console.print(
        f"cone of degree {degree}: {number_words(1 << (degree // 2))} assignments at an elevation, of which differ\n"
        f"  by more than a rotation (necklaces): {number_words(turned)}\n"
        f"  by more than rotation and reflection (bracelets): {number_words(mirrored)}\n"
        "valleys and mountains are not swapped; with both signs of the elevation, turning the sheet over "
        "leaves the same numbers"
    )
    if not listed:
        return
    kept = {f.flaps for f in foldings(degree, mirrors_differ=False)}
    rows = []
    for number, f in enumerate(foldings(degree), start=1):
        word = "itself" if not f.chiral else "another" if f.flaps in kept else "listed above"
        rows.append((str(number), write_flaps(f.flaps), f.symmetry, str(f.copies), word))
    heads = ("#", "flaps", "symmetry", "copies", "mirror image")
    console.print(Table(heads, rows, "", "rllrl", framed=False))


def print_branch(branch: ConeBranch, elevation: float, console: Console) -> None:
    """Print the fold angles of one state of a branch.

    Parameters
    ----------
    branch
        Of `branch`.
    elevation
        v, signed [rad].
    console
        Of rich.
    """
    phi = branch.fold_angles(elevation)
    console.print(
        f"branch {branch!r}, symmetry {branch.symmetry}, elevation {format_angle(elevation)}; "
        f"ends at |elevation| = {format_angle(branch.end)}: {branch.end_text}"
    )
    rows = [
        (str(number), f"{angle:.15g}", f"{np.degrees(angle):.12g}")
        for number, angle in enumerate(phi.tolist(), start=1)
    ]
    console.print(Table(("crease", "fold angle [rad]", "[deg]"), rows, "", "rrr", framed=False))


def print_diagram(diagram: PhaseDiagram, console: Console) -> None:
    """Return which numbers occur and how much of the map each takes, and count the boundaries.

    Parameters
    ----------
    diagram
        Of `phase_diagram`.
    console
        Of rich.
    """
    numbers, often = np.unique(diagram.minima, return_counts=True)
    total = diagram.map.branches
    rows = [
        [f"{int(n)}/{total}", f"{int(n) / total:.6g}", f"{k / diagram.minima.size:.2%}"]
        for n, k in zip(numbers, often, strict=True)
    ]
    console.print(folding_table(("branch minima", "normalised", "share of the map"), rows, ""))
    kinds = Counter(b.kind for b in diagram.boundaries)
    console.print("boundaries: " + ", ".join(f"{k} {n}" for k, n in kinds.items()))


def print_full_space(found: ConeFullSpace, console: Console) -> None:
    """Print one row for each arrangement, direction and minimum, and the totals over all branches.

    The slope is the norm of the energy's gradient along closed states (0 for an equilibrium).

    Parameters
    ----------
    found
        Of `full_space`.
    console
        Of rich.
    """
    reasons = list(dict.fromkeys(_reason(s) for s in found.states))
    rows = [
        [
            repr(s.branch),
            str(s.copies),
            s.kind,
            f"{s.elevation:.4f}",
            f"{s.depth:.4g}",
            "singular" if np.isnan(s.residual) else f"{s.residual:.2e}",
            s.verdict,
            f"[{reasons.index(_reason(s)) + 1}]",
        ]
        for s in found.states
    ]
    title = f"cone of degree {found.cone.degree}, r_k = {found.ratio:g}, nu_0 = {found.rest.elevation:g}"
    console.print(folding_table(FULL_HEADS, rows, title))
    for k, reason in enumerate(reasons, start=1):
        console.print(f"[{k}] {reason}")
    words = [f"{found.count(v)} {v}" for v in ("stable", "unstable", "undecided")]
    console.print(f"of {found.count()} branch minima: " + ", ".join(words))


def _reason(state: JudgedMinimum) -> str:
    """Certificate without the number of states of the descent."""
    return re.sub(r"a descent of \d+", "a descent of", state.full_space.certificate)
