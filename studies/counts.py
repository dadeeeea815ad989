"""How many stable states sheets have as they grow, with contact and within fold limits alone, each state certified.

`metasheet`, `miura`: the examples with their springs, n x n facets.  `twists`: n x n square twists with pleats between
them, springs at rest at 70 degrees along one branch of the flat state.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.actuation import actuate
from origami_nlp.errors import OutOfTime
from origami_nlp.pattern import Pattern, examples, make_pattern
from origami_nlp.proof import (
    certificate_of_mesh,
    check_proof,
    prove_mesh,
    why_no_mesh,
    why_no_mesh_contact,
)
from origami_nlp.verbs import find_minima

SIZES = {"metasheet": range(2, 9), "miura": range(2, 9), "twists": range(1, 9)}
"""Rows, and as many columns, of each family."""
CONTACTS = ("full", "fold-limits")
ALPHA, REST = np.pi / 3, np.radians(70)
"""Angle of pleats, and size of the rest angles of square twists [rad]."""
MODES = 20_000
"""Ways to fold the vertices of a mesh, each by itself, up to which all its minima are proved: 3^9 of Miura 4 x 4."""
LOOK = {"metasheet": "#1f77b4", "miura": "#c1121f", "twists": "#2a7f3f"}


@dataclass(frozen=True)
class SheetCount:
    """Stable states of one sheet.

    Attributes
    ----------
    family, size, creases, vertices
        Which sheet.
    contact
        ``full``: facets must not cross; ``fold-limits``: they may.
    states
        How many were found.
    certified
        How many of these have a certificate as strict minima: all, or the search would not list them; of a list that is
        proved by curves, how many the check found again.
    undecided
        States that were found and not decided.
    complete
        ``proved``: by the search; ``proved by curves``: all minima of a mesh that folds flat, found again by
        `check-proof`; or ``searched``: there may be more.
    enumerated
        Whether flat-folded states, from where curves leave, were all gone through: else whole curves may be missing.
    left_out
        What the time did not suffice for; "" where the search came to its end.
    """

    family: str
    size: int
    creases: int
    vertices: int
    contact: str
    states: int
    certified: int
    undecided: int
    complete: str
    enumerated: bool
    left_out: str

    @property
    def is_whole(self) -> bool:
        """Whether the search came to its end, with nothing left out that it can list, and decided on all it found."""
        return self.enumerated and not self.left_out and not self.undecided


def twists(size: int) -> Pattern:
    """Make size x size square twists, with pleats between and around them.

    Parameters
    ----------
    size
        Rows, and columns.

    Returns
    -------
    Pattern
        Facets between straight rows and columns of points: steps of squares and of pleats in turn.

    Examples
    --------
    >>> from studies.counts import twists
    >>> twists(2)
    Pattern('twists:2x2': 25 facets, 40 creases, 16 interior vertices)
    """
    turn = np.pi / 2 - ALPHA
    steps = [np.array([np.cos(turn), np.sin(turn)]), np.array([1.0, 0.0])]
    along = np.cumsum([np.zeros(2), *(steps[k % 2] for k in range(2 * size + 1))], axis=0)
    up = along @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    points, n = (along[:, None] + up[None]).reshape(-1, 2), 2 * size + 2
    faces = [
        (i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1)
        for i in range(n - 1)
        for j in range(n - 1)
    ]
    return make_pattern(points, faces, name=f"twists:{size}x{size}")


def sheet(family: str, size: int, seconds: float = 60.0) -> Pattern:
    """Return a sheet with its springs.

    Parameters
    ----------
    family, size
        Which, see `SheetCount`.
    seconds
        For the branches of twists, which their springs follow, of wall time.

    Returns
    -------
    Pattern
        With springs.

    Raises
    ------
    OutOfTime
        If branches are not known when the time is over: springs are not to hang on the machine.

    Examples
    --------
    >>> from studies.counts import sheet
    >>> sheet("miura", 2).creases
    4
    """
    if family != "twists":
        return examples.pattern(f"{family}:{size}x{size}")
    plain = twists(size)
    seen = actuate(plain, seconds=seconds)
    first = seen.branches
    if seen.left_out:
        raise OutOfTime(f"{plain.title}: {seen.left_out[0]}")
    if not first:  # too many to be enumerated
        return plain.with_springs(0.02, [REST] * plain.creases)
    signs = np.sign(np.round(first[0].velocities[:, 0], 9))
    return plain.with_springs(0.02, (REST * signs).tolist())


def count_states(family: str, size: int, contact: str, seconds: float = 60.0) -> SheetCount:
    """Search for the stable states of one sheet.

    Parameters
    ----------
    family, size, contact
        Which, see `SheetCount`.
    seconds
        For the search, and for the springs, of wall time.

    Returns
    -------
    SheetCount
        What was found.

    Examples
    --------
    >>> from studies.counts import count_states
    >>> count_states("metasheet", 2, "full").states
    3
    """
    try:
        pattern = sheet(family, size, seconds)
    except OutOfTime as late:
        creases, vertices = 4 * size * (2 * size + 1), (2 * size) ** 2
        return SheetCount(
            family, size, creases, vertices, contact, 0, 0, 0, "searched", False, str(late)
        )
    if contact == "full" and not (why_no_mesh(pattern, MODES) or why_no_mesh_contact(pattern)):
        sure = _proved(family, size, pattern, contact, seconds)
        if sure.is_whole:
            return sure
    elif len(pattern.vertices) > 1 and not why_no_mesh(pattern, MODES):
        return _proved(family, size, pattern, contact, seconds)
    found = find_minima(pattern, contact=contact, escape=False, seconds=seconds)
    status = getattr(found.completeness, "status", "")
    search: Any = found.search
    return SheetCount(
        family, size, pattern.creases, len(pattern.vertices), contact, len(found.minima),
        sum(m.verdict == "minimum" and bool(m.certificate) for m in found.minima),
        len(search.undecided), "proved" if status == "proved" else "searched",
        not search.not_enumerated, "; ".join(search.left_out),
    )  # fmt: skip


def _proved(family: str, size: int, pattern: Pattern, contact: str, seconds: float) -> SheetCount:
    """Count all minima of a mesh that folds flat, and let the check find them again."""
    until = time.monotonic() + seconds
    proof = prove_mesh(pattern, contact=contact == "full", until=until, modes=MODES)
    late = "; ".join(sorted({why for *_, why in proof.undecided}))
    checked = None if late else check_proof(certificate_of_mesh(pattern, proof))
    again = 0 if checked is None or checked.refused else len(checked.minima)
    sure = checked is not None and not checked.open and again == len(proof.minima)
    return SheetCount(
        family, size, pattern.creases, len(pattern.vertices), contact, len(proof.minima), again,
        len(proof.undecided), "proved by curves" if sure else "searched", sure, late,
    )  # fmt: skip


def count_all(
    largest: int,
    seconds: float = 60.0,
    until: float = float("inf"),
    report: Callable[[SheetCount], object] = lambda _: None,
) -> Iterator[SheetCount]:
    """Count the states of all sheets up to a size, the small ones of all families first.

    Parameters
    ----------
    largest
        Rows.
    seconds
        For each search.
    until
        Value of `time.monotonic` after which none begins.
    report
        Called with each.

    Yields
    ------
    SheetCount
        One a sheet and kind of contact.
    """
    for size in range(1, largest + 1):
        for family in (name for name, sizes in SIZES.items() if size in sizes):
            for contact in CONTACTS:
                if time.monotonic() < until:
                    found = count_states(family, size, contact, seconds)
                    report(found)
                    yield found


def draw_counts(counts: list[SheetCount]) -> Figure:
    """Draw numbers of states over the number of rows: filled with contact, open without; crossed where the time ended,
    or not all flat-folded states were gone through."""
    figure = Figure(figsize=(8.2, 4.0), layout="constrained")
    axes = figure.add_subplot()
    for family, colour in LOOK.items():
        for contact, style in (("full", "-"), ("fold-limits", ":")):
            some = [c for c in counts if (c.family, c.contact) == (family, contact)]
            if not some:
                continue
            words = "facets do not cross" if contact == "full" else "facets may cross"
            fill = colour if contact == "full" else "white"
            look: Any = {"color": colour, "marker": "o", "mfc": fill, "ms": 6}
            sure = [c.states if c.is_whole else np.nan for c in some]
            sizes = [c.size for c in some]
            axes.plot(sizes, sure, ls=style, label=f"{family}, {words}", **look)
            axes.plot(sizes, [c.states for c in some], ls="", **look)
            cut = [(c.size, c.states) for c in some if not c.is_whole]
            if cut:
                axes.plot(*zip(*cut, strict=True), "x", color="black", ms=9, zorder=4)
    axes.plot([], [], "x", color="black", ms=9, label="at least so many")
    axes.set(xlabel="n, of n x n", ylabel="stable states found", yscale="log")
    axes.set_xticks(sorted({c.size for c in counts}))
    axes.grid(alpha=0.3)
    figure.legend(fontsize=8, frameon=False, loc="outside right center")
    return figure
