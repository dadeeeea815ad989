"""What a minimum may be called: "stable" only where the verdict in the full contact-admissible space is known.

A search finds minima among the states that keep the imposed symmetry.  Without imposed symmetry and with full
contact these are minima of the full contact-admissible space; else a symmetric minimum may be unstable when the
symmetry breaks (of the 43 in the paper's panels, five are), and `minima.full_space` decides.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from origami_nlp.minima.minimum import Minimum
from origami_nlp.pattern import Scene

ORDER = ("stable", "unstable", "undecided")
NOT_ASKED = "not asked"


def verdict(scene: Scene, minimum: Minimum) -> str:
    """Return what is known of a minimum in the full space.

    ``stable``, ``unstable`` or ``undecided``; ``not asked`` where nobody did; and empty without imposed symmetry
    and with less than full contact, where the model's own space is all that there is.
    """
    if minimum.full_space is not None:
        return minimum.full_space.verdict
    if not scene.group.is_trivial:
        return NOT_ASKED
    return "stable" if scene.contact == "full" else ""


def count_words(scene: Scene, minima: Sequence[Minimum], none: str = "0") -> str:
    """Say how many minima there are, and how many of them are stable, as far as that is known.

    "4 symmetric minima (3 stable, 1 unstable in the full space)", "4 symmetric minima", "2 stable states" or
    "2 minima"; `none` stands for no minimum.
    """
    count = len(minima)
    number = str(count) if count else none
    known = Counter(verdict(scene, m) for m in minima)
    if scene.group.is_trivial and count and known["stable"] == count:
        return f"{number} stable state{'s' * (count != 1)}"
    noun = "minimum" if count == 1 else "minima"
    words = f"{number} {noun}" if scene.group.is_trivial else f"{number} symmetric {noun}"
    if not count or known[NOT_ASKED] or known[""]:
        return words
    parts = [f"{known[v]} {v}" for v in ORDER if known[v]]
    return f"{words} ({', '.join(parts)} in the full space)"


def asked(minima: Sequence[Minimum]) -> bool:
    """Whether the full space was asked about the minima of a symmetric scene."""
    return any(m.full_space is not None for m in minima)


def not_asked_words(scene: Scene, minima: Sequence[Minimum]) -> str:
    """Say that stability is open where it is, else nothing."""
    if not any(verdict(scene, m) == NOT_ASKED for m in minima):
        return ""
    return (
        "full space: not asked (--full, full=True): a symmetric minimum may be unstable when the "
        "symmetry breaks"
    )
