"""A scene of one vertex as the problem of a sheet with one vertex: facets are triangles with two sides of length 1."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, CONTACT_TOL, cross, quaternion
from origami_nlp.pattern import Pattern, Scene, Stated, as_origami, dead_loads, make_pattern
from origami_nlp.pattern_problem.contact_pairs import ContactPair
from origami_nlp.pattern_problem.labels import CanonicalLabelling
from origami_nlp.pattern_problem.orbits import orbits_of
from origami_nlp.pattern_problem.poses import rotations
from origami_nlp.pattern_problem.problem import PatternProblem

SHARES = np.linspace(0.0, 0.95, 39)
"""Of half a turn, by which creases of a vertex that does not lie flat are tried to be folded in its reference state."""


def pose(origami: Stated, labels: CanonicalLabelling | None = None) -> PatternProblem:
    """Pose an origami as a nonlinear program: of a scene states that keep its symmetry, whichever way they wind.

    Parameters
    ----------
    origami
        A vertex or a sheet with its springs, limits and loads, however it is stated.
    labels
        In whose order loops begin; None: as stated.

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
    scene = as_origami(origami)
    paper = scene if isinstance(scene, Pattern) else one_vertex(scene)
    paper = paper if labels is None else labels.arranged(paper)
    if isinstance(scene, Pattern):
        return PatternProblem(paper)
    n = scene.degree
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
    problem = PatternProblem(paper, scene.contact == "full", orbits, scene.contact != "none")
    problem.told, problem.shape = vertex_words, partial(_shape_of, scene.vertex.flat)
    problem.symmetry, problem.besides = scene.group.name, tuple(_besides(scene))
    k = problem.stiffness * problem.scale
    problem.scale = 2.0 ** round(math.log2(k.mean()))
    vars(problem).pop("springs")
    # preload winds linear springs; beside laws it is a load
    beside = [m if law else 0.0 for m, law in zip(scene.preload, scene.laws, strict=False)]
    load = np.array(beside or [0.0] * n) / problem.scale
    dead = dead_loads(scene.loads, scene.fixed_facet)
    problem.springs = replace(
        problem.springs,
        sectors=np.array(scene.vertex.sector_angles),
        load=load if orbits is None else orbits.gather(load),
        dead=dead and dead.times(1 / problem.scale),
    )
    return problem


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


def one_vertex(scene: Scene) -> Pattern:
    """Return the paper of a scene, its crease i between corners 0 and i (1-based)."""
    n, vertex = scene.degree, scene.vertex
    corners, angles = _shape_of(vertex.flat, np.array(vertex.sector_angles))
    creases = [(0, i + 1) for i in range(n)]
    polygons = [(0, i + 1, (i + 1) % n + 1) for i in range(n)]
    made = make_pattern(
        corners,
        polygons,
        fold_angles=dict(zip(creases, angles.tolist(), strict=True)),
        stiffness=dict(zip(creases, scene.stiffness, strict=True)),
        rest=dict(zip(creases, scene.wound_angles, strict=True)),
        name=scene.label,
    )
    limits = tuple(map(tuple, scene.limit_angles.T.tolist())) if scene.limits else ()
    return replace(made, limits=limits, laws=scene.laws)


def _shape_of(flat: bool, sectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertex and unit vectors along the creases of a closed state [N + 1, 3], and its fold angles [N]."""
    if not flat:
        rim, angles = _closed(sectors)
        return np.vstack([np.zeros(3), rim]), angles
    at = np.cumsum(sectors) - sectors
    rim = np.column_stack([np.cos(at), np.sin(at), np.zeros(len(at))])
    return np.vstack([np.zeros(3), rim]), np.zeros(len(at))


def _closed(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    n = len(a)
    # all creases but the last two are folded alike, or to and fro; the last facets close a spherical triangle
    most, best = -CLOSURE_TOL, np.zeros((n, 3))
    to_and_fro = (-1.0) ** np.arange(n)
    for share, way in itertools.product(SHARES, (np.ones(n), -np.ones(n), to_and_fro)):
        folds = math.pi * share * way
        rays, frame = [np.array([1.0, 0.0, 0.0])], np.eye(3)
        for i in range(n - 2):
            c, s = math.cos(a[i]), math.sin(a[i])
            turn = rotations(np.array([[1.0, 0.0, 0.0]]), folds[i : i + 1])[0] if i else np.eye(3)
            frame = frame @ turn @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            rays.append(frame[:, 0])
        first, last = rays[0], rays[-1]
        # x = u first + v last + w (first x last) of length 1, at the angle a_N to one and a_(N-1) to the other
        between = float(first @ last)
        u, v = np.linalg.lstsq(
            np.array([[1.0, between], [between, 1.0]]), np.cos([a[-1], a[-2]]), rcond=None
        )[0]
        flat, up = u * first + v * last, cross(first, last)
        room, size = 1.0 - float(flat @ flat), float(np.linalg.norm(up))
        if room > most and size > CLOSURE_TOL:
            most, best = room, np.array([*rays, flat + math.sqrt(max(room, 0.0)) * up / size])
    angles = _fold_angles(best)
    q: tuple[float, ...] = quaternion.IDENTITY
    for fold, sector in zip((angles / 2).tolist(), (a / 2).tolist(), strict=True):
        q = quaternion.multiply(q, (math.cos(fold), math.sin(fold), 0.0, 0.0))
        q = quaternion.multiply(q, (math.cos(sector), 0.0, 0.0, math.sin(sector)))
    # once round a sheet is a whole turn, q = -1; a whole turn of one crease more is another lift of the same shape
    angles[0] -= 2 * math.pi * (q[0] > 0)
    return best, angles


def _fold_angles(rim: np.ndarray) -> np.ndarray:
    """Return the fold angles of a closed vertex, of unit vectors along its creases, [N]."""
    after = cross(rim, np.roll(rim, -1, axis=0))
    before = np.roll(after, 1, axis=0)
    up = np.einsum("ki,ki->k", rim, cross(before, after))
    return np.arctan2(up, np.einsum("ki,ki->k", before, after))
