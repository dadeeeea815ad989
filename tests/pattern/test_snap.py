"""Drawings whose corners are off: by as much as is said they are moved, so that they fold as the clean ones."""

import json

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.pattern import fold_vertices, frame_pattern, parse_fold


def noisy(noise, seed=0, rows=2, columns=3):
    """A Miura sheet whose corners are off by so much of its size."""
    data = o.examples.crease_pattern("miura", rows, columns)
    del data["edges_foldAngle"]
    corners = np.array(data["vertices_coords"], float)
    size = np.ptp(corners, axis=0).max()
    corners[:, :2] += noise * size * np.random.default_rng(seed).uniform(-1, 1, (len(corners), 2))
    return {**data, "vertices_coords": corners.tolist()}, size


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("noise", [1e-6, 1e-5, 3e-4, 1e-3])
def test_a_sheet_that_is_off_folds_as_the_clean_one(noise, seed):
    data, size = noisy(noise, seed)
    (frame,) = parse_fold(json.dumps(data))
    tolerance = 8 * noise
    made = frame_pattern(frame, snap=tolerance)
    moved = np.linalg.norm(made.corners - frame.coords, axis=1).max()
    assert 0 < moved <= tolerance * size
    clean = o.examples.pattern("miura", 2, 3)
    assert o.analyze_mobility(made).dof == o.analyze_mobility(clean).dof == 1
    flat = parse_fold(json.dumps({**data, "vertices_coords": made.corners.tolist()}))[0]
    assert max(v.kawasaki for v in fold_vertices(flat)[0]) < 1e-11


def test_what_is_off_by_more_stays_where_it_is():
    data, size = noisy(3e-3)
    (frame,) = parse_fold(json.dumps(data))
    moved = np.linalg.norm(frame_pattern(frame, snap=1e-5).corners - frame.coords, axis=1)
    assert moved.max() <= 1e-5 * size
    (clean,) = parse_fold(json.dumps(noisy(0.0)[0]))
    made = frame_pattern(clean, snap=1e-3)
    assert (made.corners == clean.coords).all() and any("--snap" in note for note in made.notes)
    for wrong in (-1.0, 0.5, "x"):
        with pytest.raises(OptionError, match="snap"):
            frame_pattern(frame, snap=wrong)
