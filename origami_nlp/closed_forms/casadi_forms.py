"""The same closed forms for CasADi (SX, MX or DM), from the same generated bodies.

Import this module explicitly: `origami_nlp.closed_forms` itself does not load CasADi.  No reason
codes: in an optimisation, constrain `margin` >= 0 instead.  CasADi's own derivatives of the values
also work away from the singular points (atan2(0, 0) differentiates to nan, sqrt at 0 to inf).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.closed_forms import (
    _cone_casadi,
    _degree6_casadi,
    _dihedral3_casadi,
    _mirror_casadi,
)
from origami_nlp.closed_forms._dihedral import mirror_pair
from origami_nlp.closed_forms._reflection import times_crease


@dataclass(frozen=True)
class CasadiForm:
    """CasADi expressions of one closed form.

    value: the m dependent fold angles; first[m][i], second[m][i][j]: their derivatives by the d
    chart coordinates; margin: the existence condition is margin >= 0 (None: always exists).
    """

    value: list[Any]
    first: list[list[Any]]
    second: list[list[list[Any]]]
    margin: Any


def _form(
    names: Sequence[str],
    outputs: Sequence[Any],
    values: Sequence[str],
    coordinates: Sequence[str],
    margin: str | None,
) -> CasadiForm:
    flat = dict(zip(names, outputs, strict=True))

    def second(v: str, a: str, b: str) -> Any:
        key = f"{v}_d_{a}_d_{b}"
        return flat[key] if key in flat else flat[f"{v}_d_{b}_d_{a}"]

    return CasadiForm(
        [flat[v] for v in values],
        [[flat[f"{v}_d_{a}"] for a in coordinates] for v in values],
        [[[second(v, a, b) for b in coordinates] for a in coordinates] for v in values],
        None if margin is None else flat[margin],
    )


def degree6(alpha1: Any, alpha2: Any, phi2: Any, phi3: Any) -> CasadiForm:
    """(phi_1, phi_4) by (phi_2, phi_3); see the NumPy `degree6`."""
    outputs = _degree6_casadi.degree6(alpha1, alpha2, phi2, phi3)
    values = ("phi_first", "phi_last")
    return _form(_degree6_casadi.OUTPUTS, outputs, values, ("phi2", "phi3"), "margin")


def reflection(azimuths: Sequence[float], folds: Sequence[Any]) -> CasadiForm:
    """(phi_1, phi_k) for any even degree; see the NumPy `reflection`.

    first and second are with respect to the quaternion (mw, mx, my, mz) of the inner creases;
    CasADi differentiates the values with respect to `folds`.
    """
    m: list[Any] = [1.0, 0.0, 0.0, 0.0]
    for a, f in zip(azimuths, folds, strict=True):
        m = times_crease(m, ca.cos(f / 2), ca.sin(f / 2), float(np.cos(a)), float(np.sin(a)))
    outputs = _mirror_casadi.mirror(m[0], m[1], m[2], m[3])
    values, coordinates = ("phi_first", "phi_last"), ("mw", "mx", "my", "mz")
    return _form(_mirror_casadi.OUTPUTS, outputs, values, coordinates, "margin")


def wedge3(n: int, alpha1: Any, elevation: Any, phi2: Any, branch: Any) -> CasadiForm:
    """(phi_1, phi_3) by (elevation, phi_2) on one branch; see the NumPy `wedge3`."""
    c, s = mirror_pair(n)
    alpha2 = float(np.pi / n) - alpha1
    outputs = _dihedral3_casadi.dihedral3(c, s, alpha1, alpha2, elevation, phi2, branch)
    values, coordinates = ("phi1", "phi3"), ("elevation", "phi2")
    return _form(_dihedral3_casadi.OUTPUTS, outputs, values, coordinates, "existence")


def cone_roots(degree: int, elevation: Any) -> CasadiForm:
    """(shallow, steep, mixed) partial fold angles by the elevation; see the NumPy `cone_roots`."""
    outputs = _cone_casadi.cone(2 * np.pi / degree, elevation)
    values = ("shallow", "steep", "mixed")
    return _form(_cone_casadi.OUTPUTS, outputs, values, ("elevation",), None)
