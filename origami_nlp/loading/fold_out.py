"""States along a load path as frames of a FOLD file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_type
from origami_nlp.folding import folded_frame, frames_to_fold, save_fold
from origami_nlp.loading.result import LoadPath


def path_to_fold(path: LoadPath) -> dict[str, Any]:
    """Return the stable states of all legs as FOLD data (spec 1.1), one frame each, in order."""
    frames = []
    for number, leg in enumerate(path.legs, start=1):
        for p in leg.points:
            title = f"leg {number}, {path.driver.name} = {p.t:.9g} {path.driver.unit}".rstrip()
            more = {"leg": number, "parameter": p.t, "energy": p.energy}
            frames.append(folded_frame(path.scene, p.fold_angles, title, **more))
    return frames_to_fold(path.scene, frames)


def write_path(path: LoadPath, target: str | Path) -> None:
    """Write the states along a load path as a FOLD file.

    Parameters
    ----------
    path
        Of `load_path`.
    target
        The file, written whole or not at all; ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If `path` is none, or the file cannot be written.
    """
    check_type("path", path, LoadPath)
    save_fold(path_to_fold(path), target)
