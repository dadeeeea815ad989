"""What searches of patterns find of all minima that any of them found: `python -m benchmarks.pattern_union DIR`.

A union is one JSON file a pattern in a folder of the user's: its minima, each certified by the package and with its
images under symmetries of the sheet and springs, and the runs behind them.  Runs are of this checkout; those of an
earlier one are compared by running this file in it under another `--label`, with the same folder.
"""

from __future__ import annotations

import json
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from origami_nlp.io import write_whole
from origami_nlp.numerics import NEAR_SINGULAR_TOL
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import find_labels, image
from origami_nlp.pattern_states import find_states

NAMES = (
    *("yoshimura:2x2", "waterbomb:1x1", "miura:2x3", "metasheet:3x3", "squaretwist"),
    *("yoshimura:2x3", "miura:3x3", "waterbomb:2x2", "yoshimura:3x3", "resch:1x2"),
)
"""Ten patterns, from the quickest search to the longest."""
SEEDS = 6
APART = NEAR_SINGULAR_TOL
"""Minima whose fold angles differ by no more [rad] are one: those that facets hold may have soft modes."""
SCHEMA = "origami-nlp/pattern-union/1"


@dataclass
class Run:
    """A search: label of the checkout, effort, seed; processor seconds, why it stopped, and members it found."""

    label: str
    effort: str
    seed: int
    seconds: float
    stopped_by: str
    found: list[int]


@dataclass
class PatternUnion:
    """The minima of a pattern, [M] lists of fold angles [rad] with energies [J], and the runs."""

    pattern: str
    fold_angles: list[list[float]] = field(default_factory=list)
    energies: list[float] = field(default_factory=list)
    runs: list[Run] = field(default_factory=list)

    def number(self, phi: np.ndarray, energy: float) -> int:
        """Return the number of a minimum, which joins if it is new."""
        if self.fold_angles:
            apart = np.abs(np.array(self.fold_angles) - phi).max(axis=1)
            if apart.min() <= APART:
                return int(apart.argmin())
        self.fold_angles.append(phi.tolist())
        self.energies.append(energy)
        return len(self.energies) - 1

    def table(self) -> str:
        """Say for each label and effort what its seeds found of the union."""
        all_, lines = len(self.energies), []
        for kind in dict.fromkeys((r.label, r.effort) for r in self.runs):
            runs = [r for r in self.runs if (r.label, r.effort) == kind]
            together = len({k for r in runs for k in r.found})
            many = " ".join(str(len(r.found)) for r in runs)
            seconds = float(np.median([r.seconds for r in runs]))
            least = min(len(r.found) for r in runs) / max(all_, 1)
            cells = (
                self.pattern,
                *kind,
                many,
                f"{together} of {all_}",
                f"{least:.1%}",
                f"{seconds:.1f}",
            )
            lines.append(f"| {' | '.join(cells)} |")
        return "\n".join(lines)


HEAD = (
    "| pattern | checkout | effort | minima by seed | together, of all known | least share of a seed | seconds |\n"
    "|---|---|---|---|---|---|---|"
)


def path_of(folder: Path, name: str) -> Path:
    """Return the file of a pattern's union."""
    return folder / f"{name.replace(':', '-')}.json"


def read(folder: Path, name: str) -> PatternUnion:
    """Read a union; an empty one where there is none."""
    path = path_of(folder, name)
    if not path.exists():
        return PatternUnion(name)
    data = json.loads(path.read_text())
    runs = [Run(**r) for r in data["runs"]]
    return PatternUnion(data["pattern"], data["fold_angles"], data["energies"], runs)


def run(union: PatternUnion, label: str, effort: str, seed: int, seconds: float) -> Run:
    """Search once, and file what is found with its images."""
    pattern = as_pattern(union.pattern)
    begin = time.process_time()
    result = find_states(pattern, seed=seed, effort=effort, escape=False, seconds=seconds)
    took, found = time.process_time() - begin, set[int]()
    symmetries = find_labels(pattern).symmetries(pattern)
    for m in result.minima:
        found.add(union.number(m.phi, m.energy))
        for symmetry in symmetries:  # known to the union; not found unless listed
            union.number(image(symmetry, m.phi), m.energy)
    done = Run(label, effort, seed, took, result.search.stopped_by, sorted(found))
    union.runs.append(done)
    return done


def main(
    folder: Path,
    names: Annotated[list[str] | None, typer.Argument()] = None,
    label: str = "now",
    effort: str = "normal",
    seeds: int = SEEDS,
    seconds: float = 3600.0,
    only_print: bool = False,
) -> None:
    """Run what is not yet done of the seeds of each pattern, and print the table."""
    print(HEAD, flush=True)
    for name in names or NAMES:
        union = read(folder, name)
        done = {(r.label, r.effort, r.seed) for r in union.runs}
        for seed in () if only_print else range(seeds):
            if (label, effort, seed) not in done:
                run(union, label, effort, seed, seconds)
                folder.mkdir(parents=True, exist_ok=True)
                data = {"schema": SCHEMA, **asdict(union)}
                write_whole(path_of(folder, name), (json.dumps(data) + "\n").encode())
        print(union.table(), flush=True)


if __name__ == "__main__":
    typer.run(main)
