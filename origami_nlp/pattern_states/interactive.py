"""Sheets to be turned in space: states, and the folding motion under a slider."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.display import Content, Keyframe, Poser, Section
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_states.motion import Motion


def pattern_content(
    pattern: Pattern,
    states: Sequence[tuple[str, np.ndarray, Sequence[str]]],
    motion: Motion | None = None,
    pieces: Sequence[Section] = (),
) -> Content:
    """Return states of a sheet, and its motion, as what `display.InteractivePage` shows.

    Parameters
    ----------
    pattern
        The sheet.
    states
        Title, fold angles [n] [rad] and lines to say of each.
    motion
        Of `find_motion`, if there is one.
    pieces
        Tables and lines below.

    Returns
    -------
    Content
        The page's content.
    """
    poser = Poser(pattern)
    stations = tuple(
        Keyframe(
            title, poser.folded(phi, float(pattern.energy(phi))), poser.view(phi), (), tuple(lines)
        )
        for title, phi, lines in states
    )
    content = Content(pattern.name or "pattern", poser.body, stations, pieces=tuple(pieces))
    if motion is None:
        return content
    track = poser.track(
        "folding motion",
        motion.fold_angles,
        motion.energy,
        parameter=motion.arc,
        label="along the motion [rad]",
    )
    return replace(content, tracks=(track,))


def view_motion(motion: Motion) -> Content:
    """Return a folding motion, for a page that can be turned.

    Parameters
    ----------
    motion
        Of `find_motion`.

    Returns
    -------
    Content
        The page's content.
    """
    end = (f"end: {motion.end}", motion.fold_angles[-1], ())
    return pattern_content(motion.pattern, [end], motion, tuple(motion.report_sections()))
