"""What a minimum may be called: "stable" only where the verdict in the full contact-admissible space is known.

A search finds minima among the states that keep the imposed symmetry.  Without imposed symmetry and with full
contact these are minima of the full contact-admissible space; else a symmetric minimum may be unstable when the
symmetry breaks (of the 43 in the paper's panels, five are), and `minima.full_space` decides.
"""

from __future__ import annotations

from origami_nlp.minima.minimum import JudgedState
from origami_nlp.pattern import Origami

NOT_ASKED = "not asked"


def verdict(origami: Origami, minimum: JudgedState) -> str:
    """Return what is known of a minimum in the full space.

    ``stable``, ``unstable`` or ``undecided``; ``not asked`` where nobody did; and empty without imposed symmetry
    and with less than full contact, where the model's own space is all that there is.
    """
    if minimum.full_space is not None:
        return minimum.full_space.verdict
    if origami.is_symmetric:
        return NOT_ASKED
    return "stable" if origami.contact == "full" else ""


def judged(origami: Origami, minimum: JudgedState) -> str | None:
    """Return `verdict` as marks of minima show it, a key of `display.VERDICTS`: None where nobody asked."""
    known = verdict(origami, minimum)
    return None if known == NOT_ASKED else known
