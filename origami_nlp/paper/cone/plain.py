"""Cones as JSON and CSV: counts, foldings, branches, phase diagrams, full space.

A minimum's kind is "interior", "contact", or "cut" (the energy falls where a branch is cut and nothing touches).

Radians; directions are "up" (nu > 0) and "down"; energies with k_odd = 1, k_even = r per crease.
Integers beyond 2^53, which JSON readers round, are strings; ``branches`` always is.
"""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.io import write_whole
from origami_nlp.paper.cone.branches import ConeBranch
from origami_nlp.paper.cone.classes import direction_name
from origami_nlp.paper.cone.flaps import write_flaps
from origami_nlp.paper.cone.minima import ConeCount
from origami_nlp.paper.cone.necklaces import foldings, number_of_foldings
from origami_nlp.paper.cone.phase import PhaseDiagram
from origami_nlp.paper.cone.stability import ConeFullSpace, JudgedMinimum

SCHEMA = "origami-nlp/paper/1"
SAFE = 2**53
"""Largest integer written as a number."""


def exact(number: int) -> int | str:
    """Return an integer as JSON can carry it without rounding."""
    return number if abs(number) <= SAFE else str(number)


def _exact_all(values: np.ndarray) -> list[list[int | str]]:
    return [[exact(v) for v in row] for row in values.tolist()]


def count_to_dict(count: ConeCount) -> dict[str, Any]:
    """Return a count as plain JSON data; one entry of ``classes`` for each class and minimum.

    Parameters
    ----------
    count
        Of `count`.

    Returns
    -------
    dict
        What JSON can hold; numbers beyond 2^53 are text.
    """
    m = count.minima
    # the same numbers come again and again: write each once
    text = {number: exact(number) for number in dict.fromkeys(m.multiplicity)}
    columns = {f.name: getattr(m, f.name) for f in fields(m)}
    columns["direction"] = [direction_name(d) for d in m.direction.tolist()]
    columns["multiplicity"] = [text[number] for number in m.multiplicity]
    lists = [c.tolist() if isinstance(c, np.ndarray) else c for c in columns.values()]
    return {
        "schema": SCHEMA,
        "degree": count.degree,
        "branches": str(count.branches),
        "stable_interior": exact(count.stable_interior),
        "stable_contact": exact(count.stable_contact),
        "falling_at_cut": exact(count.falling_at_cut),
        "classes": [dict(zip(columns, row, strict=True)) for row in zip(*lists, strict=True)],
    }


def foldings_to_dict(degree: int, listed: bool) -> dict[str, Any]:
    """Return the numbers of different foldings.

    Parameters
    ----------
    degree
        N, even, at least 6.
    listed
        Whether to list the foldings themselves.

    Returns
    -------
    dict
        What JSON can hold.
    """
    kinds = {"necklace": True, "bracelet": False}
    data: dict[str, Any] = {
        "schema": SCHEMA,
        "degree": degree,
        "assignments": str(1 << (degree // 2)),
        **{
            f"{kind}s": exact(number_of_foldings(degree, mirrors_differ=differ))
            for kind, differ in kinds.items()
        },
    }
    for kind, differ in kinds.items() if listed else ():
        data[f"{kind}_list"] = [
            {
                "flaps": write_flaps(f.flaps),
                "symmetry": f.symmetry,
                "copies": f.copies,
                "chiral": f.chiral,
            }
            for f in foldings(degree, mirrors_differ=differ)
        ]
    return data


def branch_to_dict(branch: ConeBranch, elevation: float) -> dict[str, Any]:
    """Return one state of a branch; ``edges_*`` are as in FOLD files: degrees, valley V and mountain M.

    Parameters
    ----------
    branch
        Of `branch`.
    elevation
        v, signed [rad].

    Returns
    -------
    dict
        What JSON can hold.
    """
    phi = branch.fold_angles(elevation)
    return {
        "schema": SCHEMA,
        "degree": branch.degree,
        "flaps": write_flaps(branch.flaps),
        "direction": direction_name(branch.direction),
        "symmetry": branch.symmetry,
        "end": branch.end,
        "end_rule": branch.end_rule,
        "at_end": branch.end_text,
        "elevation": float(elevation),
        "fold_angles": phi.tolist(),
        "edges_foldAngle": np.degrees(phi).tolist(),
        "edges_assignment": ["V" if p > 0 else "M" if p < 0 else "F" for p in phi],
    }


def diagram_to_dict(diagram: PhaseDiagram) -> dict[str, Any]:
    """Return a phase diagram as plain data; maps are [ratio][rest elevation].

    Parameters
    ----------
    diagram
        Of `phase_diagram`.

    Returns
    -------
    dict
        What JSON can hold.
    """
    m = diagram.map
    return {
        "schema": SCHEMA,
        "degree": m.cone.degree,
        "branches": str(m.branches),
        "rest": m.cone.rest,
        "end": m.cone.end,
        "depth": m.depth,
        "contact": diagram.contact,
        "ratios": m.ratios.tolist(),
        "rest_elevations": m.elevations.tolist(),
        "interior": _exact_all(m.interior),
        "contact_pinned": _exact_all(m.contact),
        "falling_at_cut": _exact_all(m.cut),
        "boundaries": [
            {
                "valleys": b.branches.valleys,
                "changes": b.branches.changes,
                "direction": direction_name(b.branches.direction),
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
    """Return the map as comma-separated rows: rest elevation [rad], ratio, and numbers of minima by kind.

    Parameters
    ----------
    diagram
        Of `phase_diagram`.

    Returns
    -------
    str
        A line of heads, then one a point.
    """
    m = diagram.map
    lines = ["rest_elevation,ratio,interior,contact_pinned,falling_at_cut"]
    for i, nu in enumerate(m.elevations.tolist()):
        for k, r in enumerate(m.ratios.tolist()):
            numbers = ",".join(str(int(n[k, i])) for n in (m.interior, m.contact, m.cut))
            lines.append(f"{nu!r},{r!r},{numbers}")
    return "\n".join(lines) + "\n"


def full_space_to_dict(found: ConeFullSpace) -> dict[str, Any]:
    """Return full-space verdicts as plain data, descents included.

    Parameters
    ----------
    found
        Of `full_space`.

    Returns
    -------
    dict
        What JSON can hold.
    """
    return {
        "schema": SCHEMA,
        "degree": found.cone.degree,
        "ratio": found.ratio,
        "rest_elevation": found.rest.elevation,
        "rest_angles": [found.rest.odd, found.rest.even],
        "branch_minima": found.count(),
        **{v: found.count(v) for v in ("stable", "unstable", "undecided")},
        "states": [_judged(s) for s in found.states],
    }


def _judged(state: JudgedMinimum) -> dict[str, Any]:
    own, reported = state.branch, state.full_space
    descent = reported.descent
    return {
        "flaps": write_flaps(own.flaps),
        "direction": direction_name(own.direction),
        "symmetry": own.symmetry,
        "copies": state.copies,
        "kind": state.kind,
        "elevation": own.direction * state.elevation,
        "energy": state.energy,
        "depth": state.depth,
        "fold_angles": list(state.fold_angles),
        "residual": None if np.isnan(state.residual) else state.residual,
        "verdict": state.verdict,
        "certificate": reported.certificate,
        "hessian_eigenvalues": list(reported.hessian_eigenvalues),
        "descent": descent and [{"fold_angles": list(a), "energy": e} for a, e in descent],
    }


def write_lines(data: dict[str, Any], target: str | Path) -> None:
    """Write JSON with one entry of each list a line: fast, and readable for many classes.

    Parameters
    ----------
    data
        Of a function of this module.
    target
        The file, or ``"-"`` for standard output.
    """
    parts = []
    for key, value in data.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            rows = ",\n".join("    " + json.dumps(row, allow_nan=False) for row in value)
            body = f"[\n{rows}\n  ]"
        else:
            body = json.dumps(value, allow_nan=False)
        parts.append(f"  {json.dumps(key)}: {body}")
    text = "{\n" + ",\n".join(parts) + "\n}\n"
    write_whole(target, text.encode())
