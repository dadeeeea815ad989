"""A design with hinge laws of a library: found, made a scene, searched for its minima; what it prints."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.arguments import check_flag, check_type
from origami_nlp.display import Report, Section, Table, Words
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.library import LibraryProgram, fewest_wells, wells_library
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.io import to_plain
from origami_nlp.minima import MinimaResult, find_minima
from origami_nlp.pattern import HingeLaw, Scene, Vertex, sum_of

FOUND = 1e-5
"""Largest difference of fold angles of a state that was found again [rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class LibraryDesign(Report):
    """Hinge laws that hold given states, or the proof that no sum of laws of the library does.

    Attributes
    ----------
    scene
        The vertex with its laws; None where there is none.
    library
        Names of the laws.
    weights
        Of each law on each crease, [N, J]; of unit mean stiffness, None without a design.
    margin
        Smallest stiffness along a free motion of a state, over the mean stiffness.
    states
        Names of the states that were asked for.
    found
        Number of the minimum that each of them is, from 0; None where the search does not list it.
    refuted
        Whether it is proved that no weights hold the states, whichever contacts press.
    fewest
        Whether fewer wells are excluded, None if that was not asked for.
    minima
        Of the scene.
    """

    SCHEMA = "origami-nlp/library-design/1"
    READS = False
    scene: Scene | None
    library: tuple[str, ...]
    weights: np.ndarray | None
    margin: float
    states: tuple[str, ...]
    found: tuple[int | None, ...]
    refuted: bool
    fewest: bool | None
    minima: MinimaResult | None

    @property
    def verified(self) -> bool:
        """Whether the search finds all states that were asked for."""
        return self.scene is not None and None not in self.found

    @property
    def wells(self) -> int:
        """Number of laws on all creases whose energy is not convex, in the design."""
        if self.weights is None:
            return 0
        return int(sum((column > 0).sum() for column in self.weights.T[self._counted]))

    @property
    def _counted(self) -> list[int]:
        return [i for i, name in enumerate(self.library) if name in self._falling]

    @property
    def _falling(self) -> set[str]:
        return set(self.not_convex)

    not_convex: tuple[str, ...] = ()

    @property
    def unwanted(self) -> int:
        """Number of minima that nobody asked for."""
        return 0 if self.minima is None else len(self.minima.minima) - len(set(self.found) - {None})

    @property
    def verdict(self) -> str:
        """What was found, in a sentence."""
        many = f"{len(self.states)} state{'s'[: len(self.states) > 1]}"
        if self.refuted:
            return (
                f"no weights of the {len(self.library)} laws of this library hold {many}, with a thousandth of the "
                "mean stiffness on each crease: proved by a dual certificate"
            )
        if self.scene is None:
            return f"not decided: no weights found that hold {many} with this library, and none excluded"
        seen = sum(k is not None for k in self.found)
        return (
            f"{many} held with this library, margin {self.margin:.3g}: {seen} of {len(self.states)} found again, "
            f"{self.unwanted} more minima"
        )

    def report_sections(self) -> Iterable[Section]:
        """Return the verdict, the laws of each crease, and the states."""
        yield Words(self.verdict, "bold")
        if self.weights is None:
            return
        rows = [
            (str(i), ", ".join(f"{a:.4g} x {name}" for a, name in self._used(row)))
            for i, row in enumerate(self.weights, start=1)
        ]
        yield Table(
            ("crease", "laws, of unit stiffness or energy"), rows, columns="rL", framed=False
        )
        words = f"{int((self.weights > 0).sum())} laws in all, {self.wells} of them not convex"
        if self.fewest is not None:
            words += (
                ": fewer are excluded at half the largest margin (branch and bound)"
                if self.fewest
                else ": fewer are not excluded"
            )
        yield words
        for name, k in zip(self.states, self.found, strict=True):
            yield f"{name}: " + ("not in the list of minima" if k is None else f"minimum {k + 1}")
        yield "Weights are for a mean stiffness of 1 N m/rad; all torques and energies scale with it"

    def _used(self, row: np.ndarray) -> Iterator[tuple[float, str]]:
        return ((float(a), name) for a, name in zip(row, self.library, strict=True) if a > 0)

    def to_dict(self) -> dict[str, Any]:
        """Return what was found as plain JSON data."""
        keys = ("verdict", "library", "weights", "margin", "states", "found", "refuted", "fewest")
        data = {key: to_plain(getattr(self, key)) for key in keys}
        data["found"] = [None if k is None else k + 1 for k in self.found]
        minima = None if self.minima is None else self.minima.to_dict()
        return {"schema": self.SCHEMA, **data, "minima": minima}

    def _rows(self) -> Iterator[dict[str, object]]:
        for i, row in enumerate([] if self.weights is None else self.weights, start=1):
            for a, name in self._used(row):
                yield {"crease": i, "law": name, "weight": a}


def design_with_library(
    targets: Targets,
    library: Mapping[str, HingeLaw] | None = None,
    *,
    fewest: bool = False,
    name: str | None = None,
    **search: Any,
) -> LibraryDesign:
    """Find hinge laws, sums of those of a library on each crease, that hold given states with the largest margin.

    Parameters
    ----------
    targets
        The question: states of a vertex; energies and barriers are not for laws, and bounds of springs are not used.
    library
        Laws of unit size by name; springs at three rest angles and wells every 30 degrees by default.
    fewest
        Use as few laws as possible whose energy is not convex, at half the largest margin.
    name
        Of the scene.
    **search
        For `find_minima`, which looks for the states and for others.

    Returns
    -------
    LibraryDesign
        The scene with its laws and minima, or the proof that no weights do it, or neither.

    Raises
    ------
    OptionError
        If energies or barriers are asked for, the states are of a pattern, or the library is empty.
    """
    check_type("targets", targets, Targets)
    check_flag("fewest", fewest)
    laws = wells_library() if library is None else dict(library)
    if not laws or not all(isinstance(law, HingeLaw) for law in laws.values()):
        raise OptionError("library must have a HingeLaw by each name")
    if targets.energies or targets.barriers or targets.highest or targets.preload:
        raise OptionError(
            "energies, barriers and preload are designed with springs: leave out the library"
        )
    if not isinstance(targets.origami, Vertex):
        raise OptionError(
            "a library is for the laws of one vertex: a pattern is designed with springs"
        )
    if targets.contact == "none":
        raise OptionError(
            "contact = 'none': laws are known between fold limits; use 'fold-limits' or 'full'"
        )
    states = tuple(state.name for state in targets.states)
    every = tuple(laws.values())
    posed, proved = LibraryProgram(targets, every), None
    bent = tuple(key for key, law in laws.items() if not law.monotone)
    if not posed.feasible:
        refuted = posed.refuted or LibraryProgram(targets, every, loose=True).refuted
        return LibraryDesign(
            None,
            tuple(laws),
            None,
            math.nan,
            states,
            (None,) * len(states),
            refuted,
            None,
            None,
            bent,
        )
    if fewest:
        posed, proved = fewest_wells(posed)
    weights = posed.weights()[targets.kinds]
    made = _made(targets, every, weights, name)
    result = find_minima(made, **search)
    found = tuple(
        _number(result, placed.state.problem.expand(placed.state.x)) for placed in targets.placed
    )
    return LibraryDesign(
        made, tuple(laws), weights, posed.margin, states, found, False, proved, result, bent
    )


def _made(
    targets: Targets, laws: tuple[HingeLaw, ...], weights: np.ndarray, name: str | None
) -> Scene:
    sums: dict[tuple[float, ...], HingeLaw] = {}
    for i, row in enumerate(map(tuple, weights.tolist()), start=1):
        if row not in sums:
            parts = [law.times(a) for law, a in zip(laws, row, strict=True) if a > 0]
            sums[row] = sum_of(parts, f"hinge-{i}")
    of = tuple(sums[tuple(row)] for row in weights.tolist())
    return replace(targets.blank, laws=of, name=name)


def _number(result: MinimaResult, phi: np.ndarray) -> int | None:
    off = [float(np.abs(np.asarray(m.fold_angles) - phi).max()) for m in result.minima]
    return int(np.argmin(off)) if off and min(off) <= FOUND else None
