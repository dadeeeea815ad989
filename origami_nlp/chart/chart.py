"""The paper's coordinates of a scene with two symmetric degrees of freedom, from the generated closed forms.

- D_1, degree 6: (phi_2, phi_3), the fold angles between the mirror creases; one branch
  (`closed_forms.degree6`, paper, eq. 3.2, phi1-6-fold).
- D_n, n >= 2, wedge of three creases (degree 4 n): (phi_2, elevation upsilon of crease 1, paper's sign:
  F_1 = Q(e2, upsilon) Q(b_1, phi_1/2)), two branches (`closed_forms.wedge3`, of states that wind once).

A chart ends where a family of states shares one point and where branches meet; it is not
the manifold.  Radians; everything vectorised over states.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.closed_forms import degree6, wedge3
from origami_nlp.numerics import NONZERO, OUTSIDE, cross, quaternion as quat
from origami_nlp.pattern import Scene, Vertex


@dataclass(frozen=True)
class Chart:
    """Closed states over two coordinates.

    kind: ``"degree6"`` or ``"wedge"``.
    coordinates: names of (x, y); creases are numbered as in the scene.
    signs: one entry per branch (+1 and -1 for a wedge, +1 alone for degree 6).
    """

    scene: Scene
    kind: str
    coordinates: tuple[str, str]
    signs: tuple[int, ...]

    def fold_angles(self, branch: int, x: Any, y: Any) -> np.ndarray:
        """All N fold angles at coordinates x, y (broadcast to shape S), shape S + (N,).

        NaN where the branch has no closed state.  Admissibility is not looked at: see `admissible`.
        """
        x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        rays = self.scene.group.rays
        if self.kind == "degree6":
            value = degree6(rays[0].sector, rays[1].sector, x, y).value
            piece = np.stack([value[..., 0], x, y, value[..., 1]], axis=-1)
        else:
            sign, order = self.signs[branch], self.scene.group.order
            value = wedge3(order, rays[0].sector, y, x, sign).value
            piece = np.stack([value[..., 0], x, value[..., 1]], axis=-1)
        return piece[..., list(self.scene.group.orbit)]

    @property
    def sided(self) -> bool:
        """Whether each side of the flat state has one branch, with elevations of one sign (`closed_forms.wedge3`)."""
        return self.kind == "wedge" and self.scene.group.order == 2 and self.scene.contact == "full"

    def branch_of(self, fold_angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Branch on which states [..., N] lie, and how far they are from where branches meet, [...]."""
        elevation = self.points(fold_angles)[..., 1]
        if self.kind == "degree6":
            return np.zeros(elevation.shape, dtype=int), np.ones(elevation.shape)
        if self.sided:
            return np.where(elevation > 0, 1, 0), np.abs(elevation)
        x = fold_angles[..., crease_number(self.scene, 1) - 1]
        there = np.stack([self.fold_angles(k, x, elevation) for k in (0, 1)])
        misfit = np.nan_to_num(np.abs(there - fold_angles).max(axis=-1), nan=10.0)
        return np.where(misfit[1] < misfit[0], 1, 0), np.abs(misfit[1] - misfit[0])

    def points(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return the coordinates (x, y) of states [..., N], shape [..., 2]."""
        x = fold_angles[..., crease_number(self.scene, 1) - 1]
        if self.kind == "degree6":
            y = fold_angles[..., crease_number(self.scene, 2) - 1]
        else:
            y = wedge_elevation(self.scene, fold_angles)
        return np.stack([x, y], axis=-1)


def chart_of(scene: Scene) -> Chart | None:
    """The chart of a scene with two symmetric degrees of freedom, or None where no closed form is known."""
    group = scene.group
    # closed forms are those of states that wind once
    if (scene.winding or 1) > 1:
        return None
    if not scene.vertex.flat or group.kind != "D" or any(ray.crease is None for ray in group.rays):
        return None
    if (group.order, len(group.rays)) == (1, 4):
        x, y = (f"phi_{crease_number(scene, r)}" for r in (1, 2))
        return Chart(scene, "degree6", (x, y), (1,))
    if group.order >= 2 and len(group.rays) == 3:
        number = crease_number(scene, 0)
        names = (f"phi_{crease_number(scene, 1)}", f"upsilon (elevation of crease {number})")
        return Chart(scene, "wedge", names, (1, -1))
    return None


def crease_number(scene: Scene, ray: int) -> int:
    """Crease number (1-based) of a ray of the wedge."""
    crease = scene.group.rays[ray].crease
    assert crease is not None
    return crease + 1


def admissible(scene: Scene, fold_angles: np.ndarray) -> np.ndarray:
    """Return which closed states [K, N] keep the contact that the scene asks for, shape [K].

    Adjacent facets by |phi| <= pi, or stops; non-adjacent ones by crossing of their arcs (pairs that the
    symmetry maps to one another are looked at once).  Layers of touching facets are not ordered.
    """
    phi = np.asarray(fold_angles, dtype=float)
    good = np.isfinite(phi).all(axis=-1)
    if scene.contact == "none":
        return good
    low, high = scene.limit_angles
    good &= ((phi >= low - OUTSIDE) & (phi <= high + OUTSIDE)).all(axis=-1)
    if scene.contact != "full":
        return good
    alive = np.flatnonzero(good)
    group = scene.group
    if group.order >= 2 and len(group.rays) == 3 and all(r.crease is not None for r in group.rays):
        # mirror creases past the axis cross their images, if only by fourth powers of how far
        for back in (False, True):
            past = np.abs(wedge_elevation(scene, phi[alive], back)) > math.pi / 2 + OUTSIDE
            alive = alive[~past]
    creases, _ = fold_vertex(scene.vertex, phi[alive])
    for pair in facet_pairs(scene):  # one by one: most states of a grid are refused by the first
        keep = pair_depths(creases, [pair])[:, 0] <= OUTSIDE
        alive, creases = alive[keep], creases[keep]
    good[:] = False
    good[alive] = True
    return good


def allowed(chart: Chart, branch: int, x: Any, y: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return which chart points have an admissible state, and return the states, shape S + (N,)."""
    phi = chart.fold_angles(branch, x, y)
    closed = np.isfinite(phi).all(axis=-1)
    good = np.zeros(closed.shape, dtype=bool)
    good[closed] = admissible(chart.scene, phi[closed])
    return good, phi


def chart_limits(chart: Chart) -> tuple[float, float, float, float]:
    """Return the chart's extent (x low, x high, y low, y high) [rad]."""
    reach = math.pi / 2 if chart.kind == "wedge" and chart.scene.contact == "full" else math.pi
    return -math.pi, math.pi, -reach, reach


def facet_pairs(scene: Scene) -> list[tuple[int, int]]:
    """Pairs of non-adjacent facets, one for each class under the scene's symmetry."""
    n, seen, pairs = scene.degree, set[frozenset[int]](), []
    for i in range(n):
        for j in range(i + 2, n - (i == 0)):
            if frozenset((i, j)) not in seen:
                pairs.append((i, j))
                # crease i -> s - i sends facet (i, i+1) to s - 1 - i
                seen |= {
                    frozenset((s - 1 - f if mirrored else f + s) % n for f in (i, j))
                    for s, mirrored in scene.group.elements
                }
    return pairs


def wedge_elevation(scene: Scene, fold_angles: np.ndarray, back: bool = False) -> np.ndarray:
    """Return the elevation upsilon of crease 1 of D_n states [..., N] with a wedge of three creases [rad], [...].

    With `back` that of crease 3, seen from the other mirror.

    In the frame of the folded wedge (ray 1 at e1) the last mirror has the inward normal H n_k,
    n_k = (sin pi/n, -cos pi/n, 0); the chart's frame is turned from it by Q(e2, upsilon), so that
    H n_k = (sin pi/n cos upsilon, -cos pi/n, sin pi/n sin upsilon).
    """
    turn = -1 if back else 1
    sectors = [ray.sector for ray in scene.group.rays[:2]][::turn]
    folds = [fold_angles[..., crease_number(scene, r) - 1] for r in (0, 1, 2)][::turn]
    normal = fold_wedge(scene.group.order, sectors, folds)[1]
    # upsilon > 0 lowers crease 1, where the paper says that it elevates it (docs/validation/errata.md, 1)
    return np.arctan2(normal[2], normal[0])


def fold_wedge(order: int, sectors: Any, folds: Any, by: Any = np) -> tuple[list[Any], Any, Any]:
    """Fold a wedge of D_n with creases on both mirrors: its rays, the last mirror's normal, and its turns in all.

    H = Q(b_1, phi_1/2) Q(b_2, phi_2) ... Q(b_k, phi_k/2); the normal is H n_k.  Of arrays, or what `by` has
    cosines of, such as CasADi.
    """
    azimuth: Any = 0.0
    flats = [flat_ray(azimuth, by)] + [flat_ray(azimuth := azimuth + a, by) for a in sectors]
    # the mirror halves the fold angle of a crease that lies on it
    halves = [fold / (4 if r in (0, len(sectors)) else 2) for r, fold in enumerate(folds)]
    rays, turn = fold_rays(flats, halves, by)
    whole = math.pi / order
    return rays, quat.rotate(turn, (math.sin(whole), -math.cos(whole), 0.0)), turn


def flat_ray(azimuth: Any, by: Any = np) -> tuple[Any, Any, float]:
    """Return a ray of the flat sheet."""
    return by.cos(azimuth), by.sin(azimuth), 0.0


def fold_rays(
    flats: Sequence[Any], halves: Sequence[Any], by: Any = np, turn: Any = quat.IDENTITY
) -> tuple[list[Any], Any]:
    """Fold rays of the flat sheet by half angles, as many as there are: where each ray is, and all turns in one."""
    rays = []
    for flat, half in itertools.zip_longest(flats, halves):
        rays.append(quat.rotate(turn, flat))
        if half is not None:
            turn = quat.multiply(turn, quat.fold(by.cos(half), by.sin(half), flat))
    return rays, turn


def fold_vertex(vertex: Vertex, fold_angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fold a vertex with its last facet held fixed (paper, eq. 2.1, fold-map).

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        States, shape [..., N] [rad], valley positive; they need not close.

    Returns
    -------
    creases : numpy.ndarray
        Deformed unit creases c_i = F_{i-1} b_i, shape [..., N, 3].
    q : numpy.ndarray
        Product of all folds, and of the turn by `Vertex.excess` about e3 that closes the unrolled sheet of a
        vertex that is not flat, as a quaternion, shape [..., 4]; (1, 0, 0, 0) when the sheet closes.
        Every embedded vertex has +1: simple spherical polygons are deformed into each other through simple
        ones, along which the sign cannot change.

    Examples
    --------
    >>> from origami_nlp import Vertex
    >>> from origami_nlp.chart import fold_vertex
    >>> creases, q = fold_vertex(Vertex(("pi/2",) * 4), [3.141592653589793, 0, 3.141592653589793, 0])
    >>> creases.shape, q.round(12).tolist()
    ((4, 3), [1.0, 0.0, 0.0, 0.0])
    """
    half = np.moveaxis(np.asarray(fold_angles, dtype=float) / 2, -1, 0)
    none = np.zeros(half.shape[1:])
    # c_i = F_{i-1} b_i, the folds before it (paper, section 2)
    rays, q = fold_rays([tuple(b) for b in vertex.creases], list(half))
    if not vertex.flat:
        turn = vertex.excess / 2
        q = quat.multiply(q, (math.cos(turn), 0.0, 0.0, math.sin(turn)))
    creases = [np.stack([v + none for v in ray], axis=-1) for ray in rays]
    return np.stack(creases, axis=-2), np.stack([v + none for v in q], axis=-1)


def pair_depths(creases: np.ndarray, pairs: Sequence[tuple[int, int]]) -> np.ndarray:
    """Return how deep pairs of facets cross, 0 where they do not; facet i is the arc from crease i to the next.

    Two arcs cross where their four ends alternate; each end is off the plane of the other arc by the sine of its
    distance from the common point times that of the angle between the arcs: the smallest of the four is the depth.

    Parameters
    ----------
    creases
        Unit vectors, shape [..., N, 3].
    pairs
        Positions of the facets, shape [P, 2].

    Returns
    -------
    numpy.ndarray
        Shape [..., P].
    """
    facets = np.array(pairs, int).reshape(-1, 2).T
    first, last = creases[..., facets, :], creases[..., (facets + 1) % creases.shape[-2], :]
    normal = cross(first, last)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), NONZERO)
    off = [np.einsum("...i,...i->...", normal, end[..., ::-1, :, :]) for end in (first, last)]
    # of one sign where the ends alternate around a common point; mixed: they miss, or meet antipodally
    v = np.stack([off[0][..., 0, :], -off[1][..., 0, :], -off[0][..., 1, :], off[1][..., 1, :]])
    return np.asarray(np.maximum(np.maximum(v.min(axis=0), (-v).min(axis=0)), 0.0))
