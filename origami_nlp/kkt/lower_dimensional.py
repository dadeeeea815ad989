"""Sets of states that exist only while several contacts stay exactly closed: the paper's 1-handles.

Where the linearised feasible cone has fewer dimensions than the model has degrees of freedom, a state lies on a thin
set.
"""

from __future__ import annotations

from origami_nlp.kkt.certificates import cone
from origami_nlp.kkt.state import State
from origami_nlp.problem import Contact


def lower_dimensional_at(state: State) -> tuple[Contact, ...]:
    """Return the contacts that all neighbours of a state keep closed, or () where the feasible set is full."""
    contacts = state.contacts
    if len(contacts.base) + len(contacts.branches) < 2:
        return ()  # one smooth contact bounds a full-dimensional set
    z = state.kernel
    common: set[Contact] | None = None
    for rows in state.pieces:
        dimension, _, held = cone(state.on(rows).slopes @ z, rows)
        # a piece of full dimension, or a point
        if dimension == z.shape[1] or dimension == 0:
            return ()
        common = set(held) if common is None else common & set(held)
    return tuple(sorted(common or ()))
