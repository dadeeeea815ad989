"""Cones as JSON: counts (schema ``origami-nlp/cone/1``), foldings and branches.

A minimum's kind is "interior", "contact", or "cut" (the energy falls where a branch is cut and nothing touches).

Radians; directions are "up" (nu > 0) and "down"; energies with k_odd = 1, k_even = r per crease.
Integers beyond 2^53, which JSON readers round, are strings; ``branches`` always is.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.cone.branches import ConeBranch, direction_name
from origami_nlp.cone.flaps import (
    bracelet_number,
    bracelets,
    necklace_number,
    necklaces,
    write_flaps,
)
from origami_nlp.cone.minima import ConeCount
from origami_nlp.files import write_whole

COUNT_SCHEMA = "origami-nlp/cone/1"
FOLDINGS_SCHEMA = "origami-nlp/cone-foldings/1"
BRANCH_SCHEMA = "origami-nlp/cone-branch/1"
SAFE = 2**53
"""Largest integer written as a number."""


def exact(number: int) -> int | str:
    """Return an integer as JSON can carry it without rounding."""
    return number if abs(number) <= SAFE else str(number)


def count_to_dict(count: ConeCount) -> dict[str, Any]:
    """Return a count as plain JSON data; one entry of ``classes`` for each class and minimum."""
    m = count.minima
    text: dict[int, int | str] = {}
    for number in m.multiplicity:  # the same numbers come again and again: write each once
        if number not in text:
            text[number] = exact(number)
    columns = zip(
        m.valleys.tolist(),
        m.changes.tolist(),
        m.direction.tolist(),
        m.multiplicity,
        m.elevation.tolist(),
        m.energy.tolist(),
        m.depth.tolist(),
        m.kind.tolist(),
        m.multiplier.tolist(),
        strict=True,
    )
    return {
        "schema": COUNT_SCHEMA,
        "degree": count.degree,
        "branches": str(count.branches),
        "stable_interior": exact(count.stable_interior),
        "stable_contact": exact(count.stable_contact),
        "falling_at_cut": exact(count.falling_at_cut),
        "classes": [
            {
                "valleys": valleys,
                "changes": changes,
                "direction": "up" if direction > 0 else "down",
                "multiplicity": text[number],
                "elevation": elevation,
                "energy": energy,
                "depth": depth,
                "kind": kind,
                "multiplier": multiplier,
            }
            for (
                valleys,
                changes,
                direction,
                number,
                elevation,
                energy,
                depth,
                kind,
                multiplier,
            ) in columns
        ],
    }


def foldings_to_dict(degree: int, listed: bool) -> dict[str, Any]:
    """Return the numbers of different foldings, and the foldings themselves where `listed`."""
    data: dict[str, Any] = {
        "schema": FOLDINGS_SCHEMA,
        "degree": degree,
        "assignments": str(1 << (degree // 2)),
        "necklaces": exact(necklace_number(degree)),
        "bracelets": exact(bracelet_number(degree)),
    }
    if listed:
        for name, foldings in (
            ("necklace_list", necklaces(degree)),
            ("bracelet_list", bracelets(degree)),
        ):
            data[name] = [
                {
                    "flaps": write_flaps(f.flaps),
                    "symmetry": f.symmetry,
                    "copies": f.copies,
                    "chiral": f.chiral,
                }
                for f in foldings
            ]
    return data


def branch_to_dict(branch: ConeBranch, elevation: float) -> dict[str, Any]:
    """Return one state of a branch; ``edges_*`` are as in FOLD files: degrees, valley V and mountain M."""
    phi = branch.fold_angles(elevation)
    return {
        "schema": BRANCH_SCHEMA,
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


def write_lines(data: dict[str, Any], target: str | Path) -> None:
    """Write JSON with one entry of each list a line: fast, and readable for many classes."""
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
