"""Stiffness by symmetry block: how stiff a state is against motions that break the symmetry that a search kept."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from origami_nlp.kkt import State, Stratum
from origami_nlp.minima import permutations, symmetry_blocks
from origami_nlp.numerics import BALANCED
from origami_nlp.problem import Contact


def breaking_stiffnesses(
    state: State, symmetric: Any, contacts: tuple[Contact, ...] | None = None
) -> tuple[float, ...]:
    """Return the stiffnesses of a state against motions that break the symmetry of another problem.

    Parameters
    ----------
    state
        Of all N fold angles, in equilibrium.
    symmetric
        The problem whose symmetry the state keeps.
    contacts
        Those closed at the state, where they are known; the state looks for them otherwise.

    Returns
    -------
    tuple of float
        Rising eigenvalues of the Hessian on directions that keep closure and loaded contacts and have no symmetric
        part [N m/rad]; none where there is no such direction, nan alone where the state has no one Hessian.
    """
    held = _loaded(state, contacts)
    if held is None:
        return (math.nan,)
    return symmetry_blocks(
        permutations(symmetric), held.tangent, held.hessian, state.problem.scale
    )[1]


def _loaded(state: State, contacts: tuple[Contact, ...] | None) -> Stratum | None:
    """Return a state with its loaded contacts held, None where it has no one Hessian."""
    if not state.regular or (contacts is None and len(state.pieces) > 1):
        return None
    piece = state.on(state.pieces[0] if contacts is None else contacts)
    mu = piece.multiplier_set
    if mu.residual > BALANCED * (1 + np.abs(state.gradient).max()) or not mu.unique:
        return None
    rows = zip(piece.contacts, mu.smallest, strict=True)
    return state.on([c for c, m in rows if m > BALANCED])
