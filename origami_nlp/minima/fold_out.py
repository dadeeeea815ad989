"""Stable states as a FOLD file (see `folding.fold_frames`), with the ways down from unstable ones, and as a mesh."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.files import write_whole
from origami_nlp.folding import fold_vertex, folded_frame, frames_to_fold, path_frames, save_fold
from origami_nlp.minima.result import MinimaResult

if TYPE_CHECKING:
    from trimesh import Trimesh

MESH_SUFFIXES = (".obj", ".stl", ".glb")


def minima_to_fold(result: MinimaResult) -> dict[str, Any]:
    """Return the states of `result` as FOLD data (spec 1.1).

    States that are unstable in the full space are followed, after all states, by the frames of their descents.
    """
    scene = result.scene
    frames = [
        folded_frame(scene, m.fold_angles, m.title(k), **m.frame_entries())
        for k, m in enumerate(result.minima, start=1)
    ]
    if not frames and not scene.vertex.flat:
        raise OptionError(
            "no minimum was found, and paper that is not flat has no crease pattern to write"
        )
    for k, m in enumerate(result.minima, start=1):
        if m.full_space and m.full_space.descent:
            states, energies = zip(*m.full_space.descent, strict=True)
            frames += path_frames(
                partial(folded_frame, scene), np.array(states), energies, f"descent from state {k}"
            )
    return frames_to_fold(scene, frames)


def write_fold(result: MinimaResult, target: str | Path) -> None:
    """Write states as a FOLD file (spec 1.1): the crease pattern, and one folded frame a state.

    Where the full space was asked for, the descents from unstable states follow, as frames of their own.

    Parameters
    ----------
    result
        Of `find_minima`.
    target
        The file, written whole or not at all; ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If `result` is no result, or the file cannot be written.

    Examples
    --------
    >>> import json, pathlib, tempfile, origami_nlp as o
    >>> path = pathlib.Path(tempfile.mkdtemp(), "states.fold")
    >>> o.write_fold(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), path)
    >>> [frame["frame_title"] for frame in json.loads(path.read_text())["file_frames"]]
    ['state 1: interior, 0.0090858 J', 'state 2: contact-touching, 1.2337 J']
    """
    check_type("result", result, MinimaResult)
    save_fold(minima_to_fold(result), target)


def write_mesh(result: MinimaResult, target: str | Path) -> None:
    """Write the states side by side as one triangle mesh, by way of trimesh (extra ``mesh``).

    Parameters
    ----------
    result
        Of `find_minima`.
    target
        The file, ``.obj``, ``.stl`` or ``.glb``.

    Raises
    ------
    OptionError
        If trimesh is not installed, the name ends in something else, there is no minimum, or the file cannot be
        written.

    Examples
    --------
    >>> import pathlib, tempfile, origami_nlp as o
    >>> path = pathlib.Path(tempfile.mkdtemp(), "states.stl")
    >>> o.write_mesh(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), path)
    >>> path.stat().st_size > 0
    True
    """
    suffix = check_mesh(target)
    import trimesh

    n = result.scene.degree
    faces = np.array([[0, i, i % n + 1] for i in range(1, n + 1)])
    parts = []
    for k, m in enumerate(result.minima):
        creases, _ = fold_vertex(result.scene.vertex, np.array(m.fold_angles))
        points = np.vstack([np.zeros((1, 3)), creases]) + np.array([2.5 * k, 0.0, 0.0])
        parts.append(trimesh.Trimesh(points, faces, process=False))
    if not parts:
        raise OptionError(f"--mesh = {str(target)!r}: no minimum was found to write")
    write_whole(target, join_meshes(parts, suffix))


def join_meshes(parts: Sequence[Trimesh], suffix: str) -> bytes:
    """Return triangle meshes as one, as the content of a file.

    Parameters
    ----------
    parts
        At least one.
    suffix
        Of the file, as `check_mesh` returns it; in ``.glb`` both sides of the paper are seen.

    Returns
    -------
    bytes
        The content.

    Examples
    --------
    >>> import trimesh
    >>> from origami_nlp.minima import join_meshes
    >>> one = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> join_meshes([one], ".glb")[:4], b'"doubleSided":true' in join_meshes([one], ".glb")
    (b'glTF', True)
    """
    from trimesh import util, visual

    whole: Any = util.concatenate(parts)
    if suffix == ".glb":
        both = visual.material.PBRMaterial(doubleSided=True)
        whole.visual = visual.TextureVisuals(material=both)
    content = whole.export(None, file_type=suffix[1:])
    return content.encode() if isinstance(content, str) else bytes(content)


def check_mesh(target: str | Path) -> str:
    """Return the suffix of a mesh file, after seeing that it can be written (see `write_mesh`)."""
    from importlib.util import find_spec

    suffix = Path(target).suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise OptionError(
            f"--mesh = {str(target)!r}: the name must end in {', '.join(MESH_SUFFIXES)}"
        )
    if find_spec("trimesh") is None:
        raise OptionError('--mesh needs trimesh: pip install "origami_nlp[mesh]"')
    return suffix
