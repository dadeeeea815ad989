"""Stable states as a FOLD file, with the ways down from unstable ones, and as a mesh."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from origami_nlp.arguments import require
from origami_nlp.errors import OptionError
from origami_nlp.io import write_whole
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.pattern import Origami
from origami_nlp.pattern_problem import path_frames, state_frame, states_to_fold

Part: TypeAlias = tuple[np.ndarray, np.ndarray]
"""Points [v, 3] and triangles [f, 3]."""
MESH_SUFFIXES = (".obj", ".stl", ".glb")


def minima_to_fold(origami: Origami, minima: Sequence[JudgedState]) -> dict[str, Any]:
    """Return minima as FOLD data (spec 1.1).

    States that are unstable in the full space are followed, after all states, by the frames of their descents.
    """
    frame = partial(state_frame, origami)
    frames = [frame(m.phi, m.title(k), **m.frame_entries()) for k, m in enumerate(minima, start=1)]
    for k, m in enumerate(minima, start=1):
        if m.full_space and m.full_space.descent:
            states, energies = zip(*m.full_space.descent, strict=True)
            frames += path_frames(frame, np.array(states), energies, f"descent from state {k}")
    return states_to_fold(origami, frames)


def write_parts(parts: Sequence[Part], target: str | Path) -> None:
    """Write triangles as one mesh, by way of trimesh (extra ``mesh``).

    Parameters
    ----------
    parts
        Points [v, 3] and triangles [f, 3] of each part; triangles without area are left out.
    target
        The file, ``.obj``, ``.stl`` or ``.glb`` (binary glTF).

    Raises
    ------
    OptionError
        If trimesh is not installed, the name ends in something else, there is no part, or the file cannot be written.
    """
    suffix = check_mesh(target)
    from trimesh import Trimesh, util, visual

    if not parts:
        raise OptionError(f"{str(target)!r}: no state was found to write")
    meshes = [Trimesh(points, faces, process=False) for points, faces in parts]
    for mesh in meshes:
        mesh.update_faces(mesh.area_faces > 0)
    whole: Any = util.concatenate(meshes)
    if suffix == ".glb":  # both sides of the paper are seen
        both = visual.material.PBRMaterial(doubleSided=True)
        whole.visual = visual.TextureVisuals(material=both)
    content = whole.export(None, file_type=suffix[1:])
    write_whole(target, content.encode() if isinstance(content, str) else bytes(content))


def check_mesh(target: str | Path) -> str:
    """Return the suffix of a mesh file, after seeing that it can be written (see `write_parts`)."""
    suffix = Path(target).suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise OptionError(
            f"mesh = {str(target)!r}: the name must end in {', '.join(MESH_SUFFIXES)}"
        )
    require("trimesh", "a mesh", "mesh")
    return suffix
