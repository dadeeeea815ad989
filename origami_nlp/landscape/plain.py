"""A landscape with its space, critical points and barriers, as JSON."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from origami_nlp.io import to_plain
from origami_nlp.landscape.exact import ExactLandscape

if TYPE_CHECKING:
    from origami_nlp.barriers import Barriers
    from origami_nlp.critical import CriticalPoints
    from origami_nlp.space import Space


def landscape_to_dict(
    exact: ExactLandscape, space: Space, critical: CriticalPoints, barriers: Barriers
) -> dict[str, Any]:
    """Return everything known of a landscape as plain JSON data.

    Parameters
    ----------
    exact, space, critical, barriers
        Of `find_landscape`, `find_space`, `find_critical_points` and `find_barriers`, of one scene.

    Returns
    -------
    dict
        ``exact.to_dict()`` and, under their names, the plain data of the others.
    """
    judged = replace(critical, morse=critical.verdict(space.euler_characteristic))
    parts = to_plain({"space": space, "critical": judged, "barriers": barriers})
    del parts["barriers"]["result"]
    return {**exact.to_dict(), **parts}
