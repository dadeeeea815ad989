"""The page of sheets by name: the lowest stable states of each, drawn and listed, as the code finds them now.

Written by `python -m tests.gallery_of_patterns`; `tests/minima/test_gallery.py` compares the page with what is found.
"""

from __future__ import annotations

import sys
import time
from itertools import groupby
from pathlib import Path

import matplotlib

import origami_nlp as o
from origami_nlp.display import draw_states
from origami_nlp.minima import JudgedState, MinimaResult, barrier_words

DOCS = Path(__file__).parent.parent / "docs"
PAGE, FIGURES = DOCS / "sheets.md", DOCS / "figures" / "sheets"
STARTS, SHOWN = 10, 6
SHEETS = {
    "metasheet:4x4": "A quadrilateral and its half-turns, after Waitukaitis, with his springs.",
    "miura:4x4": "Sixteen parallelograms. Beside the states of the Miura fold there are pleats, and mixtures of both.",
    "squaretwist": "Four vertices round a square, stable partly folded and folded flat.",
    "yoshimura:3x3": "Diamonds, each folded in two: several degrees of freedom are left.",
    "waterbomb:2x2": "Two by two cells of the waterbomb tessellation.",
    "resch:1x2": "Two triangles of Resch's pattern, with the tucks around them.",
    "birdbase": "The base of the crane: four vertices of degree 4 and one of degree 6.",
}
HEAD = f"""# Sheets by name

Whole sheets with their springs, and the stable states of least energy of each: up to {SHOWN} energies, one state
drawn for each. Energies are in joules: stiffnesses have the geometric mean 0.025 N m/rad, but for the metasheet.
"States" counts those of this energy that the search found, which images under symmetries of the sheet are among. The
barrier is what it takes to leave the first of them, see [patterns](how_to/pattern.md): "<=" is an upper bound, "?" is
not determined.

```bash
origami-nlp minima metasheet:4x4 --starts {STARTS} -o metasheet.png
```

Of sheets whose vertices have degree 4 the branch directions of the flat state with one degree of freedom are traced; of
the others, and of what these ways do not lead to, starts are sampled: `--verbose` says how far ([limits](limits.md)).
Written by `python -m tests.gallery_of_patterns`.
"""


def solve(name: str) -> MinimaResult:
    """The states of a sheet."""
    return o.find_minima(name, starts=STARTS)


def groups(result: MinimaResult) -> list[list[JudgedState]]:
    """Minima by energy, those that are shown."""
    alike = groupby(result.minima, key=lambda s: round(s.energy, 9))
    return [list(states) for _, states in alike][:SHOWN]


def rows(result: MinimaResult) -> list[str]:
    """One line of the table for each energy; what the page must say whatever the computer."""
    lines = []
    for k, states in enumerate(groups(result), 1):
        first = states[0]
        barrier = first.escape.words() if first.escape else "-"
        touches = {c.facets for c in first.contacts if c.corners}
        at_limit = sum(c.type == "fold-limit" for c in first.contacts)
        held = [f"{len(touches)} pair{'s' * (len(touches) > 1)} of facets"] * bool(touches)
        held += [f"{at_limit} fold limit{'s' * (at_limit > 1)}"] * bool(at_limit)
        energy = f"{first.energy:.6g}" if first.energy > 1e-12 else "0"
        cells = k, energy, len(states), first.kind, first.dof, barrier, ", ".join(held)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return lines


def section(name: str, result: MinimaResult) -> str:
    """Text, picture and table of a sheet."""
    p, file = result.pattern, name.replace(":", "_")
    count = f"{p.facets} facets, {p.creases} creases; {len(result.minima)} stable states"
    lines = [
        f"## {name}",
        "",
        SHEETS[name],
        "",
        f"![states of {name}](figures/sheets/{file}.png)",
        "",
        "| # | energy [J] | states | kind | dof | barrier [J] | held by |",
        "|---|---:|---:|---|---:|---:|---|",
        *rows(result),
        "",
        f"{count}, {len(result.undecided)} not decided.",
        "",
    ]
    return "\n".join(lines)


def title(number: int, state: JudgedState) -> str:
    """The title of a state's picture: energy, kind and escape barrier."""
    head = f"{number}: {state.energy:.4g} J, {state.kind}{', shallow' * state.shallow}"
    return f"{head}\n{barrier_words(state.escape, 'J')}".rstrip()


def main(names: list[str]) -> None:
    """Write the page and its figures; with names, these figures alone."""
    matplotlib.use("agg")
    FIGURES.mkdir(parents=True, exist_ok=True)
    parts = [HEAD]
    for name in names or SHEETS:
        start = time.process_time()
        result = solve(name)
        seconds = time.process_time() - start
        shown = [states[0] for states in groups(result)]
        titles = [title(k, s) for k, s in enumerate(shown, 1)]
        states = [(words, s.phi) for words, s in zip(titles, shown, strict=True)]
        figure = draw_states(result.pattern, states, name, contacts=[s.contacts for s in shown])
        figure.savefig(FIGURES / f"{name.replace(':', '_')}.png", dpi=100)
        parts.append(section(name, result))
        print(name, f"{seconds:.1f} s", len(result.minima), flush=True)
    if not names:
        PAGE.write_text("\n".join(parts))


if __name__ == "__main__":
    main(sys.argv[1:])
