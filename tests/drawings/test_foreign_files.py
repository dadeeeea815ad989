"""Drawings of other people, from eight projects: read, or refused for the right reason, and equal to their FOLD twins.

They may not be copied into the repository: they are looked for beside it, or where ORIGAMI_FOREIGN_FILES says.
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

import pytest

from origami_nlp.drawings import READERS, Drawing, drawing_kind, read_drawing
from origami_nlp.drawings.sheet import planar
from origami_nlp.errors import DrawingError
from origami_nlp.pattern import read_fold
from tests.fold_files import OTHERS

FOREIGN = Path(os.environ.get("ORIGAMI_FOREIGN_FILES", OTHERS / "foreign"))
PROJECTS = {
    "amandaghassaei+OrigamiSimulator": 84,
    "origamimagiro+flat-folder": 23,
    "rabbit-ear+rabbit-ear": 27,
    "oriedita+oriedita": 6,
    "oripa+oripa": 2,
    "SFPC+code-paper-scissors": 33,
    "rlmgieseking+crease-pattern-generator": 5,
    "rschamp+schamp-origami": 40,
}
"""Drawings of each that are looked at, at least."""
REASONS = (
    "curves: creases are straight",
    "in colours that say what it is",
    "has no lines",
    "not valid XML",
)
"""Why one is refused."""
LARGEST = 400_000
"""Bytes of a drawing that is read in the normal tests."""
TWINS = {
    "rabbit-ear+rabbit-ear": [
        ("tests/files/cp/windmill.cp", "tests/files/fold/windmill.fold"),
        ("tests/files/svg/maze-8x8.svg", "tests/files/fold/maze-8x8.fold"),
    ],
    "rlmgieseking+crease-pattern-generator": [
        ("examples/classic_vase.svg", "examples/classic_vase_2D.fold"),
        ("examples/curved_vase.svg", "examples/curved_vase_2D.fold"),
        ("examples/square_tube.svg", "examples/square_tube_2D.fold"),
    ],
}
"""Drawings, and FOLD files of the same designs."""


def drawings(project: str) -> list[Path]:
    folder = FOREIGN / project
    if not folder.is_dir():
        pytest.skip(f"other people's drawings are not here: {folder}")
    found = sorted(p for p in folder.rglob("*") if p.suffix.lower() in READERS)
    assert len(found) >= PROJECTS[project]
    return found


def check(path: Path) -> Drawing | None:
    """Read one, and hold it against what any planar drawing obeys."""
    raw = path.read_bytes()
    kind = drawing_kind(path.name, raw)
    assert kind is not None
    try:
        made = read_drawing(raw, kind, path.name)
    except DrawingError as error:
        assert any(reason in str(error) for reason in REASONS), error
        return None
    pairs = {tuple(sorted(e)) for e in made.edges.tolist()}
    graph = planar(made.points, made.edges)
    assert len({v for e in pairs for v in e}) - len(pairs) + graph.faces.sum() == len(graph.faces)
    assert len(made.letters) == len(made.edges) == len(made.angles)
    if len(pairs) < len(made.edges):
        assert any("drawn twice" in note for note in made.notes)
    return made


@pytest.mark.parametrize("project", PROJECTS)
def test_drawings_are_read_or_refused_for_a_reason(project):
    every = drawings(project)
    some = [p for p in every if p.stat().st_size < LARGEST]
    some = some[:: max(1, len(some) // 45)]
    read = [made for p in some if (made := check(p)) is not None]
    assert 2 * len(read) > len(some)


@pytest.mark.slow
@pytest.mark.parametrize("project", PROJECTS)
def test_all_drawings_are_read_or_refused_for_a_reason(project):
    for path in drawings(project):
        check(path)


@pytest.mark.parametrize("project", TWINS)
def test_drawings_and_fold_files_of_one_design_agree(project):
    drawings(project)
    for one, other in TWINS[project]:
        made = check(FOREIGN / project / one)
        (frame, *_) = read_fold(FOREIGN / project / other, "first")
        assert made is not None
        letters, stated = Counter(made.letters), Counter(frame.assignment)
        assert len(made.points) == len(set(frame.edges.ravel().tolist()))
        assert len(made.edges) == len(frame.edges)
        assert (letters["M"], letters["V"], letters["B"]) == (stated["M"], stated["V"], stated["B"])
        faces = len(frame.faces) or int(planar(frame.coords[:, :2], frame.edges).faces.sum())
        assert int(planar(made.points, made.edges).faces.sum()) == faces
