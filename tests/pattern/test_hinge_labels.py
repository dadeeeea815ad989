"""Scenes and sheets with hinge laws under other labels, mirrored and turned over: the same answers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.pattern import (
    canonical_labels,
    double_well,
    linear,
    same_laws,
    sum_of,
    symmetries,
    well,
)
from origami_nlp.pattern.labels import every_label
from origami_nlp.pattern_problem import find_labels

LAW = sum_of([linear(0.7, 0.4), well(0.5, -1.0, 0.4)])


def scene():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    laws = (LAW, None, double_well(0.8, 1.0, 0.2), None)
    limits = ((-2.0, 2.5), (-3.0, 1.0), (-2.5, 2.5), (-1.5, 3.0))
    return Scene(
        vertex, (1.0, 0.6, 1.4, 0.8), (0.0, -0.7, 0.0, 1.6), "none", limits=limits, laws=laws
    )


def test_all_labels_of_a_vertex_are_one_scene():
    first = scene()
    minima = o.find_minima(first, escape=False).minima
    reference = canonical_labels(first).relabelled(first)
    for k, labels in enumerate(every_label(4)):
        other = labels.relabelled(first)
        again = canonical_labels(other).relabelled(other)
        assert same_laws(again.laws, reference.laws)
        assert np.allclose(again.limits, reference.limits, atol=1e-12)
        phi = np.array([m.fold_angles for m in minima])
        seen = labels.sign * phi[:, labels.creases]
        assert np.allclose(np.mean(first.stiffness) * other.energy(seen), first.energy(phi))
        if k in (2, 9):
            theirs = o.find_minima(other, escape=False).minima
            energies = [np.mean(first.stiffness) * m.energy for m in theirs]
            assert energies == pytest.approx([m.energy for m in minima], rel=1e-9)


def test_symmetries_of_a_vertex_with_laws():
    plain = replace(o.examples.degree6("pi/3"), symmetry="none")
    laws = replace(plain, laws=tuple(map(linear, plain.stiffness, plain.rest_angles)))
    assert len(symmetries(laws)) == len(symmetries(plain)) > 0
    # turned over, a law is another one unless it is even
    odd = replace(plain, laws=(LAW,) * 6)
    even = replace(plain, laws=(double_well(1.0, 1.0),) * 6)
    assert not any(labels.over for labels in symmetries(odd))
    assert sum(labels.over for labels in symmetries(even)) == len(symmetries(odd)) + 1


def test_symmetries_of_a_sheet_with_laws():
    sheet = o.examples.pattern("miura", 2, 2)
    pairs = zip(sheet.stiffness.tolist(), sheet.rest.tolist(), strict=True)
    laws = sheet.with_laws([linear(k, r) for k, r in pairs])
    plain = find_labels(sheet).symmetries(sheet)
    assert len(find_labels(laws).symmetries(laws)) == len(plain) > 0
    odd = sheet.with_laws([LAW] * 4)
    assert all(sign > 0 for _, sign in find_labels(odd).symmetries(odd))
