"""Fit a law to a measured hinge, and say what it is worth."""

from __future__ import annotations

import math
from os import PathLike

import numpy as np

from origami_nlp.hinges.result import MUCH, HingeRest, MeasuredHinge
from origami_nlp.numerics import INPUT_TOL, LEVEL
from origami_nlp.pattern import HingeData, LawFit, fit_data, read_hinge_data, runs

NOISY = 0.1
"""Share of the largest torque, from which residuals are noted."""
EMPTY = 0.25
"""Share of the range without a row that is noted."""


def fit_hinge(data: str | PathLike[str] | HingeData) -> MeasuredHinge:
    """Fit a hinge law to measured torques: a cubic spline whose number of knots has the least BIC (Schwarz 1978).

    Parameters
    ----------
    data
        A table of text with the columns angle_deg (or angle_rad), torque_Nm (or torque_Nmm) and, if wanted, weight, in
        the order of the measurement, so that loading and unloading are distinguished; or `HingeData`.

    Returns
    -------
    MeasuredHinge
        The law, its band, wells, where its stiffness is negative, the loop, and what to look at.

    Raises
    ------
    SceneFileError
        If the data cannot be read, or are no torques over fold angles.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> phi = np.linspace(-1.5, 1.5, 61)
    >>> hinge = o.fit_hinge(o.HingeData(phi, phi * (phi**2 - 1)))
    >>> [round(rest.angle, 6) for rest in hinge.rests]
    [-1.0, 1.0]
    """
    found = fit_data(data if isinstance(data, HingeData) else read_hinge_data(data))
    rests = _rests(found)
    return MeasuredHinge(**vars(found), rests=rests, notes=tuple(_notes(found, rests)))


def _rests(found: LawFit) -> tuple[HingeRest, ...]:
    """Return wells, and ends that the hinge is pushed to."""
    law, x = found.law, found.angle
    low, high = law.breaks[0], law.breaks[-1]
    level = LEVEL * float(law.extremes(low, high).max())
    angles = law.rests(low, high)
    held = list(runs(np.abs(found.torque) <= np.abs(found.gap), x))
    step = x[1] - x[0]
    out = []
    for before, angle, after in zip((low, *angles), angles, (*angles[1:], high), strict=False):
        kind = "well" if low < angle < high else "end of the data"
        here = float(law.energy(np.array(angle)))
        here = here if here > level else 0.0
        # the hill to the next well, or all the way to the end
        ways = [way for way in ((before, angle), (angle, after)) if way[0] < way[1]]
        top = min(float(law.extremes(*way).max()) for way in ways) - here
        stiffness = float(law.slope(np.array(angle)))
        known = float(np.interp(angle, x, found.band)) / stiffness if kind == "well" else math.nan
        span = [run for run in held if run[0] <= angle + step and run[1] >= angle - step]
        at = float(angle) if abs(angle) > INPUT_TOL else 0.0
        both = span[0] if span else (float(angle), float(angle))
        out.append(HingeRest(at, known, kind, here, top, stiffness, both))
    return tuple(out)


def _notes(found: LawFit, rests: tuple[HingeRest, ...]) -> list[str]:
    """Say what may be wrong with the data, and what a law cannot have."""
    notes = []
    torque, x = found.torque, found.angle
    if (torque > 0).all() or (torque < 0).all():
        end = math.degrees(x[0] if torque[0] > 0 else x[-1])
        notes.append(f"no rest angle: one sign of torque pushes the hinge to {end:.4g} degrees")
    elif sum(rest.kind != "well" for rest in rests) == 2:
        notes.append(
            "the hinge is pushed to both ends of the data: is the sign of dU/dphi swapped?"
        )
    area, stored = found.loop_area, found.stored
    if area < 0 and not abs(area) <= found.loop_error:
        notes.append("a cycle would give energy: is the sign swapped, or the order of rows?")
    elif area > MUCH * stored:
        share = f"{100 * area / stored:.3g} % of the energy that the law stores"
        notes.append(
            f"a cycle takes {share}: friction or yield, which no energy has, may hold states"
        )
    if found.residual_rms > NOISY * np.abs(torque).max():
        notes.append(f"residuals are above {100 * NOISY:g} % of the largest torque: a noisy rig")
    measured = np.unique(found.data.angle)
    widest = int(np.diff(measured).argmax())
    a, b = measured[[widest, widest + 1]]
    if b - a > EMPTY * np.ptp(x):
        notes.append(
            f"nothing was measured from {math.degrees(a):.4g} to {math.degrees(b):.4g} degrees"
        )
    return notes
