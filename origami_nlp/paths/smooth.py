"""Curves of events between the points that were computed: as they are drawn, and as they divide a plane."""

from __future__ import annotations

import itertools

import numpy as np

from origami_nlp.numerics import ROUNDED
from origami_nlp.paths.boundary import EventCurve
from origami_nlp.paths.parameter_range import ParameterRange

CORNER = 0.4
"""Turns between points [rad] beyond which a curve has a cusp or a corner there: its own steps turn by less."""
BETWEEN = 12
"""Places between two points."""


def smooth(curve: EventCurve, parameters: tuple[ParameterRange, ParameterRange]) -> np.ndarray:
    """Return a curve of events with places between its points, where cubics join them.

    Parameters
    ----------
    curve
        Of `find_bifurcation_set`.
    parameters
        Both parameters with their ranges.

    Returns
    -------
    numpy.ndarray
        Both parameters as they are followed (logarithms of ratios), shape [m, 2]; its points are among them.

    Examples
    --------
    >>> from origami_nlp.paths import CurvePoint, EventCurve, parse_parameter_range, smooth
    >>> arc = [(0.0, 1.0), (0.3, 0.95), (0.6, 0.8), (0.8, 0.6)]
    >>> points = tuple(CurvePoint(t, (), 0.0, 0.0) for t in arc)
    >>> curve = EventCurve(1, "fold", "", points, ("range", "range"))
    >>> smooth(curve, (parse_parameter_range("torque[1]=0:1"), parse_parameter_range("torque[2]=0:1"))).shape
    (37, 2)
    """
    from scipy.interpolate import CubicSpline

    s = np.array([[o.s_of(t) for o, t in zip(parameters, p.t, strict=True)] for p in curve.points])
    size = np.array([np.ptp(o.ends) for o in parameters])
    apart = np.linalg.norm(np.diff(s / size, axis=0), axis=1)
    s = s[np.append(True, apart > ROUNDED)]
    if len(s) < 3:
        return s
    chords = np.diff(s / size, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    along = chords / lengths[:, None]
    # in shares of the ranges, so that units do not decide what is a corner
    turns = np.arccos(np.clip((along[1:] * along[:-1]).sum(axis=1), -1.0, 1.0))
    cuts = [0, *(np.flatnonzero(turns > CORNER) + 1), len(s) - 1]
    at = np.append(0.0, np.cumsum(lengths))
    out = [s[:1]]
    for a, b in itertools.pairwise(cuts):
        if b - a < 2:
            out.append(s[b : b + 1])
            continue
        places = np.concatenate(
            [np.linspace(at[k], at[k + 1], BETWEEN + 1)[1:] for k in range(a, b)]
        )
        joined = CubicSpline(at[a : b + 1], s[a : b + 1])
        out.append(joined(places))
    return np.concatenate(out)
