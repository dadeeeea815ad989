"""Phase diagrams and full-space verdicts of cones as JSON and CSV."""

from __future__ import annotations

from typing import Any

import numpy as np

from origami_nlp.cone.flaps import write_flaps
from origami_nlp.cone.full_space import ConeFullSpace
from origami_nlp.cone.phase import PhaseDiagram
from origami_nlp.cone.plain import exact


def _counts(values: np.ndarray) -> list[list[int | str]]:
    return [[exact(v) for v in row] for row in values.tolist()]


def diagram_to_dict(diagram: PhaseDiagram) -> dict[str, Any]:
    """Return a phase diagram as plain data; maps are [ratio][rest elevation]."""
    m = diagram.map
    return {
        "schema": "origami-nlp/cone-phase/1",
        "degree": m.degree,
        "branches": str(m.branches),
        "rest": m.rest_rule,
        "end": m.end_rule,
        "depth": m.depth,
        "contact": diagram.contact,
        "ratios": m.ratios.tolist(),
        "rest_elevations": m.elevations.tolist(),
        "interior": _counts(m.interior),
        "contact_pinned": _counts(m.contact),
        "falling_at_cut": _counts(m.cut),
        "boundaries": [
            {
                "valleys": b.branches.valleys,
                "changes": b.branches.changes,
                "direction": "up" if b.branches.direction > 0 else "down",
                "multiplicity": exact(b.branches.multiplicity),
                "kind": b.kind,
                "rest_elevation": b.rest_elevation.tolist(),
                "ratio": b.ratio.tolist(),
                "elevation": b.elevation.tolist(),
            }
            for b in diagram.boundaries
        ],
    }


def map_as_csv(diagram: PhaseDiagram) -> str:
    """Return the map as comma-separated rows: rest elevation [rad], ratio, and numbers of minima by kind."""
    m = diagram.map
    lines = ["rest_elevation,ratio,interior,contact_pinned,falling_at_cut"]
    for i, nu in enumerate(m.elevations.tolist()):
        for k, r in enumerate(m.ratios.tolist()):
            numbers = ",".join(str(int(n[k, i])) for n in (m.interior, m.contact, m.cut))
            lines.append(f"{nu!r},{r!r},{numbers}")
    return "\n".join(lines) + "\n"


def full_space_to_dict(found: ConeFullSpace) -> dict[str, Any]:
    """Return full-space verdicts as plain data, descents included."""
    return {
        "schema": "origami-nlp/cone-full/1",
        "degree": found.degree,
        "ratio": found.ratio,
        "rest_elevation": found.rest.elevation,
        "rest_angles": [found.rest.odd, found.rest.even],
        "branch_minima": found.count(),
        **{v: found.count(v) for v in ("stable", "unstable", "undecided")},
        "states": [
            {
                "flaps": write_flaps(s.flaps),
                "direction": "up" if s.direction > 0 else "down",
                "symmetry": s.symmetry,
                "copies": s.copies,
                "kind": s.kind,
                "elevation": s.direction * s.elevation,
                "energy": s.energy,
                "depth": s.depth,
                "fold_angles": list(s.fold_angles),
                "residual": None if np.isnan(s.residual) else s.residual,
                "verdict": s.verdict,
                "certificate": s.full_space.certificate,
                "hessian_eigenvalues": list(s.full_space.hessian_eigenvalues),
                "descent": None
                if s.full_space.descent is None
                else [{"fold_angles": list(a), "energy": e} for a, e in s.full_space.descent],
            }
            for s in found.states
        ],
    }
