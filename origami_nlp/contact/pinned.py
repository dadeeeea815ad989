"""What holds each minimum in contact: contact moments, stiffness along the contact, load margin."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.contact.margin import load_margin
from origami_nlp.contact.report import ContactReport, PinnedState
from origami_nlp.contact.segments import find_segments
from origami_nlp.errors import OptionError
from origami_nlp.kkt import classify
from origami_nlp.minima import MinimaResult


def find_contacts(
    result: MinimaResult, *, state: int | None = None, segments: bool = False, check: bool = True
) -> ContactReport:
    """Describe what holds each minimum that has closed contacts: moments, stiffness along the contact, load margin.

    Parameters
    ----------
    result
        Of `find_minima`.
    state
        Number (1-based) of the only minimum to report on.
    segments
        Whether to follow the contact boundaries as well (`find_segments`): of vertices.
    check
        Whether to re-solve beside each critical load: of vertices.

    Returns
    -------
    ContactReport
        The states in contact, in order of energy.

    Raises
    ------
    OptionError
        If there is no minimum of that number, or segments of a pattern are asked for.

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
    one = not result.is_pattern
    if segments and not one:
        raise OptionError(
            "segments = True: contact boundaries are followed for one vertex, not a pattern"
        )
    states = []
    for number, minimum in enumerate(result.minima, start=1):
        if not minimum.contacts or state not in (None, number):
            continue
        at = result.state_of(minimum)
        what: Any = minimum if one else classify(at)
        margin = load_margin(at, check=check and one)
        if what.local_dimension == 0:
            why = f"no admissible state nearby, so that no contact can open ({minimum.certificate})"
            margin = replace(margin, status="unbounded", norm=math.inf, reason=why)
        stiffness = what.hessian_eigenvalues if one else what.eigenvalues
        total = at.problem.scale * float(np.sum(at.problem.parameters.stiffness))
        softness = min(stiffness, default=math.inf) / total
        states.append(PinnedState(number, minimum, what.contacts, stiffness, softness, margin))
    found = find_segments(result) if segments else None
    return ContactReport(result, tuple(states), found)
