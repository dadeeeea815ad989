"""What a minimum may be called: "stable" only where the verdict in the full contact-admissible space is known.

A search finds minima among the states that keep the imposed symmetry.  Without imposed symmetry and with full
contact these are minima of the full contact-admissible space; else a symmetric minimum may be unstable when the
symmetry breaks (of the 43 in the paper's panels, five are), and `minima.full_space` decides.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

from origami_nlp.kkt import OPEN, Escape
from origami_nlp.minima.full_space import MOST_CREASES, MOST_STATES, is_affordable
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.numerics import SHALLOW
from origami_nlp.pattern import Pattern, Scene

ORDER = ("stable", "unstable", "undecided")
NOT_ASKED = "not asked"
SEVERAL = 3
"""Isolated flat foldings from which on they are one line."""


def verdict(origami: Scene | Pattern, minimum: JudgedState) -> str:
    """Return what is known of a minimum in the full space.

    ``stable``, ``unstable`` or ``undecided``; ``not asked`` where nobody did; and empty without imposed symmetry
    and with less than full contact, where the model's own space is all that there is.  A pattern has no symmetry.
    """
    if minimum.full_space is not None:
        return minimum.full_space.verdict
    if is_symmetric(origami):
        return NOT_ASKED
    return "stable" if isinstance(origami, Pattern) or origami.contact == "full" else ""


def is_symmetric(origami: Scene | Pattern) -> bool:
    """Return whether states are asked to keep a symmetry."""
    return isinstance(origami, Scene) and not origami.group.is_trivial


def judged(origami: Scene | Pattern, minimum: JudgedState) -> str | None:
    """Return what is known of a minimum in the full space, as marks of minima show it: None where nobody asked.

    Parameters
    ----------
    origami, minimum
        A scene or a pattern, and one of its minima.

    Returns
    -------
    str or None
        As `verdict`, a key of `show.VERDICTS`.
    """
    known = verdict(origami, minimum)
    return None if known == NOT_ASKED else known


def count_words(origami: Scene | Pattern, minima: Sequence[JudgedState], none: str = "0") -> str:
    """Say how many minima there are, and how many of them are stable, as far as that is known.

    "4 symmetric minima (3 stable, 1 unstable in the full space)", "4 symmetric minima", "2 stable states" or
    "2 minima"; `none` stands for no minimum.  Shallow ones are counted apart: "2 stable states, and 5 shallow ones
    (barrier below 1e-4 of sum k pi^2/2)".
    """
    shallow = sum(m.shallow for m in minima)
    firm = _count_words(origami, [m for m in minima if not m.shallow], none)
    return firm + shallow_words(shallow)


def shallow_words(many: int) -> str:
    """Say how many states are shallow, behind how many are not; empty where none is."""
    if not many:
        return ""
    ones = "ones" if many > 1 else "one"
    return f", and {many} shallow {ones} (barrier below {_power(SHALLOW)} of sum k pi^2/2)"


def _power(value: float) -> str:
    return f"1e{round(math.log10(value))}"


def _count_words(origami: Scene | Pattern, minima: Sequence[JudgedState], none: str) -> str:
    count = len(minima)
    number = str(count) if count else none
    known, free = Counter(verdict(origami, m) for m in minima), not is_symmetric(origami)
    if free and known["stable"] == count and (count or isinstance(origami, Pattern)):
        return f"{number} stable state{'s' * (count != 1)}"
    noun = "minimum" if count == 1 else "minima"
    words = f"{number} {noun}" if free else f"{number} symmetric {noun}"
    if not count or known[NOT_ASKED] or known[""]:
        return words
    parts = [f"{known[v]} {v}" for v in ORDER if known[v]]
    return f"{words} ({', '.join(parts)} in the full space)"


def isolated_foldings(minima: Sequence[JudgedState]) -> list[int]:
    """Return the numbers (1-based) of flat foldings without an admissible neighbour, where these are several.

    The state of least energy is none of them: it has a line of its own.
    Every crease is unfolded or fully folded, and contact alone holds them, whatever the springs are.
    """
    found = [
        number
        for number, m in enumerate(minima, start=1)
        if number > 1
        and m.local_dimension == 0
        and all(min(abs(a), abs(abs(a) - math.pi)) == 0 for a in m.fold_angles)
    ]
    return found if len(found) >= SEVERAL else []


def number_words(numbers: Sequence[int]) -> str:
    """Say "3-5, 8" for 3, 4, 5, 8."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(f"{r[0]}-{r[-1]}" if len(r) > 1 else f"{r[0]}" for r in runs)


def barrier_words(e: Escape | None, unit: str) -> str:
    """Say an escape barrier in a line of a picture's title; empty where there is nothing to say.

    Parameters
    ----------
    e
        The barrier, if it was asked for.
    unit
        Of energy.

    Returns
    -------
    str
        "barrier = 0.0123 J", with a sign for bounds, or that it is not determined.
    """
    if e is None or not e.known:
        return "" if e is None or e.method != OPEN else "barrier not determined"
    words = e.words()
    return f"barrier {words if words[0] == '<' else '= ' + words} {unit}".replace("<=", "\u2264")


def asked(minima: Sequence[JudgedState]) -> bool:
    """Whether the full space was asked about the minima of a symmetric scene."""
    return any(m.full_space is not None for m in minima)


def not_asked_words(origami: Scene | Pattern, minima: Sequence[JudgedState]) -> str:
    """Say that stability is open where it is, else nothing."""
    if not any(verdict(origami, m) == NOT_ASKED for m in minima):
        return ""
    unasked = f"; unasked up to {MOST_CREASES} creases and {MOST_STATES} states"
    few = isinstance(origami, Scene) and is_affordable(origami, len(minima))
    return (
        f"full space: not asked (--full, full=True{'' if few else unasked}): a symmetric minimum may be unstable "
        "when the symmetry breaks"
    )


def imposed_words(origami: Scene | Pattern) -> str:
    """Say that states which break an imposed symmetry are not listed, or what a cell that curls stands for."""
    if isinstance(origami, Pattern) and origami.cell and origami.cell.rolled == (0, 0):
        return (
            "copies curl freely: states of a piece of the sheet, in which contact is with copies within "
            f"{max(origami.cell.copies)[0]} lattice vectors alone"
        )
    if not isinstance(origami, Scene) or not is_symmetric(origami):
        return ""
    return (
        f"states that break the symmetry {origami.group.name} are not listed: --symmetry none, or "
        'symmetry = "none" in the scene, searches for them as well'
    )
