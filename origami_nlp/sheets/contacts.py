"""Contacts that are closed at a state, as rows of limits and gaps: what a descent into contact holds."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.facets import Choice, Placed, Sheet, choices, touches_at
from origami_nlp.numerics import OUTSIDE
from origami_nlp.sheets.rows import Rows


def closed_contacts(sheet: Sheet, phi: np.ndarray, touching: bool = True) -> Rows:
    """Return the fold limits and gaps that are closed at a state.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state, [n] [rad].
    touching
        Whether features of facets are looked at.

    Returns
    -------
    Rows
        Gaps of features that meet inside each other; those that fold limits keep open are left to them.
    """
    limits = np.flatnonzero(np.abs(np.abs(phi) - math.pi) <= OUTSIDE)
    return Rows.at(sheet, phi, limits, touches_at(sheet, phi, limits) if touching else [])


def closed_choices(sheet: Sheet, phi: np.ndarray) -> list[Choice]:
    """Return what keeps facets apart that meet at borders: of each choice one gap at least stays open.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state in which no facets cross, [n] [rad].

    Returns
    -------
    list of tuple of Touch
        Without those that have a gap which is closed on every piece anyway.
    """
    return choices(sheet.features, Placed(sheet.crossings.poses, phi))
