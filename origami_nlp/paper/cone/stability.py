"""Are the minima of cone branches stable when the vertex may leave the branch?

A branch is one curve in the space of all closed states.  Every minimum on it is taken, as a state of the
vertex without symmetry and with full contact, to `minima.judge_in_full_space`: closure, contact, multipliers,
Hessian on the tangent space, and for unstable states a descent of admissible states.  Branches of one class have equal
energies but different neighbourhoods, so every arrangement that no rotation or reflection makes equal is judged.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_callback
from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.kkt import State
from origami_nlp.minima import FullSpace, judge_in_full_space
from origami_nlp.numerics import residual_words
from origami_nlp.paper.cone.branches import ConeBranch, class_of
from origami_nlp.paper.cone.minima import ConeCount, count
from origami_nlp.paper.cone.necklaces import Folding, foldings
from origami_nlp.paper.cone.rules import Cone, Rest, check_ratio
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.pattern_problem import pose

LARGEST_DEGREE = 16
"""The full space is searched with general machinery: 36 arrangements x 2 directions at degree 16."""
VERDICTS = ("stable", "unstable", "undecided")
Progress = Callable[[int, int], None]
"""Called as progress(states judged, all)."""


@dataclass(frozen=True)
class JudgedMinimum:
    """One minimum of a branch, judged in the full contact-admissible space.

    Attributes
    ----------
    branch
        Where it is.
    copies
        Number of branches that rotations and reflections make of it.
    kind
        "interior", "contact" (at the end of the branch) or "cut" (see `ConeMinima`).
    elevation
        |v| [rad].
    energy
        Per k_odd.
    depth
        (U_flat - U)/U_flat.
    fold_angles
        All N [rad].
    residual
        Norm of the energy's gradient along closed states, per k_odd [rad]: 0 for an equilibrium; at regular
        interior states a positive value proves that the state is not a minimum.
    verdict
        ``stable``, ``unstable`` or ``undecided``.
    full_space
        The verdict, with certificate and descent.
    """

    branch: ConeBranch = field(metadata=shown("flaps"))
    copies: int = field(metadata=shown("copies"))
    kind: str = field(metadata=shown("kind"))
    elevation: float = field(metadata=shown("|v|", spec=".4f"))
    energy: float
    depth: float = field(metadata=shown("depth", spec=".4g"))
    fold_angles: tuple[float, ...] = field(repr=False)
    residual: float = field(metadata=shown("slope", spec=residual_words))
    verdict: str = field(metadata=shown("verdict"))
    full_space: FullSpace = field(repr=False)


@dataclass(frozen=True, repr=False)
class ConeFullSpace(Report):
    """All branch minima of a cone in the full space.

    Attributes
    ----------
    cone
        Degree and rules.
    ratio
        k_even/k_odd.
    rest
        Rest angles.
    states
        One for each arrangement, direction and minimum.
    """

    cone: Cone
    ratio: float
    rest: Rest
    states: tuple[JudgedMinimum, ...] = field(repr=False)

    SCHEMA, READS = "origami-nlp/paper/1", False
    ALSO = ("branch_minima", "stable", "unstable", "undecided")
    branch_minima = property(lambda self: self.count())
    stable = property(lambda self: self.count("stable"))
    unstable = property(lambda self: self.count("unstable"))
    undecided = property(lambda self: self.count("undecided"))

    def count(self, verdict: str | None = None) -> int:
        """Count branch minima over all branches (copies included), of one verdict."""
        return sum(s.copies for s in self.states if verdict in (None, s.verdict))

    def report_sections(self) -> Iterator[Section]:
        """Return a row for each arrangement, direction and minimum, and the totals over all branches."""
        title = f"cone of degree {self.cone.degree}, r_k = {self.ratio:g}, nu_0 = {self.rest.elevation:g}"
        yield record_table(self.states, title)
        words = [f"{self.count(v)} {v}" for v in VERDICTS]
        yield f"of {self.count()} branch minima: " + ", ".join(words)


def cone_scene(degree: int, ratio: float, rest: Rest) -> Scene:
    """Make the cone as a scene: k_odd = 1, k_even = r, full contact, no imposed symmetry."""
    flaps = degree // 2
    name = f"cone of degree {degree}, r_k = {ratio:g}, nu_0 = {rest.elevation:.6g}"
    sheet = Vertex((2 * math.pi / degree,) * degree)
    return Scene(sheet, (1.0, ratio) * flaps, (rest.odd, rest.even) * flaps, "none", name=name)


def full_space(
    cone: Cone | int, ratio: float, elevation: float, *, progress: Progress | None = None
) -> ConeFullSpace:
    """Judge every branch minimum of a cone in the full contact-admissible space.

    Parameters
    ----------
    cone
        A `Cone`, or its degree: even, 6 to 16.
    ratio
        r_k = k_even/k_odd.
    elevation
        nu_0 of the rest state, signed [rad]; see `Cone.at_rest`.
    progress
        Called after each state.

    Returns
    -------
    ConeFullSpace
        Every minimum with its verdict, certificate and descent.

    Raises
    ------
    OptionError, AngleError
        For values out of range.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> judged = cone.full_space(6, ratio=1.0, elevation=0.5)
    >>> judged.count(), judged.count("stable"), judged.count("undecided")
    (8, 2, 0)
    """
    cone = Cone.of(cone, LARGEST_DEGREE)
    ratio = check_ratio(ratio)
    check_callback("progress", progress)
    rest = cone.at_rest(elevation)
    scene = cone_scene(cone.degree, ratio, rest)
    problem = pose(scene)
    jobs = _jobs(count(cone, ratio, elevation))
    flat = scene.energy(np.zeros(cone.degree))
    states = []
    for done, (folding, direction, kind, v) in enumerate(jobs, start=1):
        own = ConeBranch(folding.flaps, direction, cone.end)
        x = own.fold_angles(direction * v)
        # k_odd = 1: energies per k_odd
        energy, judged = float(scene.energy(x)), judge_in_full_space(problem, x)
        depth = float((flat - energy) / flat) if flat > 0 else math.nan
        where = own, folding.copies, kind, v, energy, depth, tuple(x.tolist())
        slope = tangent_slope(State(problem, x))
        states.append(JudgedMinimum(*where, slope, judged.verdict, judged))
        if progress:
            progress(done, len(jobs))
    return ConeFullSpace(cone, ratio, rest, tuple(states))


def _jobs(found: ConeCount) -> list[tuple[Folding, int, str, float]]:
    """List (arrangement, direction, kind, |v|) of every minimum, for each arrangement that differs."""
    m = found.minima
    jobs = []
    for folding in foldings(found.cone.degree, mirrors_differ=False):
        for direction in (1, -1):
            own = m.branches.of_class(*class_of(folding.flaps), direction)
            pairs = zip(m.kind[own].tolist(), np.abs(m.elevation[own]).tolist(), strict=True)
            jobs += [(folding, direction, kind, v) for kind, v in pairs]
    return jobs


def tangent_slope(state: State) -> float:
    """Norm of the gradient of the energy along closed states [scene's units]; nan where closure is singular."""
    if state.kernel.shape[1] > len(state.x) - 3:
        return math.nan
    return float(np.linalg.norm(state.kernel.T @ state.gradient)) * state.problem.scale
