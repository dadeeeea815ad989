"""A whole pattern as plain data and back, to the last bit: what results that are read back carry with them.

Corners are numbered from 0, angles in radians; FOLD files, which state them in degrees and may need repair,
are for exchange (`pattern_states.pattern_to_fold`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

import numpy as np

from origami_nlp.errors import FoldFileError
from origami_nlp.io import from_plain, to_plain
from origami_nlp.pattern.cells import make_cell
from origami_nlp.pattern.hinge_tables import law_to_dict, read_law
from origami_nlp.pattern.sheet import Pattern, make_pattern

T = TypeVar("T")


@dataclass(frozen=True)
class _Stated:
    """What makes a pattern."""

    name: str
    corners: np.ndarray
    polygons: tuple[tuple[int, ...], ...]
    joins: tuple[tuple[int, int], ...]
    creases: tuple[tuple[int, int], ...]
    assignment: str
    numbers: tuple[int, ...]
    reference: tuple[float, ...]
    stiffness: tuple[float, ...]
    rest_angles: tuple[float, ...]
    file_angles: tuple[float, ...]
    notes: tuple[str, ...]
    orders: tuple[tuple[int, int, int], ...]
    limits: tuple[tuple[float, float], ...] = ()
    lattice: tuple[tuple[float, ...], ...] = ()
    rolled: tuple[int, int] | None = None


def pattern_to_dict(pattern: Pattern) -> dict[str, Any]:
    """Return a pattern as plain JSON data.

    Parameters
    ----------
    pattern
        The sheet.

    Returns
    -------
    dict
        Of lists, texts and numbers.

    Examples
    --------
    >>> from origami_nlp.pattern import examples, pattern_from_dict, pattern_to_dict
    >>> sheet = examples.pattern("miura", 2, 2)
    >>> pattern_to_dict(pattern_from_dict(pattern_to_dict(sheet))) == pattern_to_dict(sheet)
    True
    """
    p = pattern
    stated = _Stated(
        name=p.name,
        corners=p.corners,
        polygons=p.polygons,
        joins=tuple(sorted(side for side, many in p.other_sides.items() if many > 1)),
        creases=tuple(map(tuple, p.ends.tolist())),
        assignment=p.assignment,
        numbers=tuple(p.numbers.tolist()),
        reference=tuple(p.reference),
        stiffness=tuple(p.stiffness),
        rest_angles=tuple(p.rest),
        file_angles=tuple(p.file_angles),
        notes=p.notes,
        orders=p.orders,
        limits=p.limits,
        lattice=tuple(map(tuple, p.cell.lattice.tolist())) if p.cell else (),
        rolled=p.cell.rolled if p.cell else None,
    )
    data: dict[str, Any] = to_plain(stated)
    for key in ("limits", "lattice", "rolled"):
        if not data[key]:
            del data[key]
    if p.laws:
        every = list(dict.fromkeys(filter(None, p.laws)))
        data["laws"] = [{"name": law.name, **law_to_dict(law)} for law in every]
        data["law"] = [None if law is None else every.index(law) for law in p.laws]
    return data


def pattern_from_dict(data: Any) -> Pattern:
    """Rebuild a pattern from `pattern_to_dict`.

    Parameters
    ----------
    data
        What it returned.

    Returns
    -------
    Pattern
        The same.

    Raises
    ------
    FoldFileError
        If an entry is missing or wrong, or the facets are no sheet.
    """
    laws, which = [], []
    if isinstance(data, Mapping) and "laws" in data:
        data = dict(data)
        laws, which = data.pop("laws"), data.pop("law", [])
    said = from_plain(_Stated, data, "pattern", FoldFileError)

    def of(values: Iterable[T]) -> dict[tuple[int, int], T]:
        return dict(zip(said.creases, values, strict=True))

    try:
        make: Any = make_pattern
        if said.lattice:
            make = partial(make_cell, lattice=said.lattice, rolled=said.rolled)
        made = make(
            said.corners,
            list(said.polygons),
            assignment=of(said.assignment),
            joins=list(said.joins),
            fold_angles=of(said.reference),
            numbers=of(said.numbers),
            stiffness=of(said.stiffness),
            rest=of(said.rest_angles),
            file_angles={s: a for s, a in of(said.file_angles).items() if not np.isnan(a)},
            name=said.name,
            notes=said.notes,
            orders=list(said.orders),
            limits=of(said.limits) if said.limits else None,
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FoldFileError(f"pattern is not whole: {error}") from None
    if tuple(map(tuple, made.ends.tolist())) != said.creases:
        raise FoldFileError("pattern: its creases are not those of its polygons")
    if not laws:
        return made
    try:
        read = [
            read_law({k: v for k, v in law.items() if k != "name"}, law["name"]) for law in laws
        ]
        return made.with_laws([None if k is None else read[k] for k in which])
    except (KeyError, TypeError, AttributeError, IndexError) as error:
        raise FoldFileError(f"pattern: its hinge laws are not whole: {error}") from None
