"""Which scenes the oracle asks about: stated once, as plain data; what is listed of them is in ``data``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

import origami_nlp as o
from origami_nlp import inverse_design
from origami_nlp.pattern import Pattern, pattern_to_dict, scene_to_dict
from tests import patterns
from tests.independent import scenes as symmetric
from tests.kernels.answers import generic

Stated = tuple[str, dict[str, Any]]


def plain(folded: Any, **more: Any) -> dict[str, Any]:
    """A question's statement of what is folded."""
    if isinstance(folded, Pattern):
        return {"stated": {"pattern": pattern_to_dict(folded)}, **more}
    return {"stated": {"scene": scene_to_dict(folded)}, **more}


def panels() -> Iterator[Stated]:
    """The paper's panels in every contact mode."""
    for contact in ("full", "fold-limits", "none"):
        for scene in o.examples.panels():
            yield f"{scene.label}, {contact}", plain(replace(scene, contact=contact))


def random_vertices() -> Iterator[Stated]:
    """Random vertices of degree 3 to 9."""
    for degree, many in ((4, 14), (5, 14), (6, 12), (7, 8), (8, 5), (9, 3)):
        for k in range(many):
            contact = ("full", "fold-limits", "full", "none")[k % 4]
            yield f"degree {degree}, {100 + k}, {contact}", plain(generic(degree, 100 + k, contact))


def cones_of_paper() -> Iterator[Stated]:
    """Vertices whose sector angles do not sum to 2 pi, three creases among them."""
    for k in range(12):
        rng = np.random.default_rng([29, k])
        total = 2 * math.pi * (0.75, 0.92, 1.06)[k % 3]
        degree = max(
            3 + k % 4, 4 if total > 2 * math.pi else 3
        )  # three creases of a ruffled sheet do not close
        while True:
            a = rng.dirichlet(np.full(degree, 8.0)) * total
            if (
                a.max() < min(0.9 * math.pi, total / 2)
                and np.sort(a)[-3:].sum() < 2 * math.pi - 0.1
            ):
                break
        rest = rng.uniform(-2, 2, degree)
        contact = ("full", "fold-limits")[k % 2]
        vertex = o.Vertex(tuple(a.tolist()), flat=False)
        scene = o.Scene(vertex, 10 ** rng.uniform(-1, 1, degree), rest, "none", contact)
        yield f"cone of paper {k}", plain(scene)


def symmetric_vertices() -> Iterator[Stated]:
    """C_n and D_n with every winding, anywhere in their numbering."""
    for k, shape in enumerate([*symmetric.SHAPES, *symmetric.SHAPES]):
        contact = ("full", "fold-limits", "none")[k % 3]
        scene = symmetric.build(np.random.default_rng([30, k]), shape, contact)
        yield f"symmetric {k}, {shape[0]}{shape[1]}, {contact}", plain(scene)
    star = (math.radians(20), math.radians(52)) * 5
    yield "star of ten", plain(o.Scene(o.Vertex(star), (1.0, 0.4) * 5, (1.9, -1.2) * 5, "C5"))


def almost_special() -> Iterator[Stated]:
    """Vertices within 1e-6 to 1e-10 rad of symmetric, collinear and flat-foldable ones."""
    regular = {
        "hexagon": np.full(6, math.pi / 3),
        "octagon": np.full(8, math.pi / 4),
        "cross": np.full(4, math.pi / 2),
        "miura": np.radians([60, 120, 120, 60]),
        "flat-foldable six": np.radians([50, 70, 60, 40, 70, 70]),
    }
    for name, sectors in regular.items():
        for eps in (1e-6, 1e-8, 1e-10, 0.0) if name != "octagon" else (1e-6, 1e-10):
            rng = np.random.default_rng([31, len(name)])
            off = rng.uniform(-1, 1, len(sectors))
            a = sectors + eps * (off - off.mean())
            k, rest = 10 ** rng.uniform(-0.5, 0.5, len(a)), rng.uniform(-2.5, 2.5, len(a))
            for contact in ("fold-limits", "full") if len(a) < 8 else ("fold-limits",):
                scene = o.Scene(o.Vertex(tuple(a.tolist())), k, rest, "none", contact)
                yield f"{name} off by {eps:g}, {contact}", plain(scene)


def stiffness_ratios() -> Iterator[Stated]:
    """Stiffnesses over eight decades: with more than that between two, springs are refused."""
    for k in range(8):
        scene = generic(4 + k % 3, 200 + k, ("fold-limits", "full")[k % 2])
        stiffness = 10 ** np.random.default_rng([32, k]).uniform(-3.9, 3.9, scene.degree)
        yield f"ratios {k}", plain(replace(scene, stiffness=tuple(stiffness)))


def sprung(pattern: Pattern, seed: int) -> Pattern:
    """A pattern with random springs."""
    rng = np.random.default_rng([33, seed])
    k = rng.uniform(0.2, 2, pattern.creases)
    return pattern.with_springs(k.tolist(), rng.uniform(-2.5, 2.5, pattern.creases).tolist())


SMALL = (
    *("miura:2x2", "miura:2x3", "miura:3x2", "miura:3x3", "miura:2x4", "squaretwist", "birdbase"),
    *("metasheet:2x2", "metasheet:2x3", "metasheet:3x3", "metasheet:2x4", "metasheet:4x4"),
    *(
        "waterbombbase",
        "waterbomb:1x1",
        "waterbomb:1x2",
        "yoshimura:2x2",
        "yoshimura:2x3",
        "resch:1x1",
    ),
)
LARGE = ("waterbomb:2x2", "yoshimura:3x3", "resch:1x2")


def sheets() -> Iterator[Stated]:
    """Patterns by name, with random springs, with holes; cells that repeat, tubes, soft facets."""
    e = o.examples
    for name in SMALL:
        yield name, plain(e.pattern(name))
    for k, name in enumerate(
        ("miura:2x3", "miura:3x2", "metasheet:2x3", "metasheet:3x3", "waterbomb:1x1")
    ):
        for seed in (2 * k, 2 * k + 1):
            yield f"{name}, springs {seed}", plain(sprung(e.pattern(name), seed))
    for seed in range(4):
        yield f"strip {seed}", plain(patterns.strip(seed))
    yield "strip within fold limits", plain(patterns.strip(5), contact="fold-limits")
    for k, without in enumerate((((1, 1),), ((1, 1), (1, 2)))):
        holed = patterns.miura(3, 3 + k, without=without)
        yield f"miura with {k + 1} facets missing", plain(sprung(holed, 40 + k))
    for name in ("miura", "waterbomb"):
        yield f"cell of {name}", plain(e.pattern(name, 1, 1, cell=True))
    for name, rolled in (("yoshimura", 6), ("miura", 8)):
        folded = e.pattern(name, 1, 1, cell=True, rolled=rolled)
        yield f"tube of {name}", plain(folded)
    from origami_nlp.pattern import with_bending

    yield "soft square twist", plain(with_bending(e.pattern("squaretwist"), 0.2))
    yield (
        "soft metasheet, both diagonals",
        plain(with_bending(e.pattern("metasheet:2x2"), 0.5, "both")),
    )


def large_sheets() -> Iterator[Stated]:
    """Sheets whose lists are far from complete."""
    for name in LARGE:
        yield name, plain(o.examples.pattern(name))


def proved() -> Iterator[Stated]:
    """Lists to be proved: random vertices of degree 4, 5 and 6, panels, symmetric ones, strips and meshes."""
    for degree, many in ((4, 200), (5, 60), (6, 20)):
        for k in range(many):
            touching = degree < 6 and k % 4 == 3
            contact = "full" if touching else "fold-limits"
            yield (
                f"degree {degree}, {1000 + k}, {contact}",
                plain(generic(degree, 1000 + k, contact)),
            )
    for contact in ("full", "fold-limits"):
        for scene in o.examples.panels():
            yield f"{scene.label}, {contact}", plain(replace(scene, contact=contact))
    for k in range(40):
        shape = symmetric.SHAPES[k % len(symmetric.SHAPES)]
        scene = symmetric.build(np.random.default_rng([34, k]), shape, "fold-limits")
        yield f"symmetric {k}, {shape[0]}{shape[1]}", plain(scene)
    for name in (
        "metasheet:2x2",
        "metasheet:2x3",
        "metasheet:3x3",
        "miura:2x3",
        "miura:3x2",
        "miura:3x3",
        "squaretwist",
    ):
        for contact in ("full", "fold-limits"):
            yield f"{name}, {contact}", plain(o.examples.pattern(name), contact=contact)
    for seed in range(24):
        folded = patterns.strip(50 + seed, 3 + seed % 2, 2)
        yield f"strip {50 + seed}", plain(folded, contact=("full", "fold-limits")[seed % 2])
    for seed in range(12):
        name = ("miura:2x3", "miura:3x2", "metasheet:2x2")[seed % 3]
        folded = sprung(o.examples.pattern(name), 60 + seed)
        yield f"{name}, springs {60 + seed}", plain(folded, contact="fold-limits")


def escaped() -> Iterator[Stated]:
    """What it takes to leave each minimum."""
    asked = {"verb": "escapes"}
    for scene in o.examples.panels()[::2]:
        yield f"escapes: {scene.label}", asked | plain(scene)
    for degree in (4, 4, 5, 5, 6):
        for contact in ("fold-limits", "full"):
            k = 300 + degree
            yield (
                f"escapes: degree {degree}, {k}, {contact}",
                asked | plain(generic(degree, k, contact)),
            )
    for name in (
        "miura:2x2",
        "miura:2x3",
        "metasheet:2x2",
        "metasheet:2x3",
        "waterbomb:1x1",
        "birdbase",
    ):
        yield f"escapes: {name}", asked | plain(o.examples.pattern(name))
    asked = {"verb": "barriers"}
    for scene in (
        o.examples.degree6("pi/4", 0.01),
        o.examples.degree8("pi/4", 1.0),
        generic(4, 301, "fold-limits"),
    ):
        yield f"barriers: {scene.label}", asked | plain(scene)
    for name in ("metasheet:2x2", "metasheet:2x3", "miura:2x2", "miura:2x3"):
        yield f"barriers: {name}", asked | plain(o.examples.pattern(name))


def located() -> Iterator[Stated]:
    """Events of loads, of one parameter and of two."""
    e, quick = o.examples, {"confirm": False, "effort": "quick", "max_starts": 24}
    for alpha, to in (("5*pi/12", -0.2), ("pi/3", 0.06), ("pi/4", 0.1), ("pi/3", -0.1)):
        q = {"verb": "events", "along": "load", "load": 1, "options": {"to": to, **quick}}
        yield f"load {alpha} to {to}", q | plain(e.degree6(alpha))
    patient = {"seconds": 600.0, "confirm": False}
    for name, load, to in (
        ("metasheet:3x3", [1, 2], 0.05),
        ("metasheet:2x3", 1, 0.4),
        ("miura:2x2", 1, 0.1),
        ("miura:2x3", 2, -0.1),
    ):
        q = {"verb": "events", "along": "load", "load": load, "options": {"to": to, **patient}}
        yield f"load {name} to {to}", q | plain(e.pattern(name))
    paths = (
        *((e.degree6("pi/3"), "ratio=0.2:5"), (e.degree6("pi/4"), "alpha=40deg:pi/3")),
        *((e.degree8("pi/6"), "ratio=0.2:3"), (generic(5, 1), "creases.rest_angles[1]=-1:1")),
        *(
            (e.degree8("pi/6"), "torque[1]=-0.6:-0.4"),
            (generic(4, 302), "creases.stiffness[2]=0.1:10"),
        ),
        *(
            (generic(4, 303, "fold-limits"), "creases.rest_angles[2]=-2:2"),
            (generic(6, 304), "creases.rest_angles[3]=-1:0.5"),
        ),
    )
    more = {"full": False, "checks": 2}
    for scene, parameter in paths:
        q = {"verb": "events", "along": "path", "parameters": [parameter], "options": more}
        yield f"{scene.label}, {parameter}", q | plain(scene)
    for name, parameter in (
        ("metasheet:2x2", "creases.stiffness[1]=0.1:5"),
        ("miura:2x2", "creases.rest_angles[1]=-2:2"),
    ):
        q = {"verb": "events", "along": "path", "parameters": [parameter], "options": {"checks": 1}}
        yield f"{name}, {parameter}", q | plain(e.pattern(name))
    for scene, *two in (
        (e.degree6("pi/3"), "ratio=0.2:5", "alpha=50deg:70deg"),
        (
            generic(4, 305, "fold-limits"),
            "creases.stiffness[1]=0.1:2",
            "creases.rest_angles[2]=-1:1",
        ),
    ):
        q = {"verb": "events", "along": "boundary", "parameters": two, "options": {"lines": 3}}
        yield f"boundary {scene.label}", q | plain(scene)


def designed() -> Iterator[Stated]:
    """Springs for given states: examples, and states of random vertices."""
    for name in inverse_design.EXAMPLES:
        if name != "monostable8":
            yield name, {"verb": "designed", "targets": inverse_design.EXAMPLES[name]}
    for k in range(25):
        scene = generic(4 + k % 2, 400 + k, "fold-limits")
        found = o.find_minima(scene, prove=False, escape=False).minima[: 1 + k % 2]
        sectors = ", ".join(repr(a) for a in scene.vertex.sector_angles)
        text = f"[vertex]\nsector_angles = [{sectors}]\n"
        for number, m in enumerate(found):
            degrees = ", ".join(repr(math.degrees(a)) for a in m.fold_angles)
            text += f'[[states]]\nname = "{number}"\nfold_angles_deg = [{degrees}]\n'
        yield f"states of degree {scene.degree}, {400 + k}", {"verb": "designed", "targets": text}


def counted() -> Iterator[Stated]:
    """Cones: degree, stiffness ratio, rest elevation; and the statements of the paper."""
    for k in range(24):
        asked = [
            (6, 8, 10, 12, 20, 40)[k % 6],
            (0.1, 1.0, 3.0, 30.0)[k % 4],
            (-0.5, 0.3, 0.6)[k % 3],
        ]
        yield f"cone {asked}", {"verb": "cones", "cone": asked}
    yield "verify", {"verb": "verified"}
