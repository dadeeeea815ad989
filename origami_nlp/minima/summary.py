"""What people read first of a list of minima: how many are stable, a line each, and which are images of others."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from origami_nlp.display import Cell, Table, Words
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.kkt import OPEN, ContactForce
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.completeness import Completeness
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import (
    NOT_ASKED,
    is_symmetric,
    isolated_foldings,
    number_words,
    shallow_words,
    verdict,
)
from origami_nlp.numerics import BESIDE_SINGULAR, DUPLICATE_TOL, ROUNDED
from origami_nlp.pattern import Pattern, Scene, symmetries
from origami_nlp.search import CLOSES_NOT

MOST_LINES = 30
"""States of which the report has a line; the others are in its details."""
MOST_NAMES = 6
"""Creases, or pairs of facets, that a cell names."""
STYLE = {"stable": "green", "unstable": "red", "not decided": "bold"}


def energy_words(energy: float, scale: float, digits: int = 6) -> str:
    """Return an energy as it is printed: 0 where it is rounding of the energy that it takes to fold the springs.

    Soft springs beside stiff ones (up to 1e8) hold far less than these, and are no rounding.
    """
    return f"{energy if abs(energy) > ROUNDED * scale else 0.0:.{digits}g}"


def energy_unit(origami: Scene | Pattern) -> float:
    """Return the energy [J] whose rounding is not printed: of springs that turn by 1 rad, of laws within the limits."""
    mean, laws = float(np.mean(origami.stiffness)), origami.laws
    each = zip(laws, *origami.limit_angles, strict=True) if laws else ()
    return max(mean, sum(float(law.extremes(*at).max()) for law, *at in each if law is not None))


# ---------------------------------------------------------------- images


def find_images(
    origami: Scene | Pattern, minima: Sequence[JudgedState]
) -> dict[int, tuple[int, str]]:
    """Return which minima are images of earlier ones under a symmetry of the creases and their springs.

    Parameters
    ----------
    origami, minima
        A scene or a pattern, and its minima.

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
    for move, words in _symmetries(origami):
        moved = move(phi)
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


def _symmetries(
    origami: Scene | Pattern,
) -> Iterator[tuple[Callable[[np.ndarray], np.ndarray], str]]:
    if isinstance(origami, Pattern):
        from origami_nlp.pattern_problem import find_labels, image

        for to in find_labels(origami).symmetries(origami):
            yield lambda phi, to=to: image(to, phi), "image"  # type: ignore[misc]
        return
    # where a state has a symmetry itself several take it there: the plainest one is named
    for one in sorted(symmetries(origami), key=lambda g: (g.over, g.backward, g.start)):
        words = "mirror image" if one.backward else "rotated copy" if one.start else "copy"
        yield one.back, words + ", turned over," * one.over


# ---------------------------------------------------------------- words


def verdict_words(
    origami: Scene | Pattern,
    minima: Sequence[JudgedState],
    completeness: Completeness | None,
    search: SearchReport,
) -> str:
    """Say how many states are stable, under which assumptions, and whether the list is complete."""
    firm = [m for m in minima if not m.shallow]
    known = Counter(verdict(origami, m) for m in firm)
    parts = []
    if known["stable"] or not firm:
        why = "" if minima else _why_none(completeness, search)
        count = f"{known['stable']} stable state{'s' * (known['stable'] != 1)}"
        if completeness and completeness.status == "proved" and not minima and not search.undecided:
            # of what is bounded and closed one state has least energy
            count = "no stable state, as no state closes within all limits and contacts"
        if search.undecided and (near := _least_beside_flat(origami)) and not minima:
            parts.append(
                "not decided how many stable states there are: those of least energy have all fold angles within "
                f"{near:.2g} rad of 0, where closure is the same to rounding"
            )
        else:
            parts.append(f"not decided whether there is a stable state: {why}" if why else count)
    if n := known["unstable"]:
        verb = "is" if n == 1 else "are"
        its = "its" if n == 1 else "their"
        parts.append(
            f"{n} {'more ' * bool(parts)}that {verb} stable only while {its} symmetry is kept"
        )
    if n := known["undecided"]:
        parts.append(f"{n} {'more ' * bool(parts)}not decided without the symmetry")
    if n := known[NOT_ASKED]:
        parts.append(f"{n} symmetric minim{'um' if n == 1 else 'a'}")
    if n := known[""]:
        parts.append(f"{n} minim{'um' if n == 1 else 'a'}")
    notes = [*_assumed(origami, search), _complete(completeness, search)]
    return f"{'; '.join(parts)}{shallow_words(len(minima) - len(firm))} ({', '.join(notes)})"


def _least_beside_flat(origami: Scene | Pattern) -> float:
    """Return a bound of all fold angles [rad] of states of least energy where it is so small that closure says nothing.

    0 where it is not.  The flat state closes, so that no state of least energy has more than its energy U, and none of
    its springs is wound by more than sqrt(2 U / k).
    """
    flat = origami.is_flat if isinstance(origami, Pattern) else origami.vertex.flat
    loaded = origami.laws or getattr(origami, "preload", ()) or getattr(origami, "loads", ())
    low, high = origami.limit_angles
    if not flat or loaded or (low > 0).any() or (high < 0).any():
        return 0.0
    rest = origami.rest if isinstance(origami, Pattern) else origami.rest_angles
    k, rest = np.array(origami.stiffness), np.abs(rest)
    bound = float((rest + np.sqrt((k * rest**2).sum() / k)).max())
    return bound if bound <= BESIDE_SINGULAR else 0.0


def _why_none(completeness: Completeness | None, search: SearchReport) -> str:
    """Say what kept a search that found no minimum from deciding that there is none, if anything did."""
    if completeness and completeness.proved:
        return ""
    if n := len(search.undecided):
        return f"{n} state{'s'[: n > 1]} found, none certified"
    crossed = any(s.crossings for s in search.rejected)
    gave_up = [why for why in search.stopped if why != CLOSES_NOT]
    late = search.stopped_by == "time" or bool(search.left_out)
    if not gave_up and not late:
        return ""
    found = "facets cross in all that was found" if crossed else "none was found"
    why = "interrupted" if search.interrupted else OUT_OF_TIME
    return "; ".join((found, *gave_up, *[why] * late))


def _assumed(origami: Scene | Pattern, search: SearchReport) -> Iterator[str]:
    if is_symmetric(origami):
        yield f"symmetry {origami.group.name} kept"  # type: ignore[union-attr]
    yield {
        "full": "contact on",
        "none": "contact off: facets may cross",
        "fold-limits": "fold limits only: facets may cross",
    }[search.contact]


def _complete(completeness: Completeness | None, search: SearchReport) -> str:
    status = completeness.status if completeness else ""
    if status == "proved":
        return "list proved complete"
    if status == "proved-except-singular":
        return "list proved complete but for singular states"
    if not search.is_open:
        return "completeness not proved"
    new = search.new_per_thousand
    return f"open: {new:.3g} new ones a thousand starts at the end" if new else "open"


def held_words(m: JudgedState) -> str:
    """Say what holds a state: its springs, or contacts with their moments, those that must push to balance it."""
    if m.local_dimension == 0:
        return "geometry: isolated"
    if not m.contacts:
        return "springs"
    contacts = sorted(m.contacts, key=lambda c: (not c.is_limit, sorted(c.facets)))
    pushing = [c for c in contacts if c.multiplier_range[0] > 0]
    loaded = [c for c in pushing if c.unique]
    open_ = [c for c in contacts if not c.unique]
    idle = [c for c in contacts if c.unique and c not in pushing]
    parts: list[str] = ["springs"] * (not loaded and not open_)
    parts += [f"{_who([c])}: {c.multiplier:.3g} {_unit(c)}" for c in loaded[:MOST_NAMES]]
    if len(loaded) > MOST_NAMES:
        parts.append(f"{len(loaded) - MOST_NAMES} more contacts")
    if open_:
        least = [c for c in open_ if c in pushing]
        some = [
            f"{_who([c])}: >= {c.multiplier_range[0]:.3g} {_unit(c)}" for c in least[:MOST_NAMES]
        ]
        if rest := [c for c in open_ if c not in least[:MOST_NAMES]]:
            some.append(_who(rest))
        parts.append(f"{'; '.join(some)} (statically indeterminate)")
    kinds = (("fully folded", True, False), ("at a stop", True, True), ("touching", False, False))
    for word, limit, stop in kinds:
        if same := [c for c in idle if (c.is_limit, c.is_stop) == (limit, stop)]:
            parts.append(f"{_who(same, named=False)} {word}, no load")
    return "; ".join(parts)


def _unit(c: ContactForce) -> str:
    return "N m/length" if c.is_force else "N m"


def _who(contacts: Sequence[ContactForce], named: bool = True) -> str:
    """Name creases at fold limits and at stops, and facets that touch, 1-based, the smaller numbers first."""
    touching = [c for c in contacts if not c.is_limit]
    pairs = sorted({tuple(sorted(c.facets)) for c in touching if c.corners})
    faces = [c for c in sorted(touching, key=lambda c: sorted(c.facets)) if not c.corners]
    facets = [f"facets {a}|{b}" for a, b in pairs]
    facets += [c.text.partition(" (")[0].removesuffix(" at") for c in faces]
    parts = []
    for word, stop in (("fold limit", False), ("stop", True)):
        at = sorted({k for c in contacts if c.is_limit and c.is_stop == stop for k in c.creases})
        if at:
            parts.append(f"{word if named else 'crease'}{'s' * (len(at) > 1)} {_few(at)}")
    if facets:
        parts.append(_few(list(dict.fromkeys(facets))))
    return ", ".join(parts)


def _few(names: Sequence[object]) -> str:
    more = len(names) - MOST_NAMES
    return ", ".join(map(str, names[:MOST_NAMES])) + (f" and {more} more" if more > 0 else "")


def _stability(origami: Scene | Pattern, m: JudgedState) -> Words:
    known = verdict(origami, m)
    word = {"undecided": "not decided", "": "minimum", "unstable": "unstable (asymmetric)"}
    said = word.get(known, known) + ", shallow" * m.shallow
    return Words(said, STYLE.get(known if known in STYLE else said, ""))


def _barrier(m: JudgedState, scale: float) -> str:
    full = m.full_space
    if full is not None and full.verdict == "unstable":
        ends = full.lands_on
        return f"falls to {energy_words(ends.energy, scale, 4)}" if ends else "none"
    if m.escape is None:
        return "-"
    return "not known" if m.escape.method == OPEN else m.escape.words()


def _stable_first(
    origami: Scene | Pattern, minima: Sequence[JudgedState]
) -> list[tuple[int, JudgedState]]:
    """Return states with their numbers, stable ones first, then those that are not, then shallow ones."""
    ranks = [m.shallow + (verdict(origami, m) == "unstable") for m in minima]
    return sorted(enumerate(minima, start=1), key=lambda one: (ranks[one[0] - 1], one[0]))


def summary_table(
    origami: Scene | Pattern,
    minima: Sequence[JudgedState],
    images: Mapping[int, tuple[int, str]],
    title: str,
    scale: float,
) -> Table:
    """Return a line a state, isolated flat foldings together in one.

    Parameters
    ----------
    origami, minima
        A scene or a pattern, and its minima.
    images
        Those that are images of others (`find_images`).
    title
        Of the table.
    scale
        Mean stiffness, of which rounding of energies is a share.

    Returns
    -------
    Table
        In order of energy, states that are not stable or shallow last.
    """
    grouped = isolated_foldings(minima)
    kept = f"{origami.group.name} " if is_symmetric(origami) else ""  # type: ignore[union-attr]
    heads = ["#", "energy [J]", "stability", "held by"]
    heads.append("softest mode\n[N m/rad]")
    heads.append(f"{kept}escape\nbarrier [J]")
    noise = any(m.survival is not None for m in minima)
    blank: list[Cell] = ["", ""]
    rows: list[list[Cell]] = []
    for number, m in _stable_first(origami, minima):
        if number in grouped:
            continue
        own: list[Cell] = [str(number), energy_words(m.energy, scale)]
        survives: list[Cell] = [str(m.survival)] * noise
        if number in images:
            rows.append([*own, _stability(origami, m), images[number][1], *blank, *survives])
            continue
        softest = "-" if math.isinf(m.softest) else f"{m.softest:.3g}"
        row: list[Cell] = [_stability(origami, m), held_words(m), softest]
        row.append(_barrier(m, scale))
        rows.append([*own, *row, *survives])
    if grouped:
        some = [minima[k - 1] for k in grouped]
        low, high = (energy_words(m.energy, scale, 4) for m in (some[0], some[-1]))
        words = f"geometry: isolated flat foldings {number_words(grouped)}"
        known = Counter(verdict(origami, m) for m in some)
        said = _stability(origami, some[0]) if len(known) == 1 else Words("see details")
        most = max((m.survival.kept for m in some if m.survival), default=0)
        many: list[Cell] = [f"({len(some)})", f"{low} to {high}"]
        rows.append([*many, said, words, "-", "isolated"])
        rows[-1] += [f"{most} at most"] * noise
    if noise:
        heads.append("survives")
    columns = "rrLLrR" + "r" * noise
    return Table(heads, rows, title, columns, framed=False, narrow=True)
