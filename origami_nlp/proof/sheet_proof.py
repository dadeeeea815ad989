"""All minima of a sheet of vertices of degree four: all of them fold flat (`products`), or none does (`quads`)."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern
from origami_nlp.proof.facets import why_no_contact_of_quads
from origami_nlp.proof.products import FoldingSheet, ProductSearch, as_folding
from origami_nlp.proof.quad_states import QuadSheet, as_quads
from origami_nlp.proof.quads import QuadSearch
from origami_nlp.proof.sheets import SheetMinimum, flat_sheet, precision
from origami_nlp.proof.slopes import Budget


@dataclass(frozen=True, kw_only=True)
class SheetProof:
    """What is proved of a sheet.

    Attributes
    ----------
    folds_flat
        Whether all its vertices do: its states are products of curves; of others they are curves and rigid states.
    curves
        Curves of closed states.
    sets
        Of sheets that fold flat, which rows are 0, at +-180 degrees or move; of others, choices of a mode at each
        vertex that do not contradict each other in signs.
    alone
        Of sheets that fold flat, sets of states alone; of others, rigid states beside the flat one.
    minima
        Each once.
    maxima
        How many maxima of the energy lie inside the curves.
    undecided
        What is left open: between which fold angles [n], [n], and why.
    deviation
        By how much sectors of the sheet differ from those that are meant, at most [rad].
    moved
        By how much laying the sheet into the plane moved a crease, at most [rad]; 0 where it lies there.
    boxes, seconds
        Intervals of curves, and the processor time that they took.
    contact
        Whether states in which facets cross are left out, and minima that touching facets hold are listed.
    """

    folds_flat: bool
    curves: int
    sets: int
    alone: int
    minima: tuple[SheetMinimum, ...]
    maxima: int
    undecided: tuple[tuple[np.ndarray, np.ndarray, str], ...]
    deviation: float
    moved: float
    boxes: int
    seconds: float
    contact: bool = False

    @property
    def over(self) -> str:
        """Over which states the statement ranges, in words."""
        curves = f"{self.curves} curve{'s' * (self.curves != 1)}"
        if self.folds_flat:
            states = (
                f"are products of {curves}, along which tangents of half the fold angles are proportional ({self.sets} "
                f"sets of rows that move, {self.alone} of them of flat and flat-folded states alone)"
            )
            meant = "vertices fold flat and whose equal sectors are equal exactly"
        else:
            states = (
                f"are the flat state, {self.alone} rigid states that stand alone, and {curves} through it, along which "
                f"vertices of equal sectors fold alike ({self.sets} choices of a mode at each vertex, the others "
                "excluded by intervals)"
            )
            meant = "equal sectors are equal exactly"
        facets = ", and facets are apart, touch or cross over intervals of them" * self.contact
        exactly = (
            f"; of the sheet whose {meant}, as the file's are to {self.deviation:.2g} rad"
            * bool(self.deviation)
        )
        laid = f"; laid into its plane to {self.moved:.2g} rad" * bool(self.moved)
        return f"all closed states within fold limits {states}{facets}{exactly}{laid}"


def as_sheet(pattern: Pattern) -> tuple[FoldingSheet | QuadSheet | None, str]:
    """Return the sheet of a pattern as its proof reads it, or None and why its closed states are not enumerated."""
    sheet, why = flat_sheet(pattern)
    if sheet is None:
        return None, why
    with precision():
        return as_folding(sheet) if sheet.folds_flat else as_quads(sheet)


def why_no_sheet(pattern: Pattern) -> str:
    """Return why not all closed states of a pattern are known as those of a sheet; "" where they are.

    Parameters
    ----------
    pattern
        Of any number of vertices.

    Returns
    -------
    str
        The first vertex that is in the way, and why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_sheet
    >>> why_no_sheet(o.examples.pattern("metasheet", 3, 3))
    ''
    >>> why_no_sheet(o.examples.pattern("waterbomb", 2, 2))
    'vertex 0 has not four creases'
    """
    return as_sheet(pattern)[1]


def why_no_contact(pattern: Pattern) -> str:
    """Return why contact between the facets of a sheet is not proved; "" where it is.

    Parameters
    ----------
    pattern
        A sheet of which `why_no_sheet` says nothing.

    Returns
    -------
    str
        The first reason.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_contact
    >>> why_no_contact(o.examples.pattern("metasheet", 2, 3))
    ''
    """
    sheet, _ = as_sheet(pattern)
    if sheet is not None and sheet.folds_flat:
        return "contact of sheets that fold flat is not proved"
    return why_no_contact_of_quads(pattern)


def prove_sheet(
    pattern: Pattern, *, contact: bool = False, boxes: int = 1_000_000, until: float = math.inf
) -> SheetProof:
    """Find every minimum of the energy of a sheet of vertices of degree four within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Flat vertices of degree four, in any order, with cycles; all fold flat, or none does and no opposite creases of
        one are in a line.
    contact
        Whether facets must not cross; of sheets that need not fold flat.
    boxes
        At most so many intervals of curves; what is left is undecided.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    SheetProof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such sheet, or its contact cannot be proved: `why_no_sheet` and `why_no_contact` say why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import prove_sheet
    >>> proof = prove_sheet(o.examples.pattern("metasheet", 3, 3))
    >>> proof.curves, proof.alone, len(proof.minima), proof.undecided
    (2, 0, 3, ())
    >>> proof = prove_sheet(o.examples.pattern("miura", 2, 3))
    >>> proof.curves, len(proof.minima), proof.undecided
    (6, 14, ())
    """
    started = time.process_time()
    sheet, why = as_sheet(pattern)
    if sheet is None:
        raise OptionError(f"pattern = {pattern.title}: no sheet that can be proved: {why}")
    if contact and (why := why_no_contact(pattern)):
        raise OptionError(f"pattern = {pattern.title}: its contact cannot be proved: {why}")
    budget = Budget(boxes, lambda: time.monotonic() > until)
    with precision():
        search = (
            ProductSearch(sheet, budget)
            if isinstance(sheet, FoldingSheet)
            else QuadSearch(sheet, contact, budget)
        )
        search.run()
    return SheetProof(
        folds_flat=sheet.folds_flat,
        curves=search.curves,
        sets=search.sets,
        alone=search.alone,
        minima=tuple(search.minima),
        maxima=search.maxima,
        undecided=tuple(search.open),
        deviation=sheet.deviation,
        moved=sheet.sheet.moved,
        boxes=budget.looked,
        seconds=time.process_time() - started,
        contact=contact,
    )
