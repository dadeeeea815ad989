"""Ways out of a closed state of a pattern whose flat vertices have degree four or less: its tangent cone, listed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from origami_nlp.facets import Closure
from origami_nlp.kkt import TangentCone, tangent_cone
from origami_nlp.pattern import Pattern


def list_branches(
    pattern: Pattern, phi: np.ndarray | None = None, check: Callable[[], None] = lambda: None
) -> TangentCone:
    """Enumerate the ways out of a closed state.

    Parameters
    ----------
    pattern
        The pattern.
    phi
        The state [n] [rad]; the reference state without.
    check
        Called every now and then: may raise to end it.

    Returns
    -------
    TangentCone
        Candidates to second order at each vertex: whether states follow is seen when they are walked.
    """
    n = pattern.creases
    nothing = np.zeros((0, n))
    if phi is None:
        phi = pattern.reference
        if not pattern.is_flat:
            return TangentCone(nothing, (), "the reference state is not flat")
    if pattern.holes:
        return TangentCone(nothing, (), "ways round holes are not enumerated")
    cone = tangent_cone(Closure(pattern).loops(phi), n, check)
    if not cone.split:
        degree = max(len(loop.creases) for loop in pattern.vertices)
        return TangentCone(
            nothing, (), f"vertices of degree {degree} have no modes to be enumerated"
        )
    return cone
