"""Cone of uniform degree N: partial and full fold angles as functions of the elevation.

Paper: eq:partial-N and eq:cone-phi-even (arccos forms, which lose half the digits near the flat
state and, through |..|, follow the wrong root past pi/2 (1 - 4/N)).  Here, with alpha = 2 pi/N,

    shallow: tan(rho/2) =  tan(v/2) tan(pi/4 - alpha/2)
    steep:   tan(rho/2) = -tan(v/2) cot(pi/4 - alpha/2)

smooth through the flat state; shallow + steep = -2 atan(tan(alpha) sin v).  A valley flap has
rho_v >= 0: shallow for v > 0 and steep for v < 0; a mountain flap the other one.  Relative error
1e-15 in values for every v in [-pi, pi] and N up to at least 1000.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.closed_forms import _cone_numpy
from origami_nlp.closed_forms._chart import stack_jets
from origami_nlp.errors import AngleError, OptionError

SHALLOW, STEEP, MIXED = 0, 1, 2


@dataclass(frozen=True)
class ConeAngles:
    """Fold angles along one branch of the cone, with derivatives by the elevation.

    value, first, second: arrays of shape S + (m,), S the shape of the elevation.  At elevation 0
    derivatives are those from v > 0 (one-sided: flaps swap their roots there).
    """

    value: np.ndarray
    first: np.ndarray
    second: np.ndarray


def _degree(degree: int) -> int:
    if int(degree) != degree or degree < 6 or degree % 2:
        raise OptionError(f"a cone has an even degree >= 6 (flaps of two facets), not {degree!r}")
    return int(degree)


def cone_roots(degree: int, elevation: Any) -> ConeAngles:
    """The partial fold angles on both smooth roots and their sum: (shallow, steep, mixed).

    elevation: v in radians, |v| <= pi, paper's sign (v > 0 lowers the odd creases).
    """
    v = np.asarray(elevation, dtype=float)
    if not np.all(np.abs(v) <= np.pi):
        raise AngleError("elevation must be finite and within [-pi, pi] radians")
    outputs = _cone_numpy.cone(2 * np.pi / _degree(degree), v)
    flat = dict(zip(_cone_numpy.OUTPUTS, outputs, strict=True))
    value, first, second = stack_jets(flat, ["shallow", "steep", "mixed"], ["elevation"])
    return ConeAngles(value, first[..., 0], second[..., 0, 0])


def _pick(roots: ConeAngles, columns: np.ndarray) -> list[np.ndarray]:
    """One root per output: `columns` has shape S + (m,)."""
    parts = (roots.value, roots.first, roots.second)
    return [np.take_along_axis(part, columns, axis=-1) for part in parts]


def cone_partial_angles(degree: int, elevation: Any) -> ConeAngles:
    """(rho_v, rho_m): partial fold angles of a valley and a mountain flap (paper eq:partial-N)."""
    roots = cone_roots(degree, elevation)
    down = np.asarray(elevation, dtype=float) < 0
    columns = np.stack([np.where(down, STEEP, SHALLOW), np.where(down, SHALLOW, STEEP)], axis=-1)
    return ConeAngles(*_pick(roots, columns))


def _flaps(degree: int, flaps: Sequence[int]) -> list[int]:
    signs = [int(f) for f in flaps]
    if len(signs) != _degree(degree) // 2 or any(f not in (1, -1) for f in signs):
        raise OptionError(f"flaps must be {degree // 2} entries +1 (valley) or -1 (mountain)")
    return signs


def cone_fold_angles(degree: int, elevation: Any, flaps: Sequence[int]) -> ConeAngles:
    """All N fold angles (crease 1, 2, .., N) for one assignment of the flaps.

    flaps: N/2 entries, +1 valley (rho_v) or -1 mountain (rho_m); flap j has the creases 2j - 1, 2j,
        2j + 1.  phi_even = -2 sgn(rho) |v|, phi_odd = sum of the two neighbouring partial angles
        (paper section 4, symmetry breaking).
    """
    signs = _flaps(degree, flaps)
    v = np.asarray(elevation, dtype=float)
    roots = cone_roots(degree, v)
    direction = np.where(v < 0, -1.0, 1.0)
    columns = []
    for before, here in zip([signs[-1], *signs[:-1]], signs, strict=True):
        alike = np.where(direction * here > 0, SHALLOW, STEEP)
        columns.append(alike if before == here else np.full(v.shape, MIXED))
    odd = _pick(roots, np.stack(columns, axis=-1))
    twice = np.array([2.0 if signs[j - 1] == signs[j] else 1.0 for j in range(len(signs))])
    even = np.multiply.outer(direction, -2.0 * np.array(signs))
    evens = (even * v[..., None], even, np.zeros_like(even))
    full = [np.stack([o * twice, e], axis=-1) for o, e in zip(odd, evens, strict=True)]
    return ConeAngles(*(f.reshape(*v.shape, degree) for f in full))


def cone_contact_elevation(degree: int) -> float:
    """|v| at which two neighbouring steep flaps touch: |rho| = pi/2 at pi/2 (1 - 4/N).

    That is a pair of mountains for v > 0 and a pair of valleys for v < 0.
    """
    return np.pi / 2 * (1 - 4 / _degree(degree))
