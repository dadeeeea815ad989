"""The states of a list, a record each: what tables, frames, CSV and the captions of pictures are made from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from origami_nlp.display import Table, record_table, shown
from origami_nlp.escapes import OPEN
from origami_nlp.kkt import ContactForce
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import verdict
from origami_nlp.numerics import ROUNDED, residual_words
from origami_nlp.pattern import Origami

MOST_NAMES = 6
"""Creases, or pairs of facets, that a cell names."""
LISTED = "number", "energy", "stability", "held", "softest", "escape", "survival"
CERTIFIED = "number", "energy", "kind", "dimension", "closure", "kkt", "hits"
"""Columns of the two tables of a report."""
STABILITY = {"stable": "green", "unstable (asymmetric)": "red", "not decided": "bold"}
KINDS = {
    "interior": "green",
    "contact-pinned": "yellow",
    "contact-touching": "cyan",
    "degenerate": "magenta",
}
"""Their styles on a screen."""


@dataclass(frozen=True)
class StateRow:
    """A minimum as it is listed.

    Attributes
    ----------
    scene
        Name of what is folded.
    number
        Of the minimum, from 1.
    energy, kind, dimension, closure, kkt, hits
        As of `JudgedState`.
    stable
        Whether it is one of `MinimaResult.stable`.
    full_space
        Verdict of it (`stability.verdict`).
    stability, held, escape
        In words: how it is judged, what holds it, what it takes to leave it.
    image
        Of which state it is an image under a symmetry of the creases with their springs; else empty.
    softest
        Smallest stiffness.
    barrier, barrier_method, shallow
        Of its `Escape`.
    survival
        Draws of errors that it survives.
    unit
        Energies [J] that are rounding of this are printed as 0, see `energy_unit`.
    """

    scene: str = field(metadata=shown())
    number: int = field(metadata=shown("#"))
    energy: float = field(metadata=shown("energy", "J", ".6g"))
    kind: str = field(metadata=shown("kind", styles=KINDS))
    dimension: int = field(metadata=shown("dimension"))
    closure: float = field(metadata=shown("closure", spec=residual_words))
    kkt: float = field(metadata=shown("KKT", spec=residual_words))
    hits: int = field(metadata=shown("hits"))
    stable: bool = field(metadata=shown())
    full_space: str = field(metadata=shown())
    stability: str = field(metadata=shown("stability", styles=STABILITY))
    held: str = field(metadata=shown("held by"))
    image: str = field(metadata=shown())
    softest: float | None = field(
        metadata=shown("softest mode\n", "N m/rad", ".3g", missing="", side="r")
    )
    escape: str = field(metadata=shown("escape\nbarrier", "J", side="R"))
    barrier: float | None = field(metadata=shown("", "J"))
    barrier_method: str | None = field(metadata=shown())
    shallow: bool = field(metadata=shown())
    survival: str | None = field(metadata=shown("survives", side="r"))
    unit: float = field(repr=False)

    def listed(self) -> StateRow:
        """Return it as it is printed: without energy that is rounding, and of an image whose image it is."""
        row = replace(self, energy=rounded(self.energy, self.unit))
        if not self.image:
            return row
        return replace(row, held=self.image, softest=None, escape="")

    def caption(self) -> str:
        """Return three lines of a picture: number, energy and verdict; kind; what it takes to leave it."""
        row = self.listed()
        kind = ", ".join(filter(None, (row.kind, row.image)))
        said = f"{row.number}:  U = {row.energy:.4g} J, {row.stability}\n{kind}"
        bound = row.escape.startswith("<")
        digits = bound or row.escape[:1].isdigit()
        leave = f"barrier {'' if bound else '= '}{row.escape} J".replace("<=", "\u2264")
        return f"{said}\n{leave}" if digits else said


def rounded(energy: float, scale: float) -> float:
    """Return an energy, or 0 where it is rounding of the energy that it takes to fold the springs.

    Soft springs beside stiff ones (up to 1e8) hold far less than these, and are no rounding.
    """
    return energy if abs(energy) > ROUNDED * scale else 0.0


def energy_unit(origami: Origami) -> float:
    """Return the energy [J] whose rounding is not printed: of springs that turn by 1 rad, of laws within the limits."""
    mean, laws = float(np.mean(origami.stiffness)), origami.laws
    each = zip(laws, *origami.limit_angles, strict=True) if laws else ()
    return max(mean, sum(float(law.extremes(*at).max()) for law, *at in each if law is not None))


def state_rows(
    origami: Origami,
    name: str,
    minima: Sequence[JudgedState],
    images: Mapping[int, tuple[int, str]],
) -> tuple[StateRow, ...]:
    """Return the minima as they are listed, in order of energy."""
    words = {"undecided": "not decided", "": "minimum", "unstable": "unstable (asymmetric)"}
    rows, unit = [], energy_unit(origami)
    for k, m in enumerate(minima, start=1):
        known, image = verdict(origami, m), images[k][1] if k in images else ""
        said = words.get(known, known) + ", shallow" * m.shallow, held_words(m), image
        found = m.energy, m.kind, m.local_dimension, m.closure_residual, m.kkt_residual, m.hits
        e, survival = m.escape, m.survival and str(m.survival)
        left = m.softest, _escape(m, unit), e and e.barrier, e and e.method, m.shallow, survival
        stable = known == "stable" and not m.shallow
        row: Any = name, k, *found, stable, known, *said, *left, unit
        rows.append(StateRow(*row))
    return tuple(rows)


def listed_table(rows: Sequence[StateRow], title: str) -> Table:
    """Return a line a state: stable ones first, then those that geometry isolates, unstable ones, shallow ones."""

    def place(row: StateRow) -> tuple[int, int]:
        late = 4 * row.shallow + 2 * (row.full_space == "unstable")
        return late + (row.dimension == 0 and row.number > 1), row.number

    in_order = [row.listed() for row in sorted(rows, key=place)]
    return record_table(in_order, title, LISTED, narrow=True)


def _escape(m: JudgedState, scale: float) -> str:
    if m.full_space is not None and m.full_space.verdict == "unstable":
        ends = m.full_space.lands_on
        return f"falls to {rounded(ends.energy, scale):.4g}" if ends else "none"
    if m.escape is None:
        return "-"
    return "not known" if m.escape.method == OPEN else m.escape.words()


def held_words(m: JudgedState) -> str:
    """Say what holds a state: its springs, or contacts with their moments, those that must push to balance it."""
    if m.local_dimension == 0:
        return "geometry: isolated"
    contacts = sorted(m.contacts, key=lambda c: (not c.is_limit, sorted(c.facets)))
    pushing = [c for c in contacts if c.multiplier_range[0] > 0]
    shared = [c for c in contacts if not c.unique]
    parts = ["springs"] * (not pushing and not shared)
    for c in pushing[:MOST_NAMES]:
        unit = "N m/length" if c.is_force else "N m"
        parts.append(f"{_who([c])}: {'>= ' * (not c.unique)}{c.multiplier_range[0]:.3g} {unit}")
    parts += [f"{len(pushing) - MOST_NAMES} more contacts"] * (len(pushing) > MOST_NAMES)
    if rest := [c for c in shared if c not in pushing]:
        parts.append(_who(rest))
    if shared:
        parts[-1] += " (statically indeterminate)"
    kinds = (("fully folded", True, False), ("at a stop", True, True), ("touching", False, False))
    for word, limit, stop in kinds:
        idle = [c for c in contacts if c.unique and c not in pushing]
        if same := [c for c in idle if (c.is_limit, c.is_stop) == (limit, stop)]:
            parts.append(f"{_who(same, named=False)} {word}, no load")
    return "; ".join(parts)


def _who(contacts: Sequence[ContactForce], named: bool = True) -> str:
    """Name creases at fold limits and at stops, and facets that touch, 1-based, the smaller numbers first."""
    touching = sorted((c for c in contacts if not c.is_limit), key=lambda c: sorted(c.facets))
    pairs = sorted({tuple(sorted(c.facets)) for c in touching if c.corners})
    facets = [f"facets {a}|{b}" for a, b in pairs]
    places = (c.text.partition(" (")[0].removesuffix(" at") for c in touching if not c.corners)
    parts = []
    for word, stop in (("fold limit", False), ("stop", True)):
        at = sorted({k for c in contacts if c.is_limit and c.is_stop == stop for k in c.creases})
        if at:
            parts.append(f"{word if named else 'crease'}{'s' * (len(at) > 1)} {_few(at)}")
    return ", ".join([*parts, *filter(None, [_few([*facets, *dict.fromkeys(places)])])])


def _few(names: Sequence[object]) -> str:
    more = len(names) - MOST_NAMES
    return ", ".join(map(str, names[:MOST_NAMES])) + (f" and {more} more" if more > 0 else "")
