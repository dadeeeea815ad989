"""How often symmetric states may wind round the axis of their symmetry.

The product T of the folds of a period of C_n, or of two wedges of D_n, is repeated n times round the vertex, and the
whole is a sheet of paper where T^n = -1: T turns by w 2 pi/n, w odd, w <= n.  States of another w are on no path from
those of this one: T^n = -1 has no others in between.  Facets that must not cross leave w = 1 (docs/concepts.md).
"""

from __future__ import annotations

from origami_nlp.arguments import shown
from origami_nlp.errors import SceneError
from origami_nlp.pattern.symmetry import Symmetry


def windings_of(group: Symmetry, contact: str) -> tuple[int, ...]:
    """List how often states may wind.

    Parameters
    ----------
    group
        Which they keep.
    contact
        As of a `Scene`.

    Returns
    -------
    tuple of int
        Odd numbers up to the order of the group; 1 alone where facets do not cross.

    Examples
    --------
    >>> from origami_nlp import Scene, Vertex
    >>> star = Vertex(("pi/4",) * 8)
    >>> [Scene(star, (1, 2) * 4, (1,) * 8, "D4", contact).windings for contact in ("full", "fold-limits")]
    [(1,), (1, 3)]
    """
    return tuple(range(1, 2 if contact == "full" else group.order + 1, 2))


def check_winding(winding: object, group: Symmetry, contact: str) -> None:
    """Complain about a winding, where one is asked for, that states cannot have.

    Raises
    ------
    SceneError
        With the value, and what it may be.
    """
    known = windings_of(group, contact)
    if winding is not None and (isinstance(winding, bool) or winding not in known):
        raise SceneError(
            f"winding = {shown(winding)} must be one of {', '.join(map(str, known))}: symmetry {group.name}, "
            f"contact = {contact!r}"
        )
