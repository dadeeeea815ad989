"""Figures of friction: how far each fold angle of each state reaches; a state that facets hold by friction."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.display import contact_legend, draw_pattern_state, label_text
from origami_nlp.friction.coulomb import CoulombHold
from origami_nlp.friction.result import Friction

MOST_STATES, MOST_CREASES = 6, 24
"""Drawn at most."""


def draw_friction(found: Friction) -> Figure:
    """Draw the fold angles that friction leaves open, a row a state: first order as bars, exact ends as lines.

    Parameters
    ----------
    found
        Of `find_friction`.

    Returns
    -------
    matplotlib.figure.Figure
        Change of the fold angle from the minimum, over creases.

    Raises
    ------
    OptionError
        If `found` is not of its type.
    """
    check_type("found", found, Friction)
    shown = [r for r in found.regions if not r.why][:MOST_STATES]
    figure = Figure(figsize=(7.0, 0.9 + 1.9 * max(len(shown), 1)), layout="constrained", dpi=110)
    rows = figure.subplots(max(len(shown), 1), 1, squeeze=False)[:, 0]
    for axes, region in zip(rows, shown, strict=False):
        phi = np.degrees(region.minimum.fold_angles)
        low, high = (np.degrees(v) - phi for v in (region.low, region.high))
        x = np.arange(1, min(len(phi), MOST_CREASES) + 1)
        n = len(x)
        axes.bar(
            x, (high - low)[:n], bottom=low[:n], width=0.5, color="#c8d5e8", label="first order"
        )
        for k, (end, _) in enumerate(region.exact or ()):
            y = (np.degrees(end) - phi)[:n]
            axes.hlines(
                y, x - 0.3, x + 0.3, color="#1f4e9c", lw=1.6, label="exact" if not k else None
            )
        axes.axhline(0.0, color="#222222", lw=0.8)
        axes.set_ylabel(f"state #{region.number}\nchange [deg]", fontsize=8)
        axes.set_xticks(x, [f"{i}\n{v:.1f}" for i, v in zip(x, phi.round(1) + 0.0, strict=False)])
        axes.tick_params(labelsize=8)
        axes.grid(True, axis="y", lw=0.3, color="#dddddd")
    rows[0].legend(fontsize=7.5, loc="best")
    rows[-1].set_xlabel("crease, and its fold angle at the minimum [deg]")
    most = max(found.torque)
    title = f"{found.label}: held by friction of {most:g} N m at most at each hinge"
    figure.suptitle(label_text(title), fontsize=10)
    return figure


def draw_coulomb(hold: CoulombHold) -> Figure:
    """Draw the state, with the places where facets touch and what holds it.

    Parameters
    ----------
    hold
        Of `least_coulomb`.

    Returns
    -------
    matplotlib.figure.Figure
        The folded sheet.

    Raises
    ------
    OptionError
        If `hold` is not of its type.
    """
    check_type("hold", hold, CoulombHold)
    figure = Figure(figsize=(5.2, 4.6), layout="constrained", dpi=110)
    axes = figure.subplots()
    draw_pattern_state(axes, hold.pattern, np.array(hold.fold_angles), contacts=hold.contacts)
    if marks := contact_legend(hold.contacts):
        figure.legend(handles=marks, loc="outside lower center", ncols=2, fontsize=8, frameon=False)
    figure.suptitle(label_text(f"{hold.pattern.title}:\n{hold.verdict}"), fontsize=9)
    return figure
