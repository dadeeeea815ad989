"""All minima of a sheet of vertices of degree four: all of them fold flat (`products`), or none does (`quads`)."""

from __future__ import annotations

import math
import time

import numpy as np
from flint import arb

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern, in_plane
from origami_nlp.proof.products import FoldingSheet, ProductSearch, as_folding
from origami_nlp.proof.quads import QuadSearch, QuadSheet, as_quads
from origami_nlp.proof.result import Proof
from origami_nlp.proof.sheets import Budget, flat_sheet, precision


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
    """Return why a list of a sheet that is proved within fold limits is not one with contact; "" where it is.

    Facets round a vertex do not cross where it closes turned by no full turn and no crease is beyond +-pi: each is
    convex and so within the cone of its sector.  The four sectors are a closed curve of length 2 pi on the sphere, so
    within a hemisphere; seen from its centre that is a quadrangle in the plane, of whose two pairs of opposite sides
    one crosses at most.  A crossing would be a full turn more, and such states are none of the sheet's.

    Parameters
    ----------
    pattern
        A sheet of which `why_no_sheet` says nothing.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_contact
    >>> why_no_contact(o.examples.pattern("metasheet", 2, 3))
    'contact of sheets of several vertices is not proved'
    """
    sheet, _ = as_sheet(pattern)
    if sheet is not None and sheet.folds_flat:
        return "contact of sheets that fold flat is not proved"
    if len(pattern.vertices) > 1:
        return "contact of sheets of several vertices is not proved"
    if len(pattern.polygons) != pattern.facets:
        return "a facet is of several pieces"
    if not all(_is_convex(in_plane(pattern)[list(p)]) for p in pattern.polygons):
        return "a facet is not convex"
    return ""


def _is_convex(x: np.ndarray) -> bool:
    """Return whether a polygon [q, 2] is convex, exactly; corners of 180 degrees may be."""
    p = [[arb(float(a)) for a in row] for row in x]
    u = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(p, p[1:] + p[:1], strict=True)]
    turns = [a[0] * b[1] - a[1] * b[0] for a, b in zip(u, u[1:] + u[:1], strict=True)]
    return not any(t < 0 for t in turns) or not any(t > 0 for t in turns)


def prove_sheet(pattern: Pattern, *, boxes: int = 1_000_000, until: float = math.inf) -> Proof:
    """Find every minimum of the energy of a sheet of vertices of degree four within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Flat vertices of degree four, in any order, with cycles; all fold flat, or none does and no opposite creases of
        one are in a line.
    boxes
        At most so many intervals of curves; what is left is undecided.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    Proof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such sheet: `why_no_sheet` says why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import prove_sheet
    >>> proof = prove_sheet(o.examples.pattern("metasheet", 3, 3))
    >>> len(proof.minima), proof.complete
    (3, True)
    >>> proof = prove_sheet(o.examples.pattern("miura", 2, 3))
    >>> len(proof.minima), proof.complete
    (14, True)
    """
    started = time.process_time()
    sheet, why = as_sheet(pattern)
    if sheet is None:
        raise OptionError(f"pattern = {pattern.title}: no sheet that can be proved: {why}")
    budget = Budget(boxes, lambda: time.monotonic() > until)
    with precision():
        search = (
            ProductSearch(sheet, budget)
            if isinstance(sheet, FoldingSheet)
            else QuadSearch(sheet, budget)
        )
        search.run()
    exactly = "; of the sheet whose relations of sectors are exact, as the file's are to"
    over = f"all closed states within fold limits are {search.over}"
    over += f"{exactly} {sheet.deviation:.2g} rad" * bool(sheet.deviation)
    return Proof(
        points=tuple(search.minima),
        regions=tuple(search.open),
        boxes=budget.looked,
        seconds=time.process_time() - started,
        over=over
        + f"; laid into its plane to {sheet.sheet.moved:.2g} rad" * bool(sheet.sheet.moved),
    )
