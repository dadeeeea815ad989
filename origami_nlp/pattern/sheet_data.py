"""A whole pattern as plain data and back, to the last bit: what results that are read back carry with them.

Corners are numbered from 0, angles in radians; FOLD files, which state them in degrees and may need repair,
are for exchange (`pattern_problem.states_to_fold`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from origami_nlp.errors import FoldFileError
from origami_nlp.io import from_plain, to_plain
from origami_nlp.pattern.cells import make_sheet
from origami_nlp.pattern.fold_limits import Contact
from origami_nlp.pattern.hinges_stated import LAW_KEY, LAWS_KEY, edge_laws, laws_to_fold
from origami_nlp.pattern.sheet import Pattern

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
    law: tuple[int | None, ...] = ()
    laws: tuple[dict[str, Any], ...] = ()
    source: str = ""
    contact: Contact = "full"


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
    same = "name source corners polygons assignment numbers reference stiffness file_angles notes orders limits contact"
    data = {key: getattr(p, key) for key in same.split()}
    data |= {"creases": p.ends, "rest_angles": p.rest}
    data["joins"] = sorted(side for side, many in p.other_sides.items() if many > 1)
    if p.cell:
        data |= {"lattice": p.cell.lattice, "rolled": p.cell.rolled}
    data |= zip(("law", "laws"), laws_to_fold(p.laws, 0).values(), strict=False)
    seldom = {"source": "", "limits": (), "rolled": None, "contact": "full"}
    return {key: to_plain(v) for key, v in data.items() if key not in seldom or v != seldom[key]}


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
    said = from_plain(_Stated, data, "pattern", FoldFileError)

    def of(values: Iterable[T]) -> dict[tuple[int, int], T]:
        return dict(zip(said.creases, values, strict=True))

    try:
        stated = {LAW_KEY: list(said.law), LAWS_KEY: list(said.laws)} if said.law else {}
        laws = edge_laws(stated, len(said.creases), np.arange(len(said.creases)))
        made = make_sheet(
            said.corners,
            list(said.polygons),
            said.lattice or None,
            rolled=said.rolled,
            laws=of(laws) if laws else None,
            assignment=of(said.assignment),
            joins=list(said.joins),
            fold_angles=of(said.reference),
            numbers=of(said.numbers),
            stiffness=of(said.stiffness),
            rest=of(said.rest_angles),
            file_angles=of(said.file_angles),
            name=said.name,
            notes=said.notes,
            orders=list(said.orders),
            limits=of(said.limits) if said.limits else None,
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FoldFileError(f"pattern is not whole: {error}") from None
    if tuple(map(tuple, made.ends.tolist())) != said.creases:
        raise FoldFileError("pattern: its creases are not those of its polygons")
    return replace(made, source=said.source, contact=said.contact)
