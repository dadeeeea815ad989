"""The energy landscape of a scene over the paper's coordinates, as plain data.

Three forms, by the scene's symmetric degrees of freedom:

- D_1, degree 6 (two freedoms): (phi_2, phi_3), the fold angles between the mirror creases; the rest
  from `closed_forms.degree6` (paper, eq. phi1-6-fold).
- D_n, n >= 2, wedge of three creases (degree 4 n; two freedoms): (phi_2, elevation upsilon of crease
  1, paper's sign: F_1 = Q(e2, upsilon) Q(b_1, phi_1/2)), two branches, from `closed_forms.wedge3`.
- one freedom: the curves of closed states, traced numerically, over one of their fold angles.

Anything else has no chart: `Landscape.reason` says why.  Radians; energies in the scene's units.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.closed_forms import ChartPoint, Reason, degree6, wedge3
from origami_nlp.errors import OptionError
from origami_nlp.model import quaternion as quat
from origami_nlp.model.embedding import crossing_depth, examine, fold_vertex
from origami_nlp.state.scene import Scene

CROSSING = 1e-9
"""Facets that cross deeper than this (sine of an angle) are excluded; touching ones are not."""
SAME_LINE = 1e-6
"""Creases whose directions differ by less (sine of the angle) lie on one line for `Place.family`."""


@dataclass(frozen=True)
class Branch:
    """One sheet of the landscape (an area, or one curve).

    name: empty where there is only one.
    axes: grid values of each coordinate: x [nx] and y [ny] for an area (cell centres, so that
        states that exist only at phi = +-pi exactly take no area), x [m] along a curve.
    energy: [ny, nx] or [m], NaN where no state is admissible with the contact of the scene.
    fold_angles: all N fold angles, [ny, nx, N] or [m, N], NaN in the same places.
    """

    name: str
    axes: tuple[np.ndarray, ...]
    energy: np.ndarray = field(repr=False)
    fold_angles: np.ndarray = field(repr=False)


@dataclass(frozen=True)
class Place:
    """Where a state lies on the landscape.

    branch: index into `Landscape.branches`.
    point: its coordinates; for a curve (coordinate, energy).
    family: empty, or why a whole family of states shares this point of the chart.
    drawn: False where |phi| > pi at some crease, which no chart covers.
    """

    branch: int
    point: tuple[float, float]
    family: str = ""
    drawn: bool = True


@dataclass(frozen=True)
class Landscape:
    """Energy over the coordinates of a scene.

    kind: ``"area"`` (two coordinates), ``"curve"`` (one) or ``"none"``.
    coordinates: names, such as ``("phi_2", "phi_3")``; creases are numbered as in the scene.
    branches: at least one, unless kind is ``"none"``.
    reason: why there is no landscape, in words; empty otherwise.
    handles: curves [m, 2] in the coordinates, along which states exist only at a fold angle of +-pi
        exactly (the paper's 1-handles; looked for on the border of the degree-6 chart).
    """

    scene: Scene
    kind: str
    coordinates: tuple[str, ...]
    branches: tuple[Branch, ...]
    reason: str = ""
    handles: tuple[np.ndarray, ...] = ()

    def place(self, fold_angles: object) -> Place:
        """Return where the state with all N `fold_angles` [rad] lies.

        Raises
        ------
        OptionError
            If there is no landscape, or a wrong number of fold angles.
        """
        phi = np.asarray(fold_angles, dtype=float)
        if self.kind == "none":
            raise OptionError(f"this scene has no landscape: {self.reason}")
        if phi.shape != (self.scene.degree,):
            raise OptionError(
                f"fold_angles has shape {phi.shape}: give all {self.scene.degree} of one state"
            )
        if self.kind == "curve":
            place = _place_on_curve(self, phi)
        elif self.scene.group.order == 1:
            place = _place_degree6(self, phi)
        else:
            place = _place_wedge(self, phi)
        return replace(place, drawn=bool(np.abs(phi).max() <= math.pi + 1e-9))


def landscape(scene: Scene, size: int = 401) -> Landscape:
    """Evaluate the energy landscape of `scene`.

    Parameters
    ----------
    size
        Cells along each coordinate, >= 8 (for curves: along a full turn of a fold angle).

    Raises
    ------
    OptionError
        If `size` is no such number.
    """
    if isinstance(size, bool) or not isinstance(size, int) or size < 8:
        raise OptionError(f"size = {size!r} must be a whole number, at least 8")
    group = scene.group
    creases_only = all(ray.crease is not None for ray in group.rays)
    if group.kind == "D" and creases_only and (group.order, len(group.rays)) == (1, 4):
        return _degree6(scene, size)
    if group.kind == "D" and creases_only and group.order >= 2 and len(group.rays) == 3:
        return _wedge(scene, size)
    variables = sum(ray.crease is not None for ray in group.rays)
    freedom = variables - {("C", 1): 3, ("D", 1): 2}.get((group.kind, group.order), 1)
    if freedom == 1:
        return _curves(scene, size)
    what = f"{freedom} degrees of freedom keep the symmetry {group.name}"
    if freedom <= 0:
        why = f"the vertex is rigid within the symmetry {group.name}"
    elif freedom == 2:
        why = f"{what}, but no closed-form chart is known for this arrangement of creases"
    else:
        why = f"{what}: too many for a plane"
    return Landscape(scene, "none", (), (), why)


def cells(low: float, high: float, size: int) -> np.ndarray:
    """Return the centres of `size` equal cells between low and high."""
    return low + (high - low) * (np.arange(size) + 0.5) / size


# ---------------------------------------------------------------- contact


def admissible(scene: Scene, fold_angles: np.ndarray) -> np.ndarray:
    """Tell which closed states [K, N] keep the contact that the scene asks for, shape [K].

    Adjacent facets by |phi| <= pi; non-adjacent ones by crossing of their arcs (pairs that the
    symmetry maps to one another are looked at once).  Layers of touching facets are not ordered.
    """
    phi = np.asarray(fold_angles, dtype=float)
    good = np.isfinite(phi).all(axis=-1)
    if scene.contact == "none":
        return good
    good &= (np.abs(phi) <= math.pi + 1e-12).all(axis=-1)
    if scene.contact != "full":
        return good
    alive = np.flatnonzero(good)
    creases, _ = fold_vertex(scene.vertex, phi[alive])
    ends = np.roll(creases, -1, axis=-2)
    for i, j in _facet_pairs(scene):
        first = np.stack([creases[:, i], ends[:, i]], axis=-2)
        second = np.stack([creases[:, j], ends[:, j]], axis=-2)
        keep = crossing_depth(first, second) <= CROSSING
        alive, creases, ends = alive[keep], creases[keep], ends[keep]
    good[:] = False
    good[alive] = True
    return good


def _facet_pairs(scene: Scene) -> list[tuple[int, int]]:
    """Pairs of non-adjacent facets, one for each class under the scene's symmetry."""
    n, group = scene.degree, scene.group
    step = n // group.order
    first = group.rays[0].crease
    # crease i -> s - i sends facet (i, i+1) to s - 1 - i; a mirror through a facet needs no thrift
    maps = [[(f + m * step) % n for f in range(n)] for m in range(group.order)]
    if group.kind == "D" and first is not None:
        maps += [[(2 * first - 1 - g) % n for g in row] for row in maps]
    pairs: list[tuple[int, int]] = []
    seen: set[frozenset[int]] = set()
    for i in range(n):
        for j in range(i + 2, n):
            if (j - i) % n == n - 1 or frozenset((i, j)) in seen:
                continue
            seen |= {frozenset((row[i], row[j])) for row in maps}
            pairs.append((i, j))
    return pairs


def _area(scene: Scene, name: str, axes: tuple[np.ndarray, ...], grid: np.ndarray) -> Branch:
    """Blank out inadmissible states of fold angles [ny, nx, wedge creases], expanded to all N."""
    shape = grid.shape[:2]
    phi = np.full((*shape, scene.degree), np.nan)
    closed = np.isfinite(grid).all(axis=-1)
    states = grid[closed][:, list(scene.group.orbit)]
    states[~admissible(scene, states)] = np.nan
    phi[closed] = states
    return Branch(name, axes, np.asarray(scene.energy(phi)), phi)


# ---------------------------------------------------------------- D_1, degree 6


def _degree6(scene: Scene, size: int) -> Landscape:
    rays = scene.group.rays
    axis = cells(-math.pi, math.pi, size)
    x, y = np.meshgrid(axis, axis)
    value = degree6(rays[0].sector, rays[1].sector, x, y).value
    grid = np.stack([value[..., 0], x, y, value[..., 1]], axis=-1)
    names = tuple(f"phi_{_number(scene, r)}" for r in (1, 2))
    branch = _area(scene, "", (axis, axis), grid)
    handles = _handles(scene, branch) if scene.contact == "full" else ()
    return Landscape(scene, "area", names, (branch,), handles=handles)


def _handles(scene: Scene, branch: Branch) -> tuple[np.ndarray, ...]:
    """Stretches of the chart's border with admissible states and none beside them, inside."""
    rays, size = scene.group.rays, branch.energy.shape[0]
    t = np.linspace(-math.pi, math.pi, 65)
    cell = np.minimum(((t + math.pi) / (2 * math.pi) * size).astype(int), size - 1)
    found = []
    for side, edge in ((-math.pi, 0), (math.pi, size - 1)):
        border = np.full_like(t, side)
        for x, y, inside in (
            (border, t, branch.energy[cell, edge]),
            (t, border, branch.energy[edge, cell]),
        ):
            value = degree6(rays[0].sector, rays[1].sector, x, y).value
            grid = np.stack([value[:, 0], x, y, value[:, 1]], axis=-1)
            states = grid[:, list(scene.group.orbit)]
            alone = np.isnan(inside) & admissible(scene, states)
            # facets lie on each other there: the layers decide
            alone[alone] = [examine(scene.vertex, phi).admissible for phi in states[alone]]
            for kept, run in itertools.groupby(range(len(t)), key=alone.__getitem__):
                k = list(run)
                if kept and len(k) > 2:
                    found.append(np.stack([x[k], y[k]], axis=-1))
    return tuple(found)


def _place_degree6(chart: Landscape, phi: np.ndarray) -> Place:
    scene = chart.scene
    x, y = (float(phi[_number(scene, r) - 1]) for r in (1, 2))
    return Place(0, (x, y), _family(scene, phi))


def _number(scene: Scene, ray: int) -> int:
    """Crease number (1-based) of a ray of the wedge."""
    crease = scene.group.rays[ray].crease
    assert crease is not None
    return crease + 1


def _family(scene: Scene, phi: np.ndarray) -> str:
    """Say why a whole family of states shares the chart point of `phi`, or return ''."""
    group = scene.group
    first, last = _number(scene, 0), _number(scene, len(group.rays) - 1)
    pairs = [(first, last)]
    if group.order == 2:  # crease 1 and its image under the half turn, both in one plane
        pairs.append((first, (first - 1 + scene.degree // 2) % scene.degree + 1))
    creases, _ = fold_vertex(scene.vertex, phi)
    for i, j in pairs:
        a, b = creases[i - 1], creases[j - 1]
        if np.linalg.norm(np.cross(a, b)) < SAME_LINE:
            how = "form one straight line" if a @ b < 0 else "coincide"
            return f"creases {i} and {j} {how}, about which the vertex folds freely"
    return ""


# ---------------------------------------------------------------- D_n, wedge of three creases


def _wedge(scene: Scene, size: int) -> Landscape:
    number = _number(scene, 0)
    names = (f"phi_{_number(scene, 1)}", f"upsilon (elevation of crease {number})")
    reach = math.pi / 2 if scene.contact == "full" else math.pi
    phi2 = cells(-math.pi, math.pi, size)
    branches = []
    for sign in (1, -1):
        # a coarse look first: each branch fills only a part of the elevations
        coarse = cells(-reach, reach, 81)
        found = np.isfinite(_wedge_grid(scene, coarse, cells(-math.pi, math.pi, 81), sign))
        rows = np.flatnonzero(found[..., 0].any(axis=1))
        low, high = -reach, reach
        if rows.size:
            cell = 2 * reach / 81
            low = max(low, coarse[rows[0]] - 1.5 * cell)
            high = min(high, coarse[rows[-1]] + 1.5 * cell)
            if scene.group.order == 2:  # branches of D_2 end at upsilon = 0 exactly
                low = 0.0 if abs(low) < 2 * cell else low
                high = 0.0 if abs(high) < 2 * cell else high
        elevation = cells(low, high, size)
        grid = _wedge_grid(scene, elevation, phi2, sign)
        branches.append(_area(scene, f"branch {sign:+d}", (phi2, elevation), grid))
    return Landscape(scene, "area", names, tuple(branches))


def _wedge_chart(scene: Scene, elevation: object, phi2: object, sign: int) -> ChartPoint:
    return wedge3(scene.group.order, scene.group.rays[0].sector, elevation, phi2, sign)


def _wedge_grid(scene: Scene, elevation: np.ndarray, phi2: np.ndarray, sign: int) -> np.ndarray:
    """Fold angles (phi_1, phi_2, phi_3) over the grid, shape [elevations, phi2s, 3]."""
    y, x = np.meshgrid(elevation, phi2, indexing="ij")
    chart = _wedge_chart(scene, y, x, sign)
    value = chart.value
    if scene.contact == "full":  # mirror creases on the wrong side of the axis cross their images
        value = np.where(chart.own_side[..., None], value, np.nan)
    return np.stack([value[..., 0], x, value[..., 1]], axis=-1)


def wedge_elevation(scene: Scene, fold_angles: np.ndarray) -> float:
    """Return the elevation upsilon of crease 1 of a D_n state with a wedge of three creases [rad].

    In the frame of the folded wedge (ray 1 at e1) the last mirror has the inward normal H n_k,
    n_k = (sin pi/n, -cos pi/n, 0); the chart's frame is turned from it by Q(e2, upsilon), so that
    H n_k = (sin pi/n cos upsilon, -cos pi/n, sin pi/n sin upsilon).
    """
    n = scene.group.order
    azimuth, h = 0.0, quat.IDENTITY
    for r, ray in enumerate(scene.group.rays):
        half = fold_angles[_number(scene, r) - 1] / (2 if r == 1 else 4)
        axis = (math.cos(azimuth), math.sin(azimuth), 0.0)
        h = quat.multiply(h, quat.fold(math.cos(half), math.sin(half), axis))  # type: ignore[assignment]
        azimuth += ray.sector
    normal = quat.rotate(h, (math.sin(math.pi / n), -math.cos(math.pi / n), 0.0))
    return math.atan2(normal[2], normal[0])


def _place_wedge(chart: Landscape, phi: np.ndarray) -> Place:
    scene = chart.scene
    wedge = np.array([phi[_number(scene, r) - 1] for r in range(3)])
    v = wedge_elevation(scene, phi)
    # on the fold J = 0, where the branches meet, rounding can move v to where no state is: look around
    nearby = v + np.array([0.0, -1e-9, 1e-9, -1e-6, 1e-6])
    misfit, own = [], []
    for sign in (1, -1):
        point = _wedge_chart(scene, nearby, wedge[1], sign)
        error = np.abs(point.value - wedge[[0, 2]]).max(axis=-1)
        error[~np.isin(point.reason, (Reason.OK, Reason.FOLD))] = np.inf
        misfit.append(float(error.min()))
        own.append(bool(point.own_side[0]))
    best = int(np.argmin(misfit))
    tie = abs(misfit[0] - misfit[1]) < 1e-2 if np.isfinite(misfit).all() else misfit[0] == misfit[1]
    if tie:  # both branches: prefer the one that is drawn here
        rows = [b.axes[1] for b in chart.branches]
        drawn = [a[0] <= v <= a[-1] for a in rows]
        best = max((0, 1), key=lambda k: (drawn[k], own[k], -misfit[k]))
    return Place(best, (float(wedge[1]), v), _family(scene, phi))


# ---------------------------------------------------------------- one freedom: curves


def _curves(scene: Scene, size: int) -> Landscape:
    from origami_nlp.tell.curves import trace_curves  # builds the CasADi model

    curves = trace_curves(scene, 2 * math.pi / size)
    orbit = list(scene.group.orbit)
    pieces = []
    for x in curves:
        phi = x[:, _variables(scene)[orbit]]
        good = admissible(scene, phi)
        if scene.contact == "full":  # few states: the order of touching layers too
            good[good] = [examine(scene.vertex, state).admissible for state in phi[good]]
        if good.sum() > 1:
            pieces.append((x, np.where(good[:, None], phi, np.nan)))
    if not pieces:
        return Landscape(
            scene,
            "none",
            (),
            (),
            f"no admissible curve leaves the flat state with {scene.group.name}",
        )
    # the fold angle over which every curve is widest, or some would be drawn upright
    width = np.min([np.nanmax(phi, axis=0) - np.nanmin(phi, axis=0) for _, phi in pieces], axis=0)
    crease = int(np.argmax(np.round(width, 3)))
    branches = tuple(
        Branch(
            f"curve {k}" if len(pieces) > 1 else "",
            (phi[:, crease],),
            np.asarray(scene.energy(phi)),
            phi,
        )
        for k, (_, phi) in enumerate(pieces, start=1)
    )
    return Landscape(scene, "curve", (f"phi_{crease + 1}",), branches)


def _variables(scene: Scene) -> np.ndarray:
    """For each ray of the piece, the position of its crease among the variables."""
    return np.cumsum([ray.crease is not None for ray in scene.group.rays]) - 1


def _place_on_curve(chart: Landscape, phi: np.ndarray) -> Place:
    crease = int(chart.coordinates[0].removeprefix("phi_")) - 1
    away = [np.nanmin(np.linalg.norm(b.fold_angles - phi, axis=1)) for b in chart.branches]
    return Place(int(np.argmin(away)), (float(phi[crease]), float(chart.scene.energy(phi))))
