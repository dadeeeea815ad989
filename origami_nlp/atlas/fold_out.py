"""States along the branches of an atlas as frames of a FOLD file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_type
from origami_nlp.atlas.result import Atlas
from origami_nlp.folding import folded_frame, frames_to_fold, save_fold
from origami_nlp.pattern import Scene


def atlas_to_fold(atlas: Atlas) -> dict[str, Any]:
    """Return the points of all branches as FOLD data (spec 1.1), one frame each, in order."""
    over, frames = atlas.over, []
    scenes: dict[float, Scene] = {}
    for branch in atlas.branches:
        for k, point in enumerate(branch.points):
            if point.t not in scenes:
                scenes[point.t] = atlas.family.scene_of(point.t)
            kind = next(r.kind for r in branch.kind_ranges if r.points[0] <= k <= r.points[1])
            title = f"branch {branch.id}, {over.name} = {point.t:.9g}: {kind}"
            more = {"branch": branch.id, "parameter": point.t, "energy": point.energy, "kind": kind}
            frames.append(folded_frame(scenes[point.t], point.fold_angles, title, **more))
    return frames_to_fold(atlas.family.scene(over.low), frames)


def write_frames(atlas: Atlas, target: str | Path) -> None:
    """Write the states along all branches as a FOLD file.

    Parameters
    ----------
    atlas
        Of `follow`.
    target
        The file, written whole or not at all; ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If `atlas` is none, or the file cannot be written.
    """
    check_type("atlas", atlas, Atlas)
    save_fold(atlas_to_fold(atlas), target)
