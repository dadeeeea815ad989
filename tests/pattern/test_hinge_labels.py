"""Scenes and sheets with hinge laws under other labels, mirrored and turned over: the same answers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.pattern import (
    double_well,
    linear,
    sum_of,
    well,
)
from origami_nlp.pattern_problem import pose
from tests.relabelled_vertex import every_label

LAW = sum_of([linear(0.7, 0.4), well(0.5, -1.0, 0.4)])


def scene():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    laws = (LAW, None, double_well(0.8, 1.0, 0.2), None)
    limits = ((-2.0, 2.5), (-3.0, 1.0), (-2.5, 2.5), (-1.5, 3.0))
    return Scene(
        vertex, (1.0, 0.6, 1.4, 0.8), (0.0, -0.7, 0.0, 1.6), "none", limits=limits, laws=laws
    )


def moves(origami):
    return pose(origami).labels.symmetries


def test_all_labels_of_a_vertex_are_one_scene():
    first = scene()
    minima = o.find_minima(first, escape=False).minima
    for k, labels in enumerate(every_label(4)):
        other = labels.of(first)
        phi = np.array([m.fold_angles for m in minima])
        assert np.allclose(other.energy(labels.seen(phi)), first.energy(phi))
        ours, theirs = pose(first).labels, pose(other).labels
        assert np.allclose(labels.seen(ours.drawn(phi)), theirs.drawn(phi))
        if k in (2, 9):
            theirs = o.find_minima(other, escape=False).minima
            energies = [m.energy for m in theirs]
            assert energies == pytest.approx([m.energy for m in minima], rel=1e-9)


def test_symmetries_of_a_vertex_with_laws():
    plain = replace(o.examples.degree6("pi/3"), symmetry="none")
    laws = replace(plain, laws=tuple(map(linear, plain.stiffness, plain.rest_angles)))
    assert len(moves(laws)) == len(moves(plain)) > 0
    # turned over, a law is another one unless it is even
    odd = replace(plain, laws=(LAW,) * 6)
    even = replace(plain, laws=(double_well(1.0, 1.0),) * 6)
    assert all(one.sign > 0 for one in moves(odd))
    assert sum(one.sign < 0 for one in moves(even)) == len(moves(odd)) + 1


def test_symmetries_of_a_sheet_with_laws():
    sheet = o.examples.pattern("miura", 2, 2)
    pairs = zip(sheet.stiffness.tolist(), sheet.rest.tolist(), strict=True)
    laws = sheet.with_laws([linear(k, r) for k, r in pairs])
    assert len(moves(laws)) == len(moves(sheet)) > 0
    odd = sheet.with_laws([LAW] * 4)
    assert all(one.sign > 0 for one in moves(odd))
