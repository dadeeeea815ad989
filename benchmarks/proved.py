"""How many states a vertex has that hold still: proved counts over random springs, and what a search missed of them."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from benchmarks.problems import random_vertex
from origami_nlp.display import Report, Section, Table
from origami_nlp.minima import find_minima
from origami_nlp.pattern import Scene, Vertex

SCHEMA = "origami-nlp/proved/1"
CROSS = "cross of 90 degrees"
FAMILIES = ("degree 4", "degree 5", CROSS)


def proved_scene(family: str, number: int) -> Scene:
    """Return a scene within fold limits with random springs: two decades of stiffness, any rest angles.

    Parameters
    ----------
    family
        One of `FAMILIES`: random sectors of that degree, or four right angles.
    number
        Which; the same scene everywhere.

    Returns
    -------
    Scene
    """
    rng = np.random.default_rng([number, 15, FAMILIES.index(family)])
    scene = random_vertex(rng, 5 if family == "degree 5" else 4, "fold-limits", 1.0)
    return replace(scene, vertex=Vertex((math.pi / 2,) * 4)) if family == CROSS else scene


@dataclass(frozen=True)
class Counted:
    """Proofs of one family of scenes.

    Attributes
    ----------
    family
        One of `FAMILIES`.
    scenes
        How many.
    statuses
        Scenes by `Completeness.status`.
    minima
        Scenes by their number of minima, proved ones alone.
    except_singular
        The same, of those proved except at singular states, each judged by its cone.
    missed
        Scenes of whose minima the search, with its defaults, had missed some.
    boxes
        Median of a scene.
    search_seconds, proof_seconds
        Medians of a scene; processor time of this machine.
    """

    family: str
    scenes: int
    statuses: dict[str, int]
    minima: dict[int, int]
    except_singular: dict[int, int]
    missed: tuple[int, ...]
    boxes: int
    search_seconds: float
    proof_seconds: float


@dataclass(frozen=True, repr=False)
class ProvedCounts(Report):
    """Proved numbers of minima.

    Attributes
    ----------
    families
        One each.
    """

    families: tuple[Counted, ...]

    def report_sections(self) -> Iterator[Section]:
        """Return one table."""
        heads = [
            "random springs",
            "scenes",
            "proved",
            "but singular",
            "not",
            "minima: scenes",
            "missed",
            "boxes",
            "search [s]",
            "proof [s]",
        ]
        rows: list[list[Any]] = []
        for f in self.families:
            many = Counter(f.minima) + Counter(f.except_singular)
            rows.append(
                [
                    f.family,
                    str(f.scenes),
                    *(
                        str(f.statuses.get(s, 0))
                        for s in ("proved", "proved-except-singular", "not-proved")
                    ),
                    ", ".join(f"{n}: {count}" for n, count in sorted(many.items())),
                    str(len(f.missed)),
                    f"{f.boxes:,}",
                    f"{f.search_seconds:.2f}",
                    f"{f.proof_seconds:.2f}",
                ]
            )
        title = (
            "Minima within fold limits: proved; proved except at singular states, each judged by its cone; not proved; "
            "scenes by their number of minima; scenes of which the search had missed some; medians"
        )
        yield Table(heads, rows, title, "lrrrrLrrrr", framed=False, narrow=True)

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return {"schema": SCHEMA, "families": [asdict(f) for f in self.families]}


def count_proved(
    scenes: int,
    families: tuple[str, ...] = FAMILIES,
    progress: Callable[[str], object] = lambda text: None,
) -> ProvedCounts:
    """Search and prove `scenes` scenes of each family.

    Parameters
    ----------
    scenes
        Of each.
    families
        Of `FAMILIES`.
    progress
        Called with words on the progress.

    Returns
    -------
    ProvedCounts
    """
    return ProvedCounts(tuple(_counted(family, scenes, progress) for family in families))


def _counted(family: str, scenes: int, progress: Callable[[str], object]) -> Counted:
    statuses, minima, singular = Counter[str](), Counter[int](), Counter[int]()
    missed, boxes, search, proof = [], [], [], []
    for number in range(scenes):
        progress(f"{family}, {number + 1} of {scenes}")
        scene = proved_scene(family, number)
        start = time.process_time()
        find_minima(scene, prove=False, escape=False)
        middle = time.process_time()
        result = find_minima(scene, prove=True, escape=False)
        search.append(middle - start)
        proof.append(time.process_time() - middle - search[-1])
        found = result.completeness
        assert found is not None
        statuses[found.status] += 1
        if found.status == "proved":
            minima[len(result.minima)] += 1
        elif found.status == "proved-except-singular":
            singular[len(result.minima)] += 1
        if found.added:
            missed.append(number)
        boxes.append(found.boxes)
    return Counted(
        family,
        scenes,
        dict(statuses),
        dict(minima),
        dict(singular),
        tuple(missed),
        int(np.median(boxes)),
        float(np.median(search)),
        float(np.median(proof)),
    )
