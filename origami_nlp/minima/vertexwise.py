"""Minima of every vertex of a crease pattern, each on its own, equal vertices once.

In JSON ``classes`` holds a result for each class of equal vertices, in the labels of its first vertex; ``vertices``
says of each vertex its class (from 1) and its labels: crease i of the class is crease ``creases[i]`` (from 1) of the
vertex, with the opposite fold angle where ``over`` is true.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from origami_nlp.display import Report, Section, Table
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.io import from_plain, to_plain
from origami_nlp.minima.find import find_minima
from origami_nlp.minima.result import MinimaResult
from origami_nlp.numerics import INPUT_TOL, residual_words
from origami_nlp.pattern import EquivalentVertices, Relabelling, Scene, group_equivalent_vertices

HEADS = ("vertices", "degree", "minima", "kinds", "lowest [J]", "closure", "KKT")


@dataclass(frozen=True, repr=False)
class VertexwiseMinima(Report):
    """Minima of several vertices, each as if it were alone.

    Attributes
    ----------
    classes
        Vertices that are equal but for their labels.
    results
        Of the first vertex of each class.

    Examples
    --------
    >>> import origami_nlp as o
    >>> scene = o.examples.degree6("pi/4", ratio=0.01)
    >>> found = o.find_minima({5: scene, 8: scene}, max_starts=16)
    >>> len(found.results), found.at(8).shape
    (1, (2, 6))
    """

    classes: tuple[EquivalentVertices, ...]
    results: tuple[MinimaResult, ...]

    SCHEMA = "origami-nlp/minima/2"

    def result(self, vertex: int) -> MinimaResult:
        """Return the result for the class of a vertex, in the labels of its first one.

        Parameters
        ----------
        vertex
            Its number.

        Returns
        -------
        MinimaResult
            The minima, and the record of the search for them.

        Raises
        ------
        OptionError
            If there is no such vertex.
        """
        return self.results[self._place(vertex)[0]]

    def at(self, vertex: int) -> np.ndarray:
        """Return the minima of a vertex in its own labels.

        Parameters
        ----------
        vertex
            Its number.

        Returns
        -------
        numpy.ndarray
            Fold angles [M, N] [rad], in order of energy; those of a vertex that equals another one within noise only
            (`EquivalentVertices.apart`) are as exact as that.

        Raises
        ------
        OptionError
            If there is no such vertex.
        """
        k, labels = self._place(vertex)
        states = [m.fold_angles for m in self.results[k].minima]
        return labels.back(np.array(states).reshape(len(states), labels.degree))

    def _place(self, vertex: int) -> tuple[int, Relabelling]:
        for k, one in enumerate(self.classes):
            if vertex in one.numbers:
                return k, one.labels[one.numbers.index(vertex)]
        known = sorted(n for one in self.classes for n in one.numbers)
        raise OptionError(f"vertex = {vertex!r} is not among {', '.join(map(str, known[:12]))}")

    def table(self) -> Table:
        """Return one row a class of equal vertices: minima, kinds, lowest energy, largest residuals."""
        rows = [self._row(k) for k in range(len(self.classes))]
        vertices = sum(len(one.numbers) for one in self.classes)
        title = f"{vertices} vertices, each on its own: {len(self.classes)} different"
        return Table(HEADS, rows, title, "LrrLrrr", framed=False, narrow=True)

    def _row(self, k: int) -> tuple[str, ...]:
        minima = self.results[k].minima
        kinds = Counter(m.kind for m in minima)
        undecided = len(self.results[k].search.undecided)
        words = [f"{count} {kind}" for kind, count in kinds.items()]
        words += [f"{undecided} not decided"] if undecided else []
        stable = [m.full_space for m in minima if m.full_space]
        words += [f"stable: {sum(f.verdict == 'stable' for f in stable)}"] if stable else []
        return (
            ", ".join(map(str, self.classes[k].numbers)),
            str(self.results[k].scene.degree),
            str(len(minima)),
            ", ".join(words) or "none",
            f"{minima[0].energy:.6g}" if minima else "-",
            _largest(m.closure_residual for m in minima),
            _largest(m.kkt_residual for m in minima),
        )

    def report_sections(self) -> Iterator[Section]:
        """Return the table, and what was taken for equal."""
        yield self.table()
        for one in self.classes:
            if one.apart > INPUT_TOL:
                names = ", ".join(map(str, one.numbers[:12])) + ", ..." * (len(one.numbers) > 12)
                yield (
                    f"vertices {names} are equal within {one.apart:.1e} (angles in radians, stiffness relative): "
                    f"the numbers are those of vertex {one.numbers[0]}"
                )

    def _to_plain(self) -> dict[str, Any]:
        return {
            "vertices": [
                {
                    "vertex": number,
                    "class": k,
                    "creases": (labels.creases + 1).tolist(),
                    "over": labels.over,
                }
                for k, one in enumerate(self.classes, start=1)
                for number, labels in zip(one.numbers, one.labels, strict=True)
            ],
            "apart": [one.apart for one in self.classes],
            "classes": to_plain(self.results),
        }

    @classmethod
    def _from_plain(cls, data: dict[str, Any]) -> Self:
        classes = []
        for k, apart in enumerate(data["apart"], start=1):
            mine = [v for v in data["vertices"] if v["class"] == k]
            labels = tuple(_labels(v["creases"], v["over"]) for v in mine)
            classes.append(EquivalentVertices(tuple(v["vertex"] for v in mine), labels, apart))
        return cls(
            tuple(classes), from_plain(tuple[MinimaResult, ...], data["classes"], at="classes")
        )


def _labels(creases: list[int], over: bool) -> Relabelling:
    n = len(creases)
    return Relabelling(creases[0] - 1, (creases[1] - creases[0]) % n != 1, over, n)


def _largest(values: Iterator[float]) -> str:
    known = [v for v in values if np.isfinite(v)]
    return residual_words(max(known)) if known else "-"


def find_vertexwise(
    scenes: Mapping[int, Scene],
    *,
    find: Callable[..., MinimaResult] = find_minima,
    found: Callable[[str], None] | None = None,
    **options: Any,
) -> VertexwiseMinima:
    """Find the minima of several vertices, each as if it were alone; equal ones are searched once.

    Parameters
    ----------
    scenes
        By the number of the vertex, as `read_fold_scenes` returns them.
    find
        What searches one scene; `find_minima`, or a function that shows how far it is.
    found
        Called with a line on each class of vertices when it is done, if there are several.
    options
        Of `find_minima`; `seconds` is for each class.

    Returns
    -------
    VertexwiseMinima
        Classes of equal vertices, and a result for each.

    Raises
    ------
    OptionError
        If there is no scene, or an option is none of `find_minima`.

    Examples
    --------
    >>> import origami_nlp as o
    >>> scenes = {1: o.examples.degree6("pi/3"), 4: o.examples.degree6("pi/4")}
    >>> from origami_nlp.minima import find_vertexwise
    >>> [one.numbers for one in find_vertexwise(scenes, max_starts=16).classes]
    [(1,), (4,)]
    """
    if not isinstance(scenes, Mapping) or not scenes:
        raise OptionError(
            "origami must be a dictionary of scenes by vertex number, such as `read_fold_scenes` returns"
        )
    classes = group_equivalent_vertices(scenes)
    results = []
    for one in classes:
        results.append(find(scenes[one.numbers[0]], **options))
        if found is not None and len(classes) > 1:
            found(_line(one, results[-1]))
    return VertexwiseMinima(classes, tuple(results))


def _line(one: EquivalentVertices, result: MinimaResult) -> str:
    """Describe what was found at a class of equal vertices."""
    many = len(one.numbers) > 1
    lowest = f", lowest {result.minima[0].energy:.6g} J" if result.minima else ""
    late = f"; {OUT_OF_TIME}" if result.search.stopped_by == "time" else ""
    return (
        f"{'vertices' if many else 'vertex'} {', '.join(map(str, one.numbers))}: "
        f"{len(result.minima)} minima{lowest}{late}"
    )
