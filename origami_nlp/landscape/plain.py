"""A landscape as JSON, schema ``origami-nlp/landscape/1``: space, critical points, barriers, minima, boundary.

Indices are 1-based, angles in radians, energies in the scene's units; what does not exist (an index, a barrier that no
path crosses) is null.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.files import check_schema, pick, to_plain
from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.pattern import Scene, scene_from_dict, scene_to_dict

if TYPE_CHECKING:
    from origami_nlp.barriers import Barriers
    from origami_nlp.critical import CriticalPoints
    from origami_nlp.space import Space

SCHEMA = "origami-nlp/landscape/1"
FROM_SPACE = ("components", "holes", "pinch_points", "handles", "euler_characteristic")
LISTS = ("components", "pinch_points", "handles", "critical_points", "barriers", "minima")
COUNTS = ("holes", "euler_characteristic", "morse_sum")


@dataclass(frozen=True)
class LandscapeRecord:
    """What a landscape file says.

    Attributes
    ----------
    scene
        Of the file.
    components, pinch_points, handles
        Of the admissible space, one dictionary each.
    holes, euler_characteristic
        Of that space.
    critical_points
        ``fold_angles``, ``energy``, ``index``, ``contacts`` and more.
    morse_sum
        Over them; equal to euler_characteristic where the list is complete.
    barriers
        ``from``, ``to`` (numbers of minima), ``energy``, ``pass_kind`` and more.
    minima
        In order of energy.
    rest
        Other entries of the file.
    """

    scene: Scene
    components: tuple[dict[str, Any], ...]
    holes: int
    pinch_points: tuple[dict[str, Any], ...]
    handles: tuple[dict[str, Any], ...]
    euler_characteristic: int
    critical_points: tuple[dict[str, Any], ...]
    morse_sum: int
    barriers: tuple[dict[str, Any], ...]
    minima: tuple[dict[str, Any], ...]
    rest: dict[str, Any] = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data; inverse of `landscape_from_dict`."""
        lists = {name: list(getattr(self, name)) for name in LISTS}
        counts = {name: getattr(self, name) for name in COUNTS}
        return {
            "schema": SCHEMA,
            "scene": scene_to_dict(self.scene),
            **lists,
            **counts,
            **self.rest,
        }


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
        "critical_points": found.pop("critical_points"),
        "morse_sum": found.pop("morse_sum"),
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


def landscape_from_dict(data: Any) -> LandscapeRecord:
    """Read what `landscape_to_dict` wrote.

    Raises
    ------
    OptionError
        If `data` is not of this schema, or an entry is missing or of another type.
    """
    check_schema(data, SCHEMA, OptionError)
    for name in LISTS:
        found = data.get(name)
        if not isinstance(found, list) or not all(isinstance(e, dict) for e in found):
            raise OptionError(f"{name} = {repr(found)[:60]} must be a list of objects")
    for name in COUNTS:
        if isinstance(data.get(name), bool) or not isinstance(data.get(name), int):
            raise OptionError(f"{name} = {data.get(name)!r} must be a whole number")
    known = {"schema", "scene", *LISTS, *COUNTS}
    entries: dict[str, Any] = {name: tuple(data[name]) for name in LISTS}
    entries |= {name: data[name] for name in COUNTS}
    rest = {name: value for name, value in data.items() if name not in known}
    return LandscapeRecord(scene=scene_from_dict(data["scene"]), rest=rest, **entries)
