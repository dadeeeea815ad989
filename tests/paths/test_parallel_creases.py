"""Sheets without vertices: one crease, and two that are parallel, whose facets come to lie on each other."""

from __future__ import annotations

import json

import pytest

from tests.command_line import run


def strip(many: int) -> dict:
    """A strip with so many creases across, mountains and valleys in turn."""
    n = many + 2
    return {
        "vertices_coords": [[i, j] for j in (0, 1) for i in range(n)],
        "edges_vertices": [[i, i + n] for i in range(n)]
        + [[i + j, i + j + 1] for j in (0, n) for i in range(n - 1)],
        "edges_assignment": ["B", *("MV" * many)[:many], "B", *"B" * (2 * n - 2)],
    }


@pytest.mark.parametrize("many", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_strip_is_loaded_and_its_states_are_found(tmp_path, many):
    path = tmp_path / "strip.fold"
    path.write_text(json.dumps(strip(many)))
    done = run("load", path, "--crease", "1")
    assert done.code == 0, done.err
    done = run("inspect", path)
    assert done.code == 0 and f"{many} degree" in done.out
