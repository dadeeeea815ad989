"""A load path of a sheet as states that can be turned."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.loading import turn_loaded
from origami_nlp.sheet_loading.result import SheetLoadPath
from origami_nlp.sheets import sheet_poser
from origami_nlp.show import Content, Folded, Track


def turn_sheet_path(path: SheetLoadPath) -> Content:
    """Return the stable states of a sheet's load path, for a page that can be turned.

    Parameters
    ----------
    path
        Of `find_load_path`.

    Returns
    -------
    Content
        Of `loading.turn_loaded`.
    """
    body, pose, look = sheet_poser(path.pattern)

    def folded(phi: Sequence[float]) -> Folded:
        return pose(np.array(phi))

    def view(phi: Sequence[float]) -> np.ndarray:
        return look(np.array(phi))

    def track(title: str, states: list[Sequence[float]], loads: list[float], label: str) -> Track:
        middle = view(states[len(states) // 2])
        return Track(title, np.array(loads), label, tuple(map(folded, states)), middle)

    return turn_loaded(path, body, folded, view, track)
