"""The figure of friction at hinges: how far each fold angle of each state reaches."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.display import label_text
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
        Fold angle over crease; the minimum as a dot.

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
        phi = np.degrees(region.minimum.fold_angles)[:MOST_CREASES]
        low, high = (np.degrees(v)[:MOST_CREASES] for v in (region.low, region.high))
        x = np.arange(1, len(phi) + 1)
        axes.bar(x, high - low, bottom=low, width=0.5, color="#c8d5e8", label="first order")
        if region.exact is not None:
            ends = np.degrees([p for p, _ in region.exact])[:, :MOST_CREASES]
            for k, end in enumerate(ends):
                label = "exact" if not k else None
                axes.hlines(end, x - 0.3, x + 0.3, color="#1f4e9c", lw=1.6, label=label)
        axes.plot(x, phi, "o", ms=4, color="#222222", label="minimum")
        axes.set_ylabel(f"state #{region.number}\nfold angle [deg]", fontsize=8)
        axes.set_xticks(x)
        axes.tick_params(labelsize=8)
        axes.grid(True, axis="y", lw=0.3, color="#dddddd")
    rows[0].legend(fontsize=7.5, loc="best")
    rows[-1].set_xlabel("crease")
    most = max(found.torque)
    title = f"{found.label}: held by friction of {most:g} N m at most at each hinge"
    figure.suptitle(label_text(title), fontsize=10)
    return figure
