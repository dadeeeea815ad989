"""The gallery of examples by name, its page and its pictures: `python docs/_ext/gallery.py` writes them anew."""

from __future__ import annotations

import inspect
import itertools
import math
import textwrap
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from pictures import different

import origami_nlp as o
from origami_nlp.pattern import examples
from origami_nlp.show import MOUNTAIN, VALLEY, draw_state

DOCS = Path(__file__).parents[1]
LINES = {"M": (MOUNTAIN, "-."), "V": (VALLEY, "--"), "B": ("black", "-")}
"""Mountains and valleys differ in grey as well."""
NO_SHEET = ("degree6", "degree8")
"""The paper's vertices, which are of no sheet."""
MOST = 3
"""States drawn of each example."""


def draw_pattern(axes: Any, pattern: dict[str, Any]) -> None:
    """Draw the creases of a FOLD file."""
    places = pattern["vertices_coords"]
    for (a, b), letter in zip(pattern["edges_vertices"], pattern["edges_assignment"], strict=True):
        colour, style = LINES.get(letter, ("0.6", "-"))
        ends = [places[a][:2], places[b][:2]]
        axes.plot(*zip(*ends, strict=True), style, color=colour, linewidth=1.2)
    axes.set_aspect("equal")
    axes.axis("off")


def disc(scene: o.Scene) -> dict[str, Any]:
    """One vertex as a crease pattern: its creases on a flat disc."""
    turns = [0.0, *itertools.accumulate(scene.vertex.sector_angles)][:-1]
    creases = range(1, scene.degree + 1)
    return {
        "vertices_coords": [[0.0, 0.0], *([math.cos(t), math.sin(t)] for t in turns)],
        "edges_vertices": [
            *([0, i] for i in creases),
            *([i, i % scene.degree + 1] for i in creases),
        ],
        "edges_assignment": [
            *("M" if r < 0 else "V" for r in scene.rest_angles),
            *"B" * scene.degree,
        ],
    }


def draw_example(name: str, result: o.MinimaResult) -> None:
    """Draw an example: its crease pattern, if it is one of a sheet, and its lowest states."""
    pattern = disc(result.scene) if name in NO_SHEET else examples.crease_pattern(name)
    shown = different(result, MOST)
    figure = Figure(figsize=(2.2 * (len(shown) + 1), 2.2), dpi=120)
    draw_pattern(figure.add_subplot(1, len(shown) + 1, 1), pattern)
    for place, minimum in enumerate(shown, start=2):
        axes = figure.add_subplot(1, len(shown) + 1, place)
        draw_state(axes, result.scene.vertex, minimum.fold_angles)
        axes.set_title(f"{minimum.energy:.4g} J, {minimum.full_space.verdict}", fontsize=9)
    figure.subplots_adjust(0.01, 0.02, 0.99, 0.88, wspace=0.08)
    figure.savefig(DOCS / "figures" / f"gallery_{name}.png")


def said_of(name: str) -> str:
    """What the docstring of an example says before its parameters."""
    words = (inspect.getdoc(examples.BY_NAME[name]) or "").split("\nParameters\n")[0]
    words = " ".join(words.removeprefix("Make ").split())
    return textwrap.fill(words[:1].upper() + words[1:], 118)


def entry(name: str, result: o.MinimaResult) -> str:
    """One example on the page."""
    degrees = ", ".join(f"{math.degrees(a):.4g}" for a in result.scene.vertex.sector_angles)
    counts = f"{len(result.minima)} minima with symmetry {result.scene.group.name}"
    return (
        f"## {name}\n\n{said_of(name)}\n\nSector angles {degrees} degrees; {counts}.\n\n"
        f"![Crease pattern and lowest states of {name}](figures/gallery_{name}.png)\n\n"
        f"```bash\norigami-nlp example {name} > {name}.toml\n```\n\n"
    )


HEAD = f"""# Gallery

Patterns that people know, by name: `origami-nlp example NAME` prints one vertex as a scene file, `--fold FILE` writes
the crease pattern (where there is one). Each picture shows the pattern, mountains dash-dotted and red, valleys dashed
and blue, and the lowest minima of the vertex of different energy, at most {MOST}, with the verdict when the symmetry
may break. The page is written by `python docs/_ext/gallery.py`.

"""
TAIL = """## From a name to states

<!-- run: slow: one search, like those of other pages -->
```bash
origami-nlp example miura:4x6 --fold pattern.fold --scene miura.toml
origami-nlp minima miura.toml --full --figure states.png --fold states.fold
origami-nlp vertices pattern.fold --figure pattern.png
```
"""


def main() -> None:
    """Search, draw and write."""
    parts = [HEAD]
    for name in examples.BY_NAME:
        result = o.find_minima(examples.by_name(name), full=True)
        draw_example(name, result)
        parts.append(entry(name, result))
        print(name, len(result.minima))
    (DOCS / "gallery.md").write_text("".join(parts) + TAIL)


if __name__ == "__main__":
    main()
