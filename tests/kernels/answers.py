"""What is answered to a list of questions, as plain data: printed by a process that runs on one kernel.

`python -m tests.kernels.answers GROUP [FIRST:LAST]` prints a line of JSON for each question.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

import origami_nlp as o

Question = tuple[str, Callable[[], Any]]
SECONDS = re.compile(r"\d[\d.,]* (s|ms|min)\b")
RESIDUAL = re.compile(r"\b\d(\.\d+)?e[-+]\d+")


def generic(degree: int, seed: int, contact: str = "full") -> o.Scene:
    """Random sectors, stiffnesses over two decades and rest angles."""
    rng = np.random.default_rng([28, degree, seed])
    while (sectors := rng.dirichlet(np.full(degree, 6.0)) * 2 * math.pi).max() > 0.9 * math.pi:
        pass
    stiffness, rest = 10 ** rng.uniform(-1, 1, degree), rng.uniform(-math.pi, math.pi, degree)
    name = f"degree {degree}, number {seed}"
    return o.Scene(o.Vertex(tuple(sectors.tolist())), stiffness, rest, "none", contact, name=name)


@dataclass(frozen=True)
class Rounded:
    """A design without what follows from the sixth digit of its springs, which the conic solver does not know.

    Of springs that are equally good it takes those in the middle, to its own accuracy.
    """

    design: o.Design

    def __str__(self) -> str:
        return re.sub(r"\([\d,]+ boxes", "(some boxes", str(self.design))

    def to_dict(self) -> dict[str, Any]:
        """Return whether it holds, how firmly, and what else is stable."""
        d = self.design
        extra = [[m.kind, np.round(m.fold_angles, 4).tolist()] for m in d.extra_minima]
        assert d.minima is not None and d.minima.completeness is not None
        proof = d.minima.completeness.status
        return {"verified": d.verified, "margin": d.margin, "extra": extra, "proof": proof}


def vertices() -> Iterator[Question]:
    """Thirty random vertices of degree 4 to 8, two of three within fold limits."""
    for k in range(30):
        degree, contact = 4 + k % 5, ("full", "fold-limits", "fold-limits")[k % 3]
        stated = generic(degree, k, contact)
        yield f"degree {degree}, number {k}, {contact}", lambda s=stated: o.find_minima(s)


def gallery() -> Iterator[Question]:
    """The patterns known by name, as vertices and as sheets."""
    for name in o.examples.BY_NAME:
        yield name, lambda name=name: o.find_minima(o.examples.by_name(name), full=True)
    for name in ("miura:2x2", "waterbomb:1x2", "squaretwist", "yoshimura:2x2"):  # barriers too
        yield (
            f"sheet {name}",
            lambda name=name: o.find_minima(o.examples.pattern(name), starts=6),
        )


def capabilities() -> Iterator[Question]:
    """A metasheet, load paths, a design, an atlas, barriers, critical points, a space of states."""
    e = o.examples
    yield "metasheet 3x3", lambda: o.find_minima(e.pattern("metasheet", 3, 3), starts=6)
    sheet = e.pattern("metasheet", 3, 3)
    yield "metasheet 3x3, load path", lambda: o.load_path(sheet, [1, 2], to=0.05)
    yield "load path", lambda: o.load_path(e.degree6("5*pi/12"), 1, to=0.05)
    vertex = o.Vertex(("pi/3", "2*pi/3", "2*pi/3", "pi/3"))
    wanted = (1.2, -1.2, -0.6, -1.2)
    state = o.find_minima(o.Scene(vertex, (1, 1, 1, 1), wanted)).minima[0].fold_angles
    targets = o.inverse_design.Targets(vertex, (o.inverse_design.Target("folded", state),))
    yield "design", lambda: Rounded(o.design(targets))
    yield (
        "atlas",
        lambda: o.follow(e.degree6("pi/3"), "ratio=0.2:1", checks=1, max_starts=16, full=False),
    )
    scene = e.degree6("pi/4", ratio=0.01)
    yield "barriers", lambda: o.find_barriers(scene, o.find_minima(scene))
    yield "critical points", lambda: o.find_critical_points(scene, rings=12)
    yield "space", lambda: o.find_space(e.degree6("pi/3"), rings=8)


GROUPS = {"vertices": vertices, "gallery": gallery, "capabilities": capabilities}


def printed(result: Any) -> list[str]:
    """The lines that a result prints, but for seconds and residuals, whose digits are what rounding leaves."""
    text = str(result)
    text = RESIDUAL.sub("#", SECONDS.sub("# s", text))
    return [re.sub(r"[\s\u2500-\u257f]+", " ", line).strip() for line in text.splitlines()]


def answered(ask: Callable[[], Any]) -> dict[str, Any]:
    """What a question is answered with: what is printed, and the data."""
    result = ask()
    return {"printed": printed(result), "data": result.to_dict()}


def main() -> None:
    group, *part = sys.argv[1:]
    first, _, last = (part[0] if part else ":").partition(":")
    for name, ask in islice(GROUPS[group](), int(first or 0), int(last or 10**6)):
        print(json.dumps({"name": name, **answered(ask)}), flush=True)


if __name__ == "__main__":
    main()
