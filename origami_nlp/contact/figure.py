"""A state in three dimensions with its active contacts drawn on it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from origami_nlp.kkt import ContactForce
from origami_nlp.minima import images
from origami_nlp.programme import Model
from origami_nlp.show import Pose, draw_state, pose_state

LOADED, IDLE = "#b5179e", "#6c757d"
"""Contacts that push, and contacts that only touch."""


def draw_contacts(
    model: Model, fold_angles: object, contacts: Sequence[ContactForce], title: str = ""
) -> Figure:
    """Draw a state; creases in contact are thick lines, facets in contact are outlined.

    Magenta contacts push, grey ones carry nothing; images under the symmetry are drawn as well.

    Parameters
    ----------
    model
        Of the scene.
    fold_angles
        Of the state, shape [N] [rad].
    contacts
        Closed there, such as `Minimum.contacts`.
    title
        Above the picture.

    Returns
    -------
    matplotlib.figure.Figure
        The picture.
    """
    phi = np.asarray(fold_angles, dtype=float)
    figure = Figure(figsize=(4.2, 4.4), dpi=100, facecolor="white")
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.88))
    draw_state(axes, model.scene.vertex, phi)
    pose = pose_state(model.scene.vertex, phi)
    lowest = float((pose.creases + pose.offsets)[:, 1].min(initial=0.0))
    axes.set_ylim(bottom=max(axes.get_ylim()[0], lowest - 0.25))  # nothing is drawn below
    for contact in contacts:
        colour = LOADED if contact.multiplier_range[1] > 0 else IDLE
        creases, facets = images(model, contact)
        for c in creases:
            _line(axes, _crease(pose, c - 1), colour, 4.0)
        for f in facets:
            _line(axes, _facet(pose, f - 1), colour, 2.4)
    if title:
        figure.suptitle(title, fontsize=10)
    return figure


def _line(axes, points: np.ndarray, colour: str, width: float) -> None:  # type: ignore[no-untyped-def]
    axes.plot(
        points[:, 0],
        points[:, 1],
        color=colour,
        lw=width,
        alpha=0.85,
        solid_capstyle="round",
        path_effects=[withStroke(linewidth=width + 1.6, foreground="white", alpha=0.7)],
    )


def _crease(pose: Pose, i: int) -> np.ndarray:
    shift = (pose.offsets[i] + pose.offsets[i - 1]) / 2
    return np.array([shift, pose.creases[i] + shift])


def _facet(pose: Pose, f: int) -> np.ndarray:
    """Outline of a facet: apex, arc, apex."""
    a, b = pose.creases[f], pose.creases[(f + 1) % len(pose.creases)]
    angle = math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
    t = np.linspace(0, 1, 24)[:, None]
    arc = (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / math.sin(angle)
    return np.vstack([np.zeros(3), arc, np.zeros(3)]) + pose.offsets[f]
