"""The same vertex under other labels: creases numbered from elsewhere, the other way round, or the paper turned over.

None of this changes physics.  A search that draws random numbers by label would; it is therefore made under labels
that all of these agree on, and one search serves all vertices that are one under other labels.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.errors import SymmetryError
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.pattern.hinges_stated import Laws, law_probes, same_laws, seen_laws
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.vertex import Vertex


@dataclass(frozen=True)
class Relabelling:
    """Other labels for the creases of a vertex.

    Attributes
    ----------
    start
        Crease of the scene (0-based) that comes first.
    backward
        Whether creases are counted clockwise, as in a mirror.
    over
        Whether the paper is turned over: mountains are valleys.
    degree
        Number of creases.
    """

    start: int
    backward: bool
    over: bool
    degree: int

    @property
    def creases(self) -> np.ndarray:
        """Crease of the scene that each new label names, [N]."""
        return (self.start + (-1 if self.backward else 1) * np.arange(self.degree)) % self.degree

    @property
    def facets(self) -> np.ndarray:
        """Facet of the scene that each new label names, [N]."""
        return (self.creases - 1) % self.degree if self.backward else self.creases

    @property
    def sign(self) -> int:
        """Sign of fold angles: -1 where the paper is turned over."""
        return -1 if self.over else 1

    def back(self, x: np.ndarray) -> np.ndarray:
        """Return states [..., N] under new labels as states of the scene."""
        out = np.empty_like(x)
        out[..., self.creases] = self.sign * x
        return out

    def _turned(self, values: tuple[float, ...]) -> np.ndarray:
        """Angles or torques [N] of the creases under the new labels."""
        return self.sign * np.array(values)[self.creases] + 0.0

    def limit_angles(self, scene: Scene) -> np.ndarray:
        """Low and high fold limits of the creases under the new labels, [2, N]; turned over, they change places."""
        limits = scene.limit_angles[:, self.creases]
        return -limits[::-1] if self.over else limits

    def laws(self, scene: Scene, share: float = 1.0) -> Laws:
        """Hinge laws of the creases under the new labels, `share` times their torques."""
        return seen_laws(tuple(scene.laws[i] for i in self.creases if scene.laws), self.over, share)

    def relabelled(self, scene: Scene) -> Scene:
        """Return a scene without symmetry under the new labels, its mean stiffness 1."""
        creases, mean = self.creases, _mean(scene)
        sectors = np.array(scene.vertex.sector_angles)[self.facets]
        vertex = Vertex(tuple(sectors.tolist()), scene.vertex.flat)
        known: Any = {"sector_angles": vertex.sector_angles, "made_exact": 0, "moved": 0.0}
        preload = (self._turned(scene.preload) / mean).tolist() if scene.preload else ()
        limits = map(tuple, self.limit_angles(scene).T.tolist()) if scene.limits else ()
        return Scene(
            vertex,
            tuple((np.array(scene.stiffness)[creases] / mean).tolist()),
            tuple(self._turned(scene.rest_angles).tolist()),
            symmetry="none",
            contact=scene.contact,
            preload=tuple(preload),
            limits=tuple(limits),
            laws=self.laws(scene, 1 / mean),
            relations=replace(scene.relations, **known),
        )


def canonical_labels(scene: Scene) -> Relabelling:
    """Return the labels under which a scene's numbers come first in order: the same for all its other labels.

    Numbers that differ by rounding only (1e-12) count as equal; of labels that then agree, which is a symmetry of the
    scene, the first is taken.

    Parameters
    ----------
    scene
        Any scene; its stiffness counts relative to the mean.

    Returns
    -------
    Relabelling
        Of all 4 N.
    """
    n = scene.degree
    mean = _mean(scene)
    k = np.array(scene.stiffness) / mean
    columns = np.stack([scene.vertex.sector_angles, k, _angles(scene)[1]])
    numbers = np.round(columns, 12) + 0.0
    probes = {over: np.round(law_probes(scene.laws, over, mean), 12) for over in (False, True)}

    def seen(labels: Relabelling) -> list[float]:
        rest = labels.sign * numbers[2, labels.creases] + 0.0
        limits = np.round(labels.limit_angles(scene), 12).ravel() + 0.0 if scene.limits else ()
        torques = probes[labels.over][labels.creases].ravel() + 0.0 if scene.laws else ()
        return [*numbers[0, labels.facets], *numbers[1, labels.creases], *rest, *limits, *torques]

    return min(every_label(n), key=seen)


def _mean(scene: Scene) -> float:
    """Return the mean stiffness, the same to the last bit whichever crease comes first."""
    return math.fsum(scene.stiffness) / scene.degree


def _angles(scene: Scene) -> np.ndarray:
    """Rest and wound angles [2, N]; of a law with several wells less its rest angle, which turns with the paper."""
    angles = np.array([scene.rest_angles, scene.wound_angles])
    rests = [
        law.one_rest if law else r for law, r in zip(scene.laws, scene.rest_angles, strict=False)
    ]
    return angles - (np.array(scene.rest_angles) - rests if scene.laws else 0.0)


def every_label(degree: int) -> list[Relabelling]:
    """Return all labels of a vertex, 4 N of them: from where, which way round, and from which side."""
    ways = itertools.product(range(degree), (False, True), (False, True))
    return [Relabelling(*way, degree) for way in ways]


def _keeps(scene: Scene, creases: np.ndarray) -> bool:
    """Return whether a scene keeps the same symmetries under labels that name `creases`."""
    i, place = np.arange(scene.degree), np.argsort(creases)
    images = [(s - i if mirrored else s + i) % scene.degree for s, mirrored in scene.group.elements]
    theirs = {tuple(place[p[creases]].tolist()) for p in images}
    return theirs == {tuple(p.tolist()) for p in images}


def symmetries(scene: Scene) -> list[Relabelling]:
    """Return the labels under which a scene without loads is itself: its symmetries, the identity left out.

    Parameters
    ----------
    scene
        Angles [rad] and relative stiffnesses count as equal within `DUPLICATE_TOL`.

    Returns
    -------
    list of Relabelling
        ``labels.back(x)`` are the states into which a symmetry takes states x; empty under loads.
    """
    if scene.loads:
        return []
    sectors, k = np.array(scene.vertex.sector_angles), np.array(scene.stiffness)
    signed = np.array([*_angles(scene), scene.preload or (0.0,) * scene.degree])

    def keeps(labels: Relabelling) -> bool:
        i = labels.creases
        differ = (
            sectors[labels.facets] - sectors,
            k[i] / k - 1,
            labels.sign * signed[:, i] - signed,
            labels.limit_angles(scene) - scene.limit_angles,
        )
        same = max(float(np.abs(d).max()) for d in differ) <= DUPLICATE_TOL
        laws = not scene.laws or same_laws(labels.laws(scene), scene.laws)
        return same and laws and _keeps(scene, i)

    return [labels for labels in every_label(scene.degree)[1:] if keeps(labels)]


def with_symmetry_of(scene: Scene, other: Scene) -> Scene:
    """Return a scene that keeps the symmetry of another, the same rotations and mirrors, and no larger one.

    Parameters
    ----------
    scene
        Which may have a larger symmetry.
    other
        Of the same degree.

    Returns
    -------
    Scene
        With the group of the other.

    Raises
    ------
    SymmetryError
        If it does not have them.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import with_symmetry_of
    >>> vertex = o.Vertex(("pi/2",) * 4)
    >>> equal, one = (o.Scene(vertex, (1, 1, 1, 1), (t, 0.2, 0.2, 0.2)) for t in (0.2, 0.3))
    >>> equal.group.name, one.group.name, with_symmetry_of(equal, one).group.name
    ('D4', 'D1', 'D1')
    """
    wanted, name = set(other.group.elements), other.group.name
    if set(scene.group.elements) == wanted:
        return scene
    mirrors = [None, *range(1, scene.degree + 1)] if name.startswith("D") else [None]
    for mirror in mirrors:
        with contextlib.suppress(SymmetryError):
            made = replace(scene, symmetry=name, mirror=mirror, winding=None)
            if set(made.group.elements) == wanted:
                return made
    why = f"is kept by the other scenes, and not so by this one, of group {scene.group.name}"
    raise SymmetryError(f'symmetry = {name!r} {why}: state symmetry = "none"')
