"""Cones as tables for a terminal: minima of the classes of branches, different foldings, one state."""

from __future__ import annotations

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.cone.branches import ConeBranch, class_label
from origami_nlp.cone.flaps import (
    bracelet_number,
    bracelets,
    necklace_number,
    necklaces,
    write_flaps,
)
from origami_nlp.cone.minima import ConeCount
from origami_nlp.pattern import format_angle

MOST_ROWS = 60
LONGEST_NUMBER = 9
"""Digits of an integer written out in tables."""


def number_words(number: int) -> str:
    """Write an integer with separators, or as 1.23e150 where it is long."""
    text = str(number)
    if len(text) <= LONGEST_NUMBER:
        return f"{number:,}"
    return f"{text[0]}.{text[1:4]}e{len(text) - 1}"


def share_words(part: int, whole: int) -> str:
    """Write part/whole as a decimal, also for integers beyond the range of floats."""
    return f"{part * 10**8 // whole / 10**8:.6g}"


def print_count(count: ConeCount, console: Console, most: int = MOST_ROWS) -> None:
    """Print the numbers of branch minima, then a row for each class and minimum, deepest first."""
    whole = count.branches
    rest = count.rest
    console.print(
        f"cone of degree {count.degree}, r_k = {count.ratio:g}, rest elevation "
        f"{format_angle(rest.elevation)} ({rest.rule}), branches end by the {count.end_rule} rule"
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
    for valleys, changes, direction in count.undecided[:8]:
        label = class_label(valleys, changes, count.degree, direction)
        console.print(f"  tie to rounding on {label}: slope 0 at an end, or a double zero")
    if len(count.undecided) > 8:
        console.print(f"  and ties on {len(count.undecided) - 8} more classes")
    if not len(count.minima):
        return
    console.print(count_table(count, most))
    if len(count.minima) > most:
        console.print(f"{len(count.minima) - most} more rows: --json FILE has all")


def count_table(count: ConeCount, most: int = MOST_ROWS) -> Table:
    """Return one row a class and minimum, deepest first; those at an end with their multiplier."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("branches", no_wrap=True)
    for head in ("changes", "number", "elevation", "energy", "depth"):
        table.add_column(head, justify="right", no_wrap=True)
    table.add_column("kind", no_wrap=True)
    m = count.minima
    for k in np.argsort(-m.depth, kind="stable")[:most].tolist():
        valleys, changes = int(m.valleys[k]), int(m.changes[k])
        label = class_label(valleys, changes, count.degree, int(m.direction[k]))
        table.add_row(
            Text(label.split(" (")[0]),
            str(changes),
            number_words(m.multiplicity[k]),
            f"{m.elevation[k]:.7f}" if abs(m.elevation[k]) > 1e-3 else f"{m.elevation[k]:.3e}",
            f"{m.energy[k]:.5g}",
            f"{m.depth[k]:.4g}",
            "interior" if m.interior[k] else f"{m.kind[k]}, {m.multiplier[k]:.4g}",
        )
    return table


def print_foldings(degree: int, console: Console, listed: bool) -> None:
    """Print how many foldings of a degree differ, and which where `listed`."""
    console.print(
        f"cone of degree {degree}: {number_words(1 << (degree // 2))} assignments at an elevation, of which differ\n"
        f"  by more than a rotation (necklaces): {number_words(necklace_number(degree))}\n"
        f"  by more than rotation and reflection (bracelets): {number_words(bracelet_number(degree))}\n"
        "valleys and mountains are not swapped; with both signs of the elevation, turning the sheet over "
        "leaves the same numbers"
    )
    if not listed:
        return
    kept = {f.flaps for f in bracelets(degree)}
    table = Table(box=box.SIMPLE_HEAD)
    for head, justify in (
        ("#", "right"),
        ("flaps", "left"),
        ("symmetry", "left"),
        ("copies", "right"),
        ("mirror image", "left"),
    ):
        table.add_column(head, justify=justify, no_wrap=True)  # type: ignore[arg-type]
    for number, f in enumerate(necklaces(degree), start=1):
        word = "itself" if not f.chiral else "another" if f.flaps in kept else "listed above"
        table.add_row(str(number), write_flaps(f.flaps), f.symmetry, str(f.copies), word)
    console.print(table)


def print_branch(branch: ConeBranch, elevation: float, console: Console) -> None:
    """Print the fold angles of one state of a branch."""
    phi = branch.fold_angles(elevation)
    console.print(
        f"branch {branch!r}, symmetry {branch.symmetry}, elevation {format_angle(elevation)}; "
        f"ends at |elevation| = {format_angle(branch.end)}: {branch.end_text}"
    )
    table = Table(box=box.SIMPLE_HEAD)
    for head in ("crease", "fold angle [rad]", "[deg]"):
        table.add_column(Text(head), justify="right", no_wrap=True)
    for number, angle in enumerate(phi.tolist(), start=1):
        table.add_row(str(number), f"{angle:.15g}", f"{np.degrees(angle):.12g}")
    console.print(table)
