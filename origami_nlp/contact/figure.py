"""A state in three dimensions with its active contacts drawn on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from origami_nlp.display import (
    IDLE,
    PUSHES,
    Pose,
    crease_legend,
    draw_state,
    drawn_height,
    label_text,
    pose_state,
)
from origami_nlp.kkt import ContactForce
from origami_nlp.minima import images
from origami_nlp.problem import Model

WIDTH = 4.2
"""Of the picture [in]."""
LOOKS: dict[bool, dict[str, Any]] = {
    True: {"color": PUSHES, "lw": 3.4},
    False: {"color": IDLE, "lw": 2.2, "ls": (0, (2, 1))},
}
"""Lines of contacts that push, and of those that only touch."""


def draw_contacts(
    model: Model, fold_angles: object, contacts: Sequence[ContactForce], title: str = ""
) -> Figure:
    """Draw a state; creases in contact are thick lines, facets in contact are outlined.

    Magenta contacts push, dashed grey ones carry nothing; images under the symmetry are drawn as well.

    Parameters
    ----------
    model
        Of the scene.
    fold_angles
        Of the state, shape [N] [rad].
    contacts
        Closed there, such as `JudgedState.contacts`.
    title
        Above the picture.

    Returns
    -------
    matplotlib.figure.Figure
        The picture.
    """
    phi = np.asarray(fold_angles, dtype=float)
    pushing = [contact.multiplier_range[1] > 0 for contact in contacts]
    handles: list[Any] = [
        Line2D([], [], **LOOKS[push], label=words)
        for push, words in ((True, "contact that pushes"), (False, "contact that only touches"))
        if push in pushing
    ]
    handles += crease_legend([(model.scene.vertex, phi)])
    drawn = WIDTH * drawn_height(model.scene.vertex, phi)
    legend, head = 0.21 * math.ceil(len(handles) / 2) + 0.1, 0.3 if title else 0.05
    height = head + drawn + 0.1 + legend
    figure = Figure(figsize=(WIDTH, height), dpi=100, facecolor="white")
    axes = figure.add_axes((0.0, 1 - (head + drawn) / height, 1.0, drawn / height))
    draw_state(axes, model.scene.vertex, phi, crop=True)
    limits = axes.get_xlim(), axes.get_ylim()
    pose = pose_state(model.scene.vertex, phi)
    for push, contact in sorted(zip(pushing, contacts, strict=True), key=lambda pair: pair[0]):
        creases, facets = images(model, contact)
        for f in facets:
            _line(axes, _facet(pose, f - 1), LOOKS[push] | {"lw": 1.6})
        for c in creases:
            _line(axes, _crease(pose, c - 1), LOOKS[push])
    axes.set(xlim=limits[0], ylim=limits[1])
    figure.legend(handles=handles, loc="lower center", ncols=2, fontsize=8.5, frameon=False)
    if title:
        figure.suptitle(label_text(title), fontsize=10, y=1 - 0.06 / height)
    return figure


def _line(axes: Any, points: np.ndarray, look: dict[str, Any]) -> None:
    halo = [withStroke(linewidth=look["lw"] + 1.6, foreground="white", alpha=0.7)]
    axes.plot(*points[:, :2].T, **look, alpha=0.85, solid_capstyle="round", path_effects=halo)


def _crease(pose: Pose, i: int) -> np.ndarray:
    shift = (pose.offsets[i] + pose.offsets[i - 1]) / 2
    return np.array([shift, pose.creases[i] + shift])


def _facet(pose: Pose, f: int) -> np.ndarray:
    """Outline of a facet: apex, arc, apex."""
    apex = pose.offsets[f]
    return np.vstack([apex, pose.arc(f), apex])
