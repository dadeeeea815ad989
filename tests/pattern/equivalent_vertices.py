"""Scenes that are one scene under other labels, gathered: what tests of examples compare."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from origami_nlp.pattern import Relabelling, Scene
from origami_nlp.pattern.hinges_stated import same_laws
from origami_nlp.pattern.labels import _angles, _keeps, every_label


@dataclass(frozen=True)
class EquivalentVertices:
    """Scenes that differ by labels: where creases are counted from, which way round, which side is up.

    Attributes
    ----------
    numbers
        Of the scenes; the first one stands for all.
    labels
        Of each, those under which it is the first scene: ``labels[k].back(x)`` are states x of the first as states of
        scene k.
    apart
        Largest difference of an angle [rad], or relative one of a stiffness, that was taken for noise.
    """

    numbers: tuple[int, ...]
    labels: tuple[Relabelling, ...]
    apart: float


def group_equivalent_vertices(scenes: Mapping[int, Scene]) -> tuple[EquivalentVertices, ...]:
    """Gather scenes that are one scene under other labels.

    Parameters
    ----------
    scenes
        By number.  Angles [rad] and relative stiffnesses count as equal within the smaller `symmetry_tolerance`.

    Returns
    -------
    tuple of Alike
        In the order of their first scenes; every number in one of them.
    """
    groups: list[list[tuple[int, Relabelling, float]]] = []
    for number, scene in scenes.items():
        for group in groups:
            match = _match(scenes[group[0][0]], scene)
            if match is not None:
                group.append((number, *match))
                break
        else:
            groups.append([(number, Relabelling(0, False, False, scene.degree), 0.0)])
    found = []
    for group in groups:
        numbers, labels, apart = zip(*group, strict=True)
        found.append(EquivalentVertices(numbers, labels, max(apart)))
    return tuple(found)


def _match(first: Scene, other: Scene) -> tuple[Relabelling, float] | None:
    """Return the labels under which `other` comes nearest to `first`, and how near, if near enough."""
    n = first.degree
    kinds = [(s.contact, s.vertex.flat, s.group.name, s.winding) for s in (first, other)]
    if bool(first.laws) != bool(other.laws):
        return None
    if first.loads or other.loads:  # forces are counted from a facet that has a number
        return None
    if other.degree != n or kinds[0] != kinds[1]:
        return None
    noise = min(first.symmetry_tolerance, other.symmetry_tolerance)
    (sectors, k, *rest), theirs = (
        np.array([s.vertex.sector_angles, s.stiffness, *_angles(s)]) for s in (first, other)
    )
    if np.abs(np.sort(sectors) - np.sort(theirs[0])).max() > noise:
        return None
    best = None
    for labels in every_label(n):
        # fold angles change sign where the sheet is turned over (`Relabelling.sign`), stiffness and sectors do not
        i = labels.creases
        apart = max(
            float(np.abs(theirs[0, labels.facets] - sectors).max()),
            float(np.abs(theirs[1, i] / k - 1).max()),
            float(np.abs(labels.sign * theirs[2:, i] - rest).max()),
            float(np.abs(labels.limit_angles(other) - first.limit_angles).max()),
        )
        if first.laws and apart <= noise and not same_laws(labels.laws(other), first.laws):
            continue
        if apart <= noise and (best is None or apart < best[1]) and _keeps(first, other, i):
            best = labels, apart
    return best
