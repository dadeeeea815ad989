"""The page of examples: crease pattern, stable states and table of each, as the code finds them now.

Written by `python -m tests.gallery`; `tests/pattern/test_examples.py` compares the page with what is found.
"""

from __future__ import annotations

import inspect
import json
import time
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

import origami_nlp as o
from origami_nlp.display import draw_pattern, draw_state
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern import fold_vertices, parse_fold, vertex_scenes
from tests.pattern.equivalent_vertices import group_equivalent_vertices

DOCS = Path(__file__).parent.parent / "docs"
PAGE, FIGURES = DOCS / "examples.md", DOCS / "figures" / "examples"
HEAD = """# Examples by name

Each is one vertex with springs, and the crease pattern that it comes from.  Numbers in a pattern are those that
`--vertex` takes; the framed one is the vertex shown.  Mountains are red, dashes and dots; valleys are blue, dashes.
Energies are in millijoules: stiffnesses have the geometric mean 0.025 N m/rad.

```bash
origami-nlp example miura > miura.toml            # the vertex as a scene
origami-nlp minima miura.toml --full              # its stable states
origami-nlp example miura:4x4 -o miura.fold   # the pattern, with the same springs
```

Whole sheets: [sheets by name](sheets.md).

Written by `python -m tests.gallery`.
"""


def solve(name: str, **options: object) -> MinimaResult:
    """The minima of an example, each judged in the full space."""
    return o.find_minima(o.examples.by_name(name), full=True, **options)


def rows(result: MinimaResult) -> list[str]:
    """One line of the table for each minimum; what the page must say whatever the computer."""
    lines = []
    for k, m in enumerate(result.minima, start=1):
        angles = " ".join(f"{a:.1f}" for a in np.round(np.degrees(m.fold_angles), 1) + 0.0)
        energy = f"{1e3 * m.energy:.4g}" if m.energy > 1e-12 else "0"
        lines.append(f"| {k} | {energy} | {m.kind} | {m.full_space.verdict} | {angles} |")
    return lines


def frame_of(name: str):
    """The crease pattern of an example, and the number of the vertex of it that is the example."""
    (frame,) = parse_fold(json.dumps(o.examples.crease_pattern(name)))
    scene = o.examples.by_name(name)
    scenes = vertex_scenes(frame, on_note=lambda note: None, symmetry=scene.symmetry)
    ours = group_equivalent_vertices({-1: scene, **scenes})[0].numbers[1:]
    flat = frame.coords[:, :2]
    middle = flat.mean(axis=0)
    return frame, min(ours, key=lambda v: float(np.linalg.norm(flat[v] - middle)))


def draw(name: str, result: MinimaResult) -> Figure:
    """The crease pattern, and beside it the states."""
    frame, number = frame_of(name)
    states = result.minima
    figure = Figure(figsize=(3.4 + 2.6 * len(states), 3.3), layout="constrained")
    widths = [3.4, *[2.6] * len(states)]
    axes = figure.subplots(1, 1 + len(states), width_ratios=widths)
    draw_pattern(frame, highlight=[number], axes=axes[0])
    for k, (m, place) in enumerate(zip(states, axes[1:], strict=True), start=1):
        draw_state(place, result.scene.vertex, m.fold_angles, size=8)
        energy = f"{1e3 * m.energy:.3g}" if m.energy > 1e-12 else "0"
        place.set_title(f"state {k}: {energy} mJ\n{m.kind}", fontsize=9)
    return figure


def section(name: str, result: MinimaResult) -> str:
    """Text, picture and table of an example."""
    maker = o.examples.BY_NAME[name]
    said = (inspect.getdoc(maker) or "").split("\nParameters\n")[0].removeprefix("Make ").strip()
    found = result.completeness
    proved = "no proof was tried that none is missing"
    if found:
        proved = (
            "proved: no minimum is missing"
            + ", except near singular states, each of them judged" * (not found.proved)
            if found.status != "not-proved"
            else f"no proof that none is missing ({found.reason})"
        )
    n = len(fold_vertices(frame_of(name)[0])[0])
    vertices = f"{n} interior vert{'ices' if n > 1 else 'ex'} in the pattern as drawn"
    lines = [
        f"## {result.scene.label}",
        "",
        f"`origami-nlp example {name}` · `o.examples.{maker.__name__}()`",
        "",
        said[:1].upper() + said[1:],
        "",
        f"![crease pattern and states of {name}](figures/examples/{name}.png)",
        "",
        "| # | energy [mJ] | kind | full space | fold angles of creases 1, 2, ... [deg] |",
        "|---|---|---|---|---|",
        *rows(result),
        "",
        f"Symmetry {result.scene.group.name}; {vertices}.",
        f"{proved[:1].upper()}{proved[1:]}.",
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    """Write the page and its figures."""
    matplotlib.use("agg")
    FIGURES.mkdir(parents=True, exist_ok=True)
    parts = [HEAD]
    for name in o.examples.BY_NAME:
        start = time.process_time()
        result = solve(name, prove=30.0)
        seconds = time.process_time() - start
        draw(name, result).savefig(FIGURES / f"{name}.png", dpi=100)
        parts.append(section(name, result))
        print(name, f"{seconds:.1f} s", len(result.minima), flush=True)
    PAGE.write_text("\n".join(parts))


if __name__ == "__main__":
    main()
