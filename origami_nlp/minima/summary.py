"""What people read first of a list of minima: how many are stable, and which are images of others."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.completeness import Completeness
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import verdict
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL, SHALLOW
from origami_nlp.pattern import Origami
from origami_nlp.pattern_problem import PaperSymmetry, PatternProblem, image
from origami_nlp.search import CLOSES_NOT

LEAST = f"{SHALLOW:.0e}".replace("e-0", "e-")
ASSUMED = {
    "full": "contact on",
    "none": "contact off: facets may cross",
    "fold-limits": "fold limits only: facets may cross",
}
PROVED = {
    "proved": "list proved complete",
    "proved-except-singular": "list proved complete but for singular states",
}

COUNTED = (
    ("stable", "stable state", "stable states"),
    ("unstable", *("stable only while the symmetry is kept",) * 2),
    ("undecided", *("not decided without the symmetry",) * 2),
    ("not asked", "symmetric minimum", "symmetric minima"),
    ("", "minimum", "minima"),
)
"""How minima are called by their verdict, one of them and several."""


def find_images(
    origami: Origami, problem: PatternProblem, minima: Sequence[JudgedState]
) -> dict[int, tuple[int, str]]:
    """Return which minima are images of earlier ones under a symmetry of the creases and their springs.

    Parameters
    ----------
    origami, problem, minima
        What is folded, posed, and its minima.

    Returns
    -------
    dict
        By number (from 1) the number of the earlier state and words such as "mirror image of 3": fold angles that agree
        within `DUPLICATE_TOL`, and equal verdicts.
    """
    if len(minima) < 2:
        return {}
    phi = np.array([m.fold_angles for m in minima])
    found: dict[int, tuple[int, str]] = {}
    x = problem.reduce(phi)
    # where a state has a symmetry itself several take it there: the plainest one is named
    for move in sorted(problem.labels.symmetries, key=lambda s: (s.sign < 0, s.mirrored)):
        words, moved = _words(move), problem.expand(image(move, x))
        for k, there in enumerate(moved):
            if k + 1 in found:
                continue
            # one that is an image itself is listed through the first of its orbit
            for j in map(int, np.flatnonzero(np.abs(phi - there).max(axis=1) <= DUPLICATE_TOL)):
                one, other = minima[k], minima[j]
                known = (verdict(origami, one), one.winding, one.kind)
                same = known == (verdict(origami, other), other.winding, other.kind)
                if j > k and same and j + 1 not in found:
                    found[j + 1] = (k + 1, words)
    return {number: _first(found, number) for number in found}


def _first(found: dict[int, tuple[int, str]], number: int) -> tuple[int, str]:
    """Return the first state of an orbit, with the symmetry's name where it takes that one there itself."""
    first, words = found[number]
    direct = first not in found
    while first in found:
        first = found[first][0]
    return first, f"{words if direct else 'image'} of {first}"


def _words(symmetry: PaperSymmetry) -> str:
    moves = (symmetry.to != np.arange(len(symmetry.to))).any()
    words = "mirror image" if symmetry.mirrored else "rotated copy" if moves else "copy"
    return words + ", turned over," * (symmetry.sign < 0)


# ---------------------------------------------------------------- words


def verdict_words(
    origami: Origami,
    minima: Sequence[JudgedState],
    completeness: Completeness | None,
    search: SearchReport,
) -> str:
    """Say how many states are stable, under which assumptions, and whether the list is complete."""
    known = Counter("shallow" if m.shallow else verdict(origami, m) for m in minima)
    shallow, status = known.pop("shallow", 0), completeness.status if completeness else ""
    parts = list[str]()
    for key, one, more in COUNTED:
        if n := known[key]:
            another = "more " * (bool(parts) and one == more)
            parts.append(f"{n} {another}{one if n == 1 else more}")
    if not minima:
        parts.append(_none_words(origami, completeness, search))
    if shallow:
        ones = ("state" if not parts else "one") + "s" * (shallow > 1)
        parts.append(f"{shallow} shallow {ones} (barrier below {LEAST} of sum k pi^2/2)")
        parts[-2:] = [", and ".join(parts[-2:])]
    notes = [f"symmetry {origami.group.name} kept"] if origami.is_symmetric else []
    notes += [ASSUMED[search.contact], PROVED.get(status) or search.open_words]
    return f"{'; '.join(parts)} ({', '.join(notes)})"


def _none_words(origami: Origami, completeness: Completeness | None, search: SearchReport) -> str:
    """Say that there is no stable state, or why that is not decided."""
    if completeness and completeness.proved and not search.undecided:
        # of what is bounded and closed one state has least energy
        return "no stable state, as no state closes within all limits and contacts"
    if search.undecided and (near := _least_beside_flat(origami)):
        return (
            "not decided how many stable states there are: those of least energy have all fold angles within "
            f"{near:.2g} rad of 0, where closure is the same to rounding"
        )
    late = search.stopped_by == "time" or bool(search.left_out)
    why = [reason for reason in search.stopped if reason != CLOSES_NOT]
    why += ["interrupted" if search.interrupted else OUT_OF_TIME] * late
    if n := len(search.undecided):
        why = [f"{n} state{'s' * (n != 1)} found, none certified"]
    elif why:
        crossed = any(s.crossings for s in search.rejected)
        why.insert(0, "facets cross in all that was found" if crossed else "none was found")
    if not why or (completeness and completeness.proved):
        return "0 stable states"
    return f"not decided whether there is a stable state: {'; '.join(why)}"


def _least_beside_flat(origami: Origami) -> float:
    """Return a bound of all fold angles [rad] of states of least energy where it is so small that closure says nothing.

    0 where it is not.  The flat state closes, so that no state of least energy has more than its energy U, and none of
    its springs is wound by more than sqrt(2 U / k).
    """
    loaded = origami.laws or origami.preload or origami.loads
    low, high = origami.limit_angles
    if not origami.is_flat or loaded or (low > 0).any() or (high < 0).any():
        return 0.0
    k, rest = np.array(origami.stiffness), np.abs(origami.rest)
    bound = float((rest + np.sqrt((k * rest**2).sum() / k)).max())
    return bound if bound <= BESIDE_SINGULAR else 0.0
