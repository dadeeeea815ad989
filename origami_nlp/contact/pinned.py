"""What holds each minimum in contact: contact moments, stiffness along the contact, load margin."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.contact.margin import load_margin
from origami_nlp.contact.report import ContactReport, PinnedState
from origami_nlp.contact.segments import find_segments
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult


def find_contacts(
    result: MinimaResult, *, state: int | None = None, segments: bool = False, check: bool = True
) -> ContactReport:
    """Say what holds each minimum that has closed contacts: moments, stiffness along the contact, load margin.

    Parameters
    ----------
    result
        Of `find_minima`.
    state
        Number (1-based) of the only minimum to report on.
    segments
        Whether to follow the contact boundaries as well (`find_segments`).
    check
        Whether to re-solve beside each critical load.

    Returns
    -------
    ContactReport
        The states in contact, in order of energy.

    Raises
    ------
    OptionError
        If there is no minimum of that number.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> report = o.find_contacts(result, check=False)
    >>> [(s.number, s.margin.status) for s in report.states]
    [(2, 'zero')]
    """
    count = len(result.minima)
    if state is not None and not 1 <= state <= count:
        raise OptionError(f"state = {state} must be the number of a minimum, 1 to {count}")
    total = sum(result.scene.stiffness)
    states = []
    for number, minimum in enumerate(result.minima, start=1):
        if not minimum.contacts or state not in (None, number):
            continue
        model = result.model_of(minimum)
        margin = load_margin(State(model, model.reduce(np.array(minimum.fold_angles))), check=check)
        if minimum.local_dimension == 0:
            why = f"no admissible state nearby, so that no contact can open ({minimum.certificate})"
            margin = replace(margin, status="unbounded", norm=math.inf, reason=why)
        stiffness = minimum.hessian_eigenvalues
        softness = min(stiffness, default=float("inf")) / total
        states.append(PinnedState(number, minimum, stiffness, softness, margin))
    return ContactReport(result, tuple(states), find_segments(result) if segments else None)
