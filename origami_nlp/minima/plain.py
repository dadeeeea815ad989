"""Results as JSON, schema ``origami-nlp/minima/1``: written whole or not at all, and read back.

Indices are 1-based, as in the paper; angles in radians; energies and moments in the scene's units.
A multiplier range that never ends, or a residual that does not apply, is null.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from origami_nlp.errors import OptionError
from origami_nlp.minima.minimum import Minimum, SearchReport
from origami_nlp.minima.result import MinimaResult
from origami_nlp.pattern import Relations, scene_from_dict, scene_to_dict
from origami_nlp.programme import Model
from origami_nlp.show import check_schema, from_plain, pick, to_plain

SCHEMA = "origami-nlp/minima/1"
NULL = {"expected_undiscovered": math.inf, "multiplier_range": math.inf}
"""What null stands for, by field; nan elsewhere."""


def result_to_dict(result: MinimaResult) -> dict[str, Any]:
    """Return a result as plain JSON data."""
    relations = to_plain(result.scene.relations)
    for key in ("made_exact", "different"):
        found = getattr(result.scene.relations, key)
        relations[key] = [{**to_plain(r), "text": r.text} for r in found]
    return {
        "schema": SCHEMA,
        "scene": scene_to_dict(result.scene),
        "model": pick(
            result.model,
            "variables=size",
            "equalities=equation_count",
            "inequalities=inequality_count",
            "contact_pairs",
            geometry=relations,
            left_out=[pick(item, "what", "why") for item in result.model.left_out],
        ),
        "search": to_plain(result.search),
        "minima": [_minimum_to_dict(m) for m in result.minima],
    }


def _minimum_to_dict(m: Minimum) -> dict[str, Any]:
    data = to_plain(m)
    for contact in data["contacts"]:  # who touches: creases or facets
        del contact["facets" if contact["creases"] else "creases"]
    if m.full_space is None:
        del data["full_space"]
    return data


def result_from_dict(data: dict[str, Any]) -> MinimaResult:
    """Rebuild a result from `result_to_dict` (the model is posed anew from the scene).

    Raises
    ------
    OptionError
        If `data` is not of this schema.
    """
    check_schema(data, SCHEMA, OptionError)
    scene = scene_from_dict(data["scene"])
    if "geometry" in data["model"]:
        scene = replace(scene, relations=from_plain(Relations, data["model"]["geometry"]))
    search = from_plain(SearchReport, data["search"], NULL)
    minima = []
    for m in data["minima"]:
        contacts = [{"creases": (), "facets": (), **c} for c in m["contacts"]]
        minima.append(from_plain(Minimum, {**m, "contacts": contacts}, NULL))
    return MinimaResult(scene, Model(scene), tuple(minima), search)
