"""The energy landscape of a scene over the paper's coordinates, as plain data.

Three forms, by the scene's symmetric degrees of freedom:

- D_1, degree 6 (two degrees of freedom): (phi_2, phi_3), the fold angles between the mirror creases; the rest
  from `closed_forms.degree6` (paper, eq. 3.2, phi1-6-fold).
- D_n, n >= 2, wedge of three creases (degree 4 n; two degrees of freedom): (phi_2, elevation upsilon of crease
  1, paper's sign: F_1 = Q(e2, upsilon) Q(b_1, phi_1/2)), two branches, from `closed_forms.wedge3`.
- one degree of freedom: the curves of closed states, traced numerically, over one of their fold angles.

Anything else has no chart: `Landscape.reason` says why.  Radians; energies in the scene's units.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.arguments import check_angles, check_type, check_whole
from origami_nlp.chart.chart import Chart, admissible, allowed, chart_limits, chart_of
from origami_nlp.continuation import ContinuationOptions, End, Point, trace_held
from origami_nlp.display import shown
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSURE_TOL, CONTACT_TOL, SETTLED
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import pose
from origami_nlp.problem import FoldLimits


@dataclass(frozen=True, repr=False)
class EnergyBranch(ShortRepr):
    """One part of the landscape (an area, or one curve).

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
    drawn: False where |phi| > pi at some crease, which no chart covers, or the state is of another winding.
    """

    branch: int = field(metadata=shown("branch"))
    point: tuple[float, float] = field(metadata=shown("place", spec=".6f"))
    drawn: bool = field(default=True, metadata=shown("drawn"))


LARGEST_SIZE = 8192
"""Cells along each coordinate at most; that many take about 5 GB."""


@dataclass(frozen=True, repr=False)
class Landscape(ShortRepr):
    """Energy over the coordinates of a scene.

    kind: ``"area"`` (two coordinates), ``"curve"`` (one) or ``"none"``.
    coordinates: names, such as ``("phi_2", "phi_3")``; creases are numbered as in the scene.
    branches: at least one, unless kind is ``"none"``.
    reason: why there is no landscape, in words; empty otherwise.
    """

    scene: Scene
    kind: str
    coordinates: tuple[str, ...]
    branches: tuple[EnergyBranch, ...]
    reason: str = ""

    @property
    def one_plane(self) -> bool:
        """Whether all branches fit into one picture, each on its own side of zero."""
        chart = chart_of(self.scene)
        return len(self.branches) <= 1 or (chart is not None and chart.sided)

    def place(self, fold_angles: object, winding: int = 1) -> Place:
        """Return where the state with all N `fold_angles` [rad] lies, which winds so often round the axis.

        Raises
        ------
        OptionError
            If there is no landscape.
        AngleError
            If `fold_angles` are not those of one state.
        """
        if self.kind == "none":
            raise OptionError(f"this scene has no landscape: {self.reason}")
        phi = check_angles("fold_angles", fold_angles, self.scene.degree, one=True)
        if self.kind == "curve":
            place = _place_on_curve(self, phi)
        else:
            place = _place_on_area(self, phi)
        here = winding == (self.scene.winding or 1)
        return replace(place, drawn=here and bool(np.abs(phi).max() <= math.pi + CONTACT_TOL))


def landscape(scene: Scene, size: int = 401) -> Landscape:
    """Evaluate the energy landscape of `scene`: of states that wind once round the axis, or `Scene.winding` times.

    Parameters
    ----------
    size
        Cells along each coordinate, 8 to 8,192 (for curves: along a full turn of a fold angle).

    Raises
    ------
    OptionError
        If `scene` is no scene, or `size` no such number.
    """
    check_type("scene", scene, Scene)
    size = check_whole("size", size, 8, LARGEST_SIZE)
    chart = chart_of(scene)
    if chart is not None:
        return _areas(chart, size)
    name, dof = scene.group.name, pose(scene).dof
    if dof == 1:
        return _curves(scene, size)
    why = f"{dof} degrees of freedom keep the symmetry {name}: no two-coordinate chart for this vertex"
    return Landscape(scene, "none", (), (), why)


def cells(low: float, high: float, size: int) -> np.ndarray:
    """Return the centres of `size` equal cells between low and high."""
    return low + (high - low) * (np.arange(size) + 0.5) / size


def _areas(chart: Chart, size: int) -> Landscape:
    """Evaluate all branches, inadmissible states blanked out."""
    scene, branches = chart.scene, []
    x = cells(-math.pi, math.pi, size)
    for k, sign in enumerate(chart.signs):
        name = "" if chart.kind == "degree6" else f"branch {sign:+d}"
        low, high = chart_limits(chart)[2:]
        if chart.sided:
            low, high = (0.0, high) if sign < 0 else (low, 0.0)
        y = cells(low, high, size)
        good, phi = allowed(chart, k, *np.meshgrid(x, y))
        phi[~good] = np.nan
        branches.append(EnergyBranch(name, (x, y), np.asarray(scene.energy(phi)), phi))
    return Landscape(scene, "area", chart.coordinates, tuple(branches))


def _place_on_area(picture: Landscape, phi: np.ndarray) -> Place:
    chart = chart_of(picture.scene)
    assert chart is not None
    x, y = chart.points(phi).tolist()
    best, sure = (v.item() for v in chart.branch_of(phi))
    rows = [b.axes[1] for b in picture.branches]
    # on both branches: prefer the one that is drawn here
    nearby = [best] if sure > SETTLED else [best, 1 - best]
    drawn = [k for k in nearby if rows[k][0] <= y <= rows[k][-1]]
    return Place((drawn or nearby)[0], (x, y))


# ---------------------------------------------------------------- one degree of freedom: curves


def _curves(scene: Scene, size: int) -> Landscape:
    curves = trace_curves(scene, 2 * math.pi / size)
    if not curves:
        why = f"no admissible curve of states keeps {scene.group.name}"
        return Landscape(scene, "none", (), (), why)
    # the fold angle over which every curve is widest, or some would be drawn upright
    crease = int(np.argmax(np.min([np.ptp(phi, axis=0).round(3) for phi in curves], axis=0)))
    branches = tuple(
        EnergyBranch(f"curve {k}", (phi[:, crease],), np.asarray(scene.energy(phi)), phi)
        for k, phi in enumerate(curves, start=1)
    )
    return Landscape(scene, "curve", (f"phi_{crease + 1}",), branches)


def _place_on_curve(chart: Landscape, phi: np.ndarray) -> Place:
    crease = int(chart.coordinates[0].removeprefix("phi_")) - 1
    away = [np.linalg.norm(b.fold_angles - phi, axis=1).min() for b in chart.branches]
    return Place(int(np.argmin(away)), (float(phi[crease]), float(chart.scene.energy(phi))))


STARTS = 96
"""Projected random states from which curves are looked for; the same every time."""


def trace_curves(scene: Scene, step: float) -> list[np.ndarray]:
    """Trace the admissible states of a scene with one degree of freedom, inside |phi| <= pi.

    Parameters
    ----------
    step
        Distance of successive points at most, in the space of the problem's variables [rad].

    Returns
    -------
    curves
        Fold angles [m, N] each, in order along the curve, which ends at limits, contacts, and where curves cross, as at
        the flat state.
    """
    problem = pose(scene)
    reach = np.full(problem.size, math.pi)
    inside = problem.fold_limits if problem.has_limits else FoldLimits(-reach, reach)
    any_angles = np.random.default_rng(0).uniform(-math.pi, math.pi, (STARTS, problem.size))
    steps = ContinuationOptions(first=step / 4, longest=step, together=12, most=6000)

    def before(points: Sequence[Point]) -> int:
        x = np.array([p.x for p in points])
        good = inside.inside(x).all(axis=1)
        good[good] = admissible(scene, problem.expand(x[good])) & problem.lifts_to_one(x[good])
        return len(x) if good.all() else int(np.argmin(good))

    curves: list[np.ndarray] = []
    for x in project(problem, any_angles)[0]:
        at = State(problem, x)
        if at.residual > CLOSURE_TOL or not inside.inside(x).all() or at.refused:
            continue
        if any(np.abs(c - at.fold_angles).max(axis=1).min() < step for c in curves):
            continue
        found = trace_held(at.on(), steps, [End[Point](before, "no admissible state beyond")], 1)
        if found is not None and len(found.states) > 2:
            curves.append(problem.expand(inside.clip(found.states)))
    return curves
