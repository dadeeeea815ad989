"""Are the minima of cone branches stable when the vertex may leave the branch?

A branch is one curve in the space of all closed states.  Every minimum on it is taken, as a state of the
vertex without symmetry and with full contact, to `judge.full_space`: closure, contact, multipliers, Hessian on
the tangent space, and for unstable states a descent of admissible states.  Branches of one class have equal
energies but different neighbourhoods, so every arrangement that no rotation or reflection makes equal is judged.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_callback
from origami_nlp.cone.branches import ConeBranch, branch_label
from origami_nlp.cone.energy import Rest, rest_state
from origami_nlp.cone.flaps import Folding, bracelets, check_degree, class_of
from origami_nlp.cone.minima import ConeCount, branch_minima, check_ratio
from origami_nlp.minima import FullSpace, judge_in_full_space
from origami_nlp.numerics import RANK, null_space
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.programme import Model

LARGEST_DEGREE = 16
"""The full space is searched with general machinery: 36 arrangements x 2 directions at degree 16."""
Progress = Callable[[int, int], None]
"""Called as progress(states judged, all)."""


@dataclass(frozen=True)
class BranchVerdict:
    """One minimum of a branch, judged in the full contact-admissible space.

    flaps, direction: the branch.  label: of its class.  symmetry: of its states.
    copies: number of branches that rotations and reflections make of it.
    kind: "interior", "contact" (at the end of the branch) or "cut" (`cone_minima.BranchMinima`).  elevation: |v| [rad].
    energy: per k_odd.  depth: (U_flat - U)/U_flat.
    fold_angles: all N [rad].
    residual: norm of the energy's gradient along closed states, per k_odd [rad]: 0 for an
    equilibrium; at regular interior states a positive value proves that the state is none.
    full_space: the verdict, with certificate and descent.
    """

    flaps: tuple[int, ...]
    direction: int
    label: str
    symmetry: str
    copies: int
    kind: str
    elevation: float
    energy: float
    depth: float
    fold_angles: tuple[float, ...] = field(repr=False)
    residual: float
    full_space: FullSpace = field(repr=False)

    @property
    def verdict(self) -> str:
        """``stable``, ``unstable`` or ``undecided``."""
        return self.full_space.verdict


@dataclass(frozen=True)
class ConeFullSpace:
    """All branch minima of a cone in the full space.

    rest: rest angles.  ratio: k_even/k_odd.  states: one for each arrangement, direction and minimum.
    """

    degree: int
    ratio: float
    rest: Rest
    states: tuple[BranchVerdict, ...] = field(repr=False)

    def count(self, verdict: str | None = None, kind: str | None = None) -> int:
        """Count branch minima over all branches (copies included), of one verdict and kind."""
        return sum(
            s.copies for s in self.states if verdict in (None, s.verdict) and kind in (None, s.kind)
        )


def cone_scene(degree: int, ratio: float, rest: Rest, name: str | None = None) -> Scene:
    """Make the cone as a scene: k_odd = 1, k_even = r, full contact, no imposed symmetry."""
    flaps = degree // 2
    return Scene(
        Vertex((2 * math.pi / degree,) * degree),
        (1.0, ratio) * flaps,
        (rest.odd, rest.even) * flaps,
        "none",
        "full",
        name=name or f"cone of degree {degree}, r_k = {ratio:g}, nu_0 = {rest.elevation:.6g}",
    )


def cone_full_space(
    degree: int,
    ratio: float,
    rest_elevation: float,
    *,
    rest: str = "waterbomb",
    end: str = "contract",
    progress: Progress | None = None,
) -> ConeFullSpace:
    """Judge every branch minimum of a cone in the full contact-admissible space.

    Parameters
    ----------
    ratio, rest_elevation, rest, end
        Stiffness ratio, nu_0 [rad] and the rules for the rest state and the end of the branches
        (`cone_energy.rest_state`, `model.cone.branch_end`).
    progress
        Called after each state.

    Raises
    ------
    OptionError
        If the degree is above `LARGEST_DEGREE` or the ratio is not positive.
    """
    check_degree(degree, LARGEST_DEGREE)
    ratio = check_ratio(ratio)
    check_callback("progress", progress)
    stress_free = rest_state(degree, rest_elevation, rest)
    scene = cone_scene(degree, ratio, stress_free)
    model = Model(scene)
    jobs = _jobs(branch_minima(degree, ratio, rest_elevation, rest=rest, end=end))
    flat = scene.energy(np.zeros(degree))
    states = []
    for done, (folding, direction, kind, elevation) in enumerate(jobs, start=1):
        branch = ConeBranch(folding.flaps, direction, end)
        x = branch.fold_angles(direction * elevation)
        energy = float(scene.energy(x))
        states.append(
            BranchVerdict(
                folding.flaps,
                direction,
                branch_label(folding.flaps, direction),
                folding.symmetry,
                folding.copies,
                kind,
                elevation,
                energy,
                float((flat - energy) / flat) if flat > 0 else math.nan,
                tuple(x.tolist()),
                tangent_slope(model, x),
                judge_in_full_space(scene, x),
            )
        )
        if progress:
            progress(done, len(jobs))
    return ConeFullSpace(degree, ratio, stress_free, tuple(states))


def _jobs(count: ConeCount) -> list[tuple[Folding, int, str, float]]:
    """List (arrangement, direction, kind, |v|) of every minimum, for each arrangement that differs."""
    of_class: dict[tuple[int, int, int], list[tuple[str, float]]] = {}
    m = count.minima
    for k in range(len(m)):
        key = (int(m.valleys[k]), int(m.changes[k]), int(m.direction[k]))
        of_class.setdefault(key, []).append((str(m.kind[k]), abs(float(m.elevation[k]))))
    return [
        (folding, direction, kind, elevation)
        for folding in bracelets(count.degree)
        for direction in (1, -1)
        for kind, elevation in of_class.get((*class_of(folding.flaps), direction), [])
    ]


def tangent_slope(model: Model, x: np.ndarray) -> float:
    """Norm of the gradient of the energy along closed states [scene's units]; nan where closure is singular."""
    local = model.local(x)
    jacobian = local.closure_jacobian
    if (np.linalg.svd(jacobian, compute_uv=False) <= RANK).any():
        return math.nan
    return float(np.linalg.norm(null_space(jacobian).T @ local.gradient)) * model.scale
