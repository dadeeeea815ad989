"""The gallery: scripts of `docs/gallery`, what each prints and draws, and the page of them.

`python -m tests.gallery [NAME ...]` runs them and renews pictures, printed lines and the page;
`tests/documentation/test_gallery.py` compares with what they do now.
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
import os
import re
import runpy
import sys
import tempfile
import time
from pathlib import Path
from unittest.mock import patch

from matplotlib.axes import Axes
from matplotlib.figure import Figure

DOCS = Path(__file__).parent.parent / "docs"
SCRIPTS, PAGE, FIGURES = DOCS / "gallery", DOCS / "gallery.md", DOCS / "figures" / "gallery"
RECORD = SCRIPTS / "shown.json"
"""What each script prints, and what its picture shows."""
ORDER = {
    "Crease patterns that people know": (
        "miura_vertex miura_sheet waterbomb_snap square_twist kresling_tube yoshimura resch metasheet"
    ),
    "Hinges": "bistable_strip tape_spring thick_panels measured_hinge",
    "Loads, barriers, parameters, design": (
        "force_displacement barrier_graph map_two_parameters design_switch noise poisson_ratio"
    ),
    "In and out": "fold_in_out svg_by_hand bar_and_hinge ipopt_by_hand",
    "The source paper": "paper_panel cone equation_check",
}
ACROSS = 3
LONG = re.compile(r"\d+\.\d{7,}(e[-+]\d+)?")
"""Numbers of more digits than linear algebra of another machine leaves alike."""
BARRIER = re.compile(r"barrier (≤|<=|not) .*")
HEAD = """# Gallery

Each picture is made by a script of at most 15 lines; a click shows it with what it prints (numbers to six digits).
The tests run all of them.

Examples by name, for `find_minima("NAME")` and `origami-nlp minima NAME`: `miura:4x4`, `waterbomb:2x2`,
`yoshimura:3x3`, `resch:1x2`, `metasheet:4x4`, `squaretwist`, `birdbase`, `waterbombbase`; numbers are rows and columns.
A single vertex as a file to edit: `origami-nlp example miura > miura.toml`; `origami-nlp example --help` lists them.
"""


def title(name: str) -> str:
    """The first line of a script."""
    return (ast.get_docstring(ast.parse((SCRIPTS / f"{name}.py").read_text())) or "").split("\n")[0]


def shown_by(axes: Axes) -> list[str]:
    """What is written on axes, and how far curves reach on them."""
    words = [
        axes.get_title(),
        axes.get_xlabel(),
        axes.get_ylabel(),
        *(t.get_text() for t in axes.texts),
    ]
    box = axes.dataLim
    reach = [f"{v:.4g}" for v in (box.x0, box.x1, box.y0, box.y1)] if axes.lines else []
    return [*(" ".join(word.split()) for word in words if word), " ".join(reach)]


def run(name: str, folder: Path | None = None) -> tuple[str, str]:
    """Run a script away from the tree: what it prints, to six digits, and what its picture shows."""
    drawn: list[Figure] = []
    save = Figure.savefig

    def keep(figure: Figure, target: object, **options: object) -> None:
        drawn.append(figure)
        if folder is not None:
            save(figure, folder / f"{name}.png", **{"dpi": 100, "format": "png"})

    with (
        tempfile.TemporaryDirectory() as away,
        contextlib.chdir(away),
        contextlib.redirect_stdout(io.StringIO()) as said,
        patch.object(Figure, "savefig", keep),
    ):
        runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
    (figure,) = drawn
    # bounds of barriers get lower as searches get better
    heads = [BARRIER.sub("", " ".join(t.get_text().split())) for t in figure.texts]
    lines = [line for axes in figure.axes for line in shown_by(axes)]
    printed = LONG.sub(lambda found: f"{float(found[0]):.6g}", said.getvalue())
    return printed, "\n".join([*heads, *filter(None, lines)])


def page() -> str:
    """The page: pictures in a table, each a link to its script."""
    parts = [HEAD]
    for head, names in ORDER.items():
        rows = names.split()
        parts += [f"## {head}", "", "| " * ACROSS + "|", "|---" * ACROSS + "|"]
        for k in range(0, len(rows), ACROSS):
            cells = [
                f"[![{n}](figures/gallery/{n}.png)](gallery/{n}.py)<br>{title(n)}"
                for n in rows[k : k + ACROSS]
            ]
            parts.append("| " + " | ".join(cells + [""] * (ACROSS - len(cells))) + " |")
        parts.append("")
    return "\n".join([*parts, "```{toctree}", ":hidden:", ":glob:", "", "gallery/*", "```", ""])


def main(names: list[str]) -> None:
    """Renew pictures, what is shown, and the page."""
    FIGURES.mkdir(parents=True, exist_ok=True)
    known = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    every = " ".join(ORDER.values()).split()
    for name in names or every:
        start = time.process_time()
        printed, picture = run(name, FIGURES)
        known[name] = {"printed": printed, "picture": picture}
        print(name, f"{time.process_time() - start:.1f} s", flush=True)
    kept = {name: known[name] for name in every if name in known}
    RECORD.write_text(json.dumps(kept, indent=1) + "\n")
    PAGE.write_text(page())


if __name__ == "__main__":
    os.environ.setdefault("MPLBACKEND", "agg")
    main(sys.argv[1:])
