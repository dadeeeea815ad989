"""Results as JSON, schema ``origami-nlp/minima/1``: written whole or not at all, and read back.

Indices are 1-based, as in the paper; angles in radians; energies and moments in the scene's units.
A multiplier range that never ends, or a residual that does not apply, is null.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import Any

from origami_nlp.errors import OptionError
from origami_nlp.kkt import ContactForce
from origami_nlp.minima.find import MinimaResult, Minimum, Rejected, SearchReport
from origami_nlp.minima.full_space import FullSpace, LandsOn
from origami_nlp.pattern import Relation, Relations, scene_from_dict, scene_to_dict
from origami_nlp.programme import Model

SCHEMA = "origami-nlp/minima/1"


def result_to_dict(result: MinimaResult) -> dict[str, Any]:
    """Return a result as plain JSON data."""
    model, search = result.model, result.search
    return {
        "schema": SCHEMA,
        "scene": scene_to_dict(result.scene),
        "model": {
            "variables": model.size,
            "equalities": model.equation_count,
            "inequalities": model.inequality_count,
            "contact_pairs": [list(pair) for pair in model.contact_pairs],
            "geometry": _relations_to_dict(result.scene.relations),
            "left_out": [{"what": item.what, "why": item.why} for item in model.left_out],
        },
        "search": {
            "starts": search.starts,
            "feasible_starts": search.feasible_starts,
            "solves": search.solves,
            "iterations": search.iterations,
            "statuses": search.statuses,
            "outcomes": search.outcomes,
            "expected_undiscovered": _finite(search.expected_undiscovered),
            "stopped_by": search.stopped_by,
            "seconds": search.seconds,
            "seed": search.seed,
            "rejected": [_rejected_to_dict(r) for r in search.rejected],
            "undecided": [_rejected_to_dict(r) for r in search.undecided],
        },
        "minima": [_minimum_to_dict(m) for m in result.minima],
    }


def _relations_to_dict(relations: Relations) -> dict[str, Any]:
    data = asdict(relations)
    for key in ("made_exact", "different"):
        data[key] = [
            {**asdict(r), "signs": list(r.signs), "text": r.text} for r in getattr(relations, key)
        ]
    return {**data, "sector_angles": list(relations.sector_angles)}


def _relations_from_dict(data: dict[str, Any]) -> Relations:
    data = {**data, "sector_angles": tuple(data["sector_angles"])}
    for key in ("made_exact", "different"):
        rows = [{k: v for k, v in r.items() if k != "text"} for r in data[key]]
        data[key] = tuple(Relation(**{**r, "signs": tuple(r["signs"])}) for r in rows)
    return Relations(**data)


def _rejected_to_dict(r: Rejected) -> dict[str, Any]:
    return {**asdict(r), "fold_angles": list(r.fold_angles)}


def _rejected_from_dict(data: dict[str, Any]) -> Rejected:
    return Rejected(**{**data, "fold_angles": tuple(data["fold_angles"])})


def _minimum_to_dict(m: Minimum) -> dict[str, Any]:
    return {
        "energy": m.energy,
        "fold_angles": list(m.fold_angles),
        "kind": m.kind,
        "local_dimension": m.local_dimension,
        "closure_residual": m.closure_residual,
        "kkt_residual": _finite(m.kkt_residual),
        "polished": m.polished,
        "hits": m.hits,
        "contacts": [
            {
                "type": c.type,
                **({"creases": list(c.creases)} if c.creases else {"facets": list(c.facets)}),
                "multiplier": c.multiplier,
                "multiplier_range": [_finite(v) for v in c.multiplier_range],
                "text": c.text,
            }
            for c in m.contacts
        ],
        "certificate": m.certificate,
        "hessian_eigenvalues": list(m.hessian_eigenvalues),
        **({"full_space": _full_space_to_dict(m.full_space)} if m.full_space else {}),
    }


def _full_space_to_dict(f: FullSpace) -> dict[str, Any]:
    return {
        **asdict(f),
        "hessian_eigenvalues": list(f.hessian_eigenvalues),
        "breaking_eigenvalues": list(f.breaking_eigenvalues),
        "descent": f.descent
        and [{"fold_angles": list(angles), "energy": energy} for angles, energy in f.descent],
        "lands_on": f.lands_on
        and {**asdict(f.lands_on), "fold_angles": list(f.lands_on.fold_angles)},
    }


def _full_space_from_dict(data: dict[str, Any]) -> FullSpace:
    lands_on, descent = data["lands_on"], data["descent"]
    return FullSpace(
        **{
            **data,
            "hessian_eigenvalues": tuple(data["hessian_eigenvalues"]),
            "breaking_eigenvalues": tuple(data["breaking_eigenvalues"]),
            "descent": descent and tuple((tuple(d["fold_angles"]), d["energy"]) for d in descent),
            "lands_on": lands_on
            and LandsOn(**{**lands_on, "fold_angles": tuple(lands_on["fold_angles"])}),
        }
    )


def result_from_dict(data: dict[str, Any]) -> MinimaResult:
    """Rebuild a result from `result_to_dict` (the model is posed anew from the scene).

    Raises
    ------
    OptionError
        If `data` is not of this schema.
    """
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise OptionError(f"not a result of schema {SCHEMA}")
    scene = scene_from_dict(data["scene"])
    if "geometry" in data["model"]:
        scene = replace(scene, relations=_relations_from_dict(data["model"]["geometry"]))
    search = dict(data["search"])
    for key in ("rejected", "undecided"):
        search[key] = tuple(_rejected_from_dict(r) for r in search.pop(key, ()))
    search["expected_undiscovered"] = _number(search["expected_undiscovered"], math.inf)
    minima = []
    for m in data["minima"]:
        contacts = tuple(
            ContactForce(
                c["type"],
                tuple(c.get("creases", ())),
                tuple(c.get("facets", ())),
                c["multiplier"],
                (c["multiplier_range"][0], _number(c["multiplier_range"][1], math.inf)),
                c["text"],
            )
            for c in m["contacts"]
        )
        minima.append(
            Minimum(
                m["energy"],
                tuple(m["fold_angles"]),
                m["kind"],
                m["local_dimension"],
                m["closure_residual"],
                _number(m["kkt_residual"], math.nan),
                m["polished"],
                m["hits"],
                contacts,
                m["certificate"],
                tuple(m["hessian_eigenvalues"]),
                _full_space_from_dict(m["full_space"]) if "full_space" in m else None,
            )
        )
    return MinimaResult(scene, Model(scene), tuple(minima), SearchReport(**search))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _number(value: float | None, missing: float) -> float:
    return missing if value is None else float(value)
