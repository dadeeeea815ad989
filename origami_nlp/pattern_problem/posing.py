"""A scene of one vertex as the problem of a sheet with one vertex: facets are triangles with two sides of length 1."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from origami_nlp.numerics import (
    CONTACT_TOL,
    DUPLICATE_TOL,
    OUTSIDE,
)
from origami_nlp.pattern import (
    Scene,
    Stated,
    as_origami,
    dead_loads,
    shape_of,
    winding_number,
)
from origami_nlp.pattern_problem.contact_pairs import ContactPair
from origami_nlp.pattern_problem.orbits import orbits_of
from origami_nlp.pattern_problem.problem import PatternProblem


def pose(origami: Stated) -> PatternProblem:
    """Pose an origami as a nonlinear program: of a scene states that keep its symmetry, whichever way they wind.

    Parameters
    ----------
    origami
        A vertex or a sheet with its springs, limits and loads, however it is stated.

    Returns
    -------
    PatternProblem
        Its variables are in the order of the creases of `Symmetry.rays`.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_problem import pose
    >>> problem = pose(o.examples.degree6("pi/3", ratio=1))
    >>> problem.size, problem.multiplicity.tolist(), problem.closure.count
    (4, [1, 2, 2, 1], 3)
    """
    stated = as_origami(origami)
    if isinstance(stated, Scene):
        return VertexProblem(stated)
    return PatternProblem(stated, stated.contact == "full")


class VertexProblem(PatternProblem):
    """The problem of one vertex as it is stated: its group, loads and windings, and its words.

    Parameters
    ----------
    scene
        The vertex with its springs.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene, n, paper = scene, scene.degree, scene.paper
        orbits = None
        if not scene.group.is_trivial:
            # crease i (0-based) runs to corner i + 1
            each = [
                ([0, *(((s - i if mirrored else i + s) % n) + 1 for i in range(n))], 1)
                for s, mirrored in scene.group.elements
            ]
            orbits = orbits_of(paper, each)
            # in the order of the creases that the symmetry names first
            firsts = [ray.crease for ray in scene.group.rays if ray.crease is not None]
            orbits = replace(orbits, orbit=np.argsort(orbits.orbit[firsts])[orbits.orbit])
        super().__init__(paper, scene.contact == "full", orbits, scene.contact != "none")
        self.told = vertex_words
        self.symmetry, self.besides = scene.group.name, tuple(_besides(scene))
        k = self.stiffness * self.scale
        self.scale = 2.0 ** round(math.log2(k.mean()))
        vars(self).pop("springs")
        # preload winds linear springs; beside laws it is a load
        beside = [m if law else 0.0 for m, law in zip(scene.preload, scene.laws, strict=False)]
        load = np.array(beside or [0.0] * n) / self.scale
        dead = dead_loads(scene.loads, scene.fixed_facet)
        self.springs = replace(
            self.springs,
            sectors=np.array(scene.vertex.sector_angles),
            load=load if orbits is None else orbits.gather(load),
            dead=dead and dead.times(1 / self.scale),
        )

    @property
    def whole(self) -> PatternProblem:
        """The problem of all fold angles, whatever symmetry is imposed on this one."""
        return self if self.orbits is None else VertexProblem(self.scene.without_symmetry)

    @property
    def canonical(self) -> tuple[PatternProblem, np.ndarray] | None:
        """The same vertex under labels that all agree on, to the last bit, and the crease that each of them names."""
        if self.orbits is not None or self.scene.loads:
            return None
        n, first, rank = self.size, int(self.labels.creases[0]), self.labels.rank
        way = 1 if rank[(first + 1) % n] < rank[first - 1] else -1
        order = (first + way * np.arange(n)) % n
        return VertexProblem(self.scene.relabelled(order, self.labels.sign)), order

    def winding(self, x: np.ndarray) -> int:
        """Return how often a closed state winds round the axis of the symmetry; 0 where none is asked for."""
        # folds beyond whole turns are not modelled
        beyond = not self.has_limits and np.abs(x).max() > self.bound + OUTSIDE
        if beyond or self.residual(x) > DUPLICATE_TOL:
            return 0
        often = winding_number(self.scene.vertex, self.scene.group, self.expand(x))
        return often if often in self.scene.windings else 0

    def shape(self, sector_angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return corners and fold angles of a reference state with given sector angles."""
        return shape_of(self.scene.vertex.flat, sector_angles)


def _besides(scene: Scene) -> Iterator[tuple[str, str]]:
    """Go through what of a scene is not modelled, and why."""
    if scene.adjusted:
        why = f"averaged over {scene.group.name}: symmetry_tolerance = {scene.symmetry_tolerance:g}"
        yield f"asymmetry of the data, up to {scene.adjusted:.1e}", why
    if scene.panels:
        why = "panels that share no crease, and corners at the vertex, are tested as paper"
        yield f"thickness of panels ({scene.panels[0]:g} mm) but for stops", why


def vertex_words(problem: PatternProblem, touch: ContactPair, x: np.ndarray | None) -> str:
    """Describe what touches round one vertex, 1-based: two creases that lie on each other at x, or a crease on a facet.

    Corner i (0-based) is the end of crease i.
    """
    a, b = touch.facets
    inner = touch.type == "vertex-face" or 0 in touch.corners
    if touch.type == "face-face" or not inner:
        return f"facets {min(a, b) + 1} and {max(a, b) + 1} on each other"
    of, on, (p, q) = b, a, touch.corners[:2]
    crease = p
    if touch.type == "edge-edge":
        r, s = touch.corners[2:]
        of, on, crease = (a, b, p + q) if 0 in (p, q) else (b, a, r + s)
    if x is not None:
        at, ends = problem.placed(x), np.array(sorted(problem.features.rings[on] - {0}))
        end = at.points(np.array([of]), np.array([crease]))
        near = np.linalg.norm(at.points(np.full(len(ends), on), ends) - end, axis=1)
        if near.min() <= CONTACT_TOL:
            pair = sorted((crease, int(ends[near.argmin()])))
            return f"creases {pair[0]} and {pair[1]} on each other"
    return f"crease {crease} on facet {on + 1}"
