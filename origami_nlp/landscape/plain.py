"""A landscape as JSON, schema ``origami-nlp/landscape/1``: space, critical points, barriers, minima, boundary.

Indices are 1-based, angles in radians, energies in the scene's units; what does not exist (an index, a barrier that no
path crosses) is null.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.files import pick, to_plain
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.pattern import scene_to_dict

if TYPE_CHECKING:
    from origami_nlp.barriers import Barriers
    from origami_nlp.critical import CriticalPoints
    from origami_nlp.space import Space

SCHEMA = "origami-nlp/landscape/1"
FROM_SPACE = ("components", "holes", "pinch_points", "handles", "euler_characteristic")


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
        Of the schema ``origami-nlp/landscape/1``.
    """
    found, topology = critical.to_dict(), space.to_dict()
    minima = [
        {
            "number": number,
            **pick(m, "fold_angles", "energy", "kind", "local_dimension"),
            "full_space": m.full_space.verdict if m.full_space else None,
            **pick(place, "branch", "point", "family"),
        }
        for number, (m, place) in enumerate(
            zip(exact.result.minima, exact.places, strict=True), start=1
        )
    ]
    return {
        "schema": SCHEMA,
        "scene": scene_to_dict(exact.result.scene),
        "coordinates": list(exact.chart.coordinates),
        **{name: topology[name] for name in FROM_SPACE},
        "critical_points": found["points"],
        "morse_sum": critical.morse_sum,
        "morse": {
            "closes": critical.morse_sum == space.euler_characteristic,
            "text": critical.verdict(space.euler_characteristic).text,
            "doubts": list(critical.doubts),
        },
        "barriers": [step.to_dict() for step in barriers.passes],
        "merges": to_plain(barriers.merges),
        "counts": dict(zip(("symmetric", "not_ruled_out", "full"), exact.counts, strict=True)),
        "minima": minima,
        "metastable": [
            pick(part, "branch", "contacts", "length", "one_chart_point=hidden")
            | _ends(part.points)
            for part in exact.metastable
        ],
        "boundary": [
            pick(line, "branch", "contacts", "length", "handle=thin") | _ends(line.fold_angles)
            for line in (exact.boundary.lines if exact.boundary else ())
        ],
    }


def _ends(line: np.ndarray) -> dict[str, Any]:
    """Return where a line starts and ends."""
    return {"from": line[0].tolist(), "to": line[-1].tolist()}
