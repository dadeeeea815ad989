"""What the code answers, kept in a file, and two such files compared: an alteration that should change no answer is
measured against the code of before.

`python -m tests.kernels.frozen FILE [GROUP ...]` asks the questions (all groups, or those named: they replace what
the file holds of them) and writes their answers; `python -m tests.kernels.frozen --compare OLD NEW [GROUP ...]` prints
a line for each difference of the data, with `--printed` as last word also of the lines that are printed; its exit code
is 1 where an answer differs.  Answers are those of one kernel of OpenBLAS (`OPENBLAS_CORETYPE`, if it says nothing
else: Haswell), so that both files round alike: at the code that froze them first, Prescott instead of Haswell changed
escape barriers and the counts of starts on 4 panels, and 5 eigenvalues of load paths beyond `NEAR`, nothing else.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import origami_nlp as o
from origami_nlp import inverse_design
from origami_nlp.paper import cone
from origami_nlp.pattern_problem import Pull
from origami_nlp.sweep import load_states, parse_sweep, run_sweep
from origami_nlp.symbolic import catalogue, report
from tests.kernels.answers import RESIDUAL, SECONDS, Question, answered, generic

KERNEL = {"OPENBLAS_CORETYPE": "Haswell", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""What the environment of the processes that answer asks for, where it asks for nothing else."""
PATIENT = 1e6
"""Seconds [s] that searches and paths of patterns may take: an answer must not hang on the load of the machine."""
NEAR = 1e-10
"""Numbers that differ by no more, relative to the larger one, are equal."""
ZERO = 1e-12
"""Numbers that are both smaller are equal: rounding's share of angles [rad] and energies that vanish."""
IGNORED = {
    "seconds": "time that was spent",
    "cost": "time that was spent, and evaluations: of paths, also in checks",
    "iterations": "how often a solver iterated until rounding stopped it",
}
"""Keys that are not compared, and why."""
RENAMED: dict[str, str] = {"softest_stiffness": "softest"}
"""Keys of the older file that have another name in the newer one."""
SHEETS = {
    "metasheet:3x3": 10,
    "metasheet:4x4": 10,
    "miura:2x3": 10,
    "miura:4x4": 6,
    "squaretwist": 10,
    "yoshimura:2x2": 6,
    "waterbomb:1x2": 10,
    "waterbomb:2x2": 4,
    "resch:1x2": 4,
    "birdbase": 6,
}
"""Patterns by name, and random starts."""


@dataclass(frozen=True)
class Report:
    """An answer that is plain data."""

    data: Any

    def __str__(self) -> str:
        return ""

    def to_dict(self) -> Any:
        return self.data


def panels() -> Iterator[Question]:
    """The 18 panels of the paper, in the full space as well."""
    for scene in o.examples.panels():
        yield scene.label, lambda s=scene: o.find_minima(s, full=True)


def vertices() -> Iterator[Question]:
    """Examples by name, and random vertices of degree 4 to 8."""
    for name in o.examples.BY_NAME:
        if name not in ("resch", "degree6", "degree8"):
            yield name, lambda name=name: o.find_minima(o.examples.by_name(name), full=True)
    for k in (0, 1, 2, 3, 4, 5, 6, 7):
        contact = ("full", "fold-limits", "none")[k % 3]
        stated = generic(4 + k % 5, k, contact)
        yield f"{stated.name}, {contact}", lambda s=stated: o.find_minima(s)


def gallery() -> Iterator[Question]:
    """Whole patterns by name, and vertices as patterns."""
    for name, starts in SHEETS.items():
        yield name, lambda n=name, s=starts: o.find_minima(n, starts=s, seconds=PATIENT)
    for alpha in ("pi/4", "5*pi/12"):
        pattern = o.examples.pattern("degree6", alpha=alpha)
        name = f"degree6, {alpha}, as a pattern"
        yield name, lambda p=pattern: o.find_minima(p, starts=6, seconds=PATIENT)


def loads() -> Iterator[Question]:
    """Load paths of vertices and of patterns: snaps, back again, contact, several degrees of freedom."""
    from tests.loading.test_loads_in_contact import driven_sheet, sprung
    from tests.loading.test_sheet_loads import SNAPPING, folded_miura

    e = o.examples
    quick: dict[str, Any] = {"confirm": False, "effort": "quick", "max_starts": 24}
    vertex = e.degree6("5*pi/12")
    yield "vertex, snap and back", lambda: o.load_path(vertex, 1, to=-0.2, unload=True, **quick)
    yield "vertex, confirmed", lambda: o.load_path(vertex, 1, to=-0.14)
    one = e.pattern("degree6", alpha="5*pi/12")
    for to in (-0.15, 0.06):
        yield f"vertex as a pattern, {to}", lambda to=to: of_pattern(one, 1, to=to, confirm=False)
    metasheet = e.pattern("metasheet", 3, 3)
    for to in (0.05, "snap"):
        yield f"metasheet 3x3, {to}", lambda to=to: of_pattern(metasheet, [1, 2], to=to)
    touching, classes, folded = driven_sheet()
    k, back = classes.tolist().index(2) + 1, {"to": -30.0, "unload": True, "state": folded}
    yield "metasheet 3x3 into contact and back", lambda: of_pattern(touching, k, **back)
    pattern, start = folded_miura(2, 2)
    pull = Pull(pattern, (0, 8))
    yield "Miura 2x2, pulled and back", lambda: of_pattern(pattern, pull, state=start, unload=True)
    snapping, state = folded_miura(3, 2, *SNAPPING)
    yield "Miura 3x2, snaps", lambda: of_pattern(snapping, 1, state=state, confirm=False)
    several, begin, crease = sprung(35)
    options: dict[str, Any] = {"state": begin, "to": 1.2, "confirm": False}
    yield "Yoshimura 3x3, a side rolls over a facet", lambda: of_pattern(several, crease, **options)


def of_pattern(pattern: o.Pattern, load: Any, **options: Any) -> Any:
    """A load path of a pattern, however long it takes."""
    return o.load_path(pattern, load, seconds=PATIENT, **options)


def paths() -> Iterator[Question]:
    """Minima over stiffnesses, rest angles, sector angles, torques, and over two parameters."""
    e = o.examples
    asked: tuple[tuple[o.Scene, str, dict[str, Any]], ...] = (
        (e.degree6("pi/3"), "ratio=0.2:5", {}),
        (e.degree6("pi/4"), "alpha=40deg:pi/3", {"full": False}),
        (generic(5, 1), "creases.rest_angles[1]=-1:1", {}),
        (e.degree8("pi/6"), "torque[1]=-0.6:-0.4", {}),
    )
    for scene, parameter, more in asked:
        yield (
            f"{scene.label}, {parameter}",
            lambda s=scene, t=parameter, m=more: o.follow(s, t, checks=2, **m),
        )


def designs() -> Iterator[Question]:
    """Springs that hold states: examples."""
    for name in inverse_design.EXAMPLES:
        targets, ask, title = inverse_design.parse_targets(inverse_design.EXAMPLES[name])
        yield name, lambda t=targets, a=ask, n=title: o.design(t, a, name=n)


def proofs() -> Iterator[Question]:
    """Lists proved complete, critical points, barriers, the space of states."""
    from tests.minima.test_windings import STAR

    e = o.examples
    for scene in (e.degree6("pi/4", 0.01), e.degree6("pi/3", 100), generic(4, 2), STAR):
        yield f"proof: {scene.label}", lambda s=scene: o.find_minima(s, prove=True, escape=False)
    for scene in (e.degree6("pi/4", 0.01), e.degree8("pi/4", 1.0)):
        yield (
            f"critical points: {scene.label}",
            lambda s=scene: o.find_critical_points(s, samples=16),
        )
    scene = e.degree6("pi/4", 0.01)
    yield "barriers", lambda: o.find_barriers(scene, o.find_minima(scene))
    yield "space", lambda: o.find_space(e.degree6("pi/3"), rings=8)


def cones() -> Iterator[Question]:
    """Uniform vertices of even degree."""
    for degree, ratio, elevation in ((6, 1.0, 0.6), (8, 0.1, -0.5), (40, 3.0, 0.3)):
        name = f"degree {degree}, r_k = {ratio}, {elevation} rad"
        asked = degree, ratio, elevation
        yield name, lambda a=asked: Report(cone.count_to_dict(cone.count(*a)))
        if degree <= 8:
            yield (
                f"{name}, full space",
                lambda a=asked: Report(cone.full_space_to_dict(cone.full_space(*a))),
            )


def verify() -> Iterator[Question]:
    """The equations and statements of the paper: verdicts."""

    def decided() -> Report:
        results = catalogue.decide_all(catalogue.claims(), workers=1)
        verdicts = {r.claim.id: r.verdict.verdict for r in results}
        return Report({"summary": {**report.summary(results), **report.tally(results)}, **verdicts})

    yield "verify", decided


def sweeps() -> Iterator[Question]:
    """Twelve scenes with one degree of freedom."""
    from tests.sweep.test_sweep import SMALL

    def rows() -> Report:
        with tempfile.TemporaryDirectory() as folder:
            run_sweep(parse_sweep(tomllib.loads(SMALL)), folder, workers=1)
            return Report(load_states(folder).to_dict("records"))

    yield "twelve scenes", rows


GROUPS: dict[str, Callable[[], Iterator[Question]]] = {
    ask.__name__: ask
    for ask in (panels, vertices, gallery, loads, paths, designs, proofs, cones, verify, sweeps)
}


# ---------------------------------------------------------------- the file


def freeze(file: Path, groups: list[str]) -> None:
    """Ask groups of questions, each group in a process of its own, and write the answers beside those in the file."""
    kept = json.loads(file.read_text()) if file.exists() else {}
    for group in groups:
        command = [sys.executable, "-m", "tests.kernels.frozen", "--answer", group]
        done = subprocess.run(
            command, env={**KERNEL, **os.environ}, stdout=subprocess.PIPE, text=True, check=True
        )
        answers = [json.loads(line) for line in done.stdout.splitlines()]
        kept[group] = {answer.pop("name"): answer for answer in answers}
        file.write_text(json.dumps(kept, indent=1))
        seconds = sum(answer["seconds"] for answer in answers)
        print(f"{group:10}{len(answers):4} answers {seconds:8.1f} s of processor time", flush=True)


def plain(data: Any, skip: Collection[str] = IGNORED, renamed: Mapping[str, str] = {}) -> Any:
    """Data without the keys that are skipped, some of the others renamed."""
    if isinstance(data, Mapping):
        named = {renamed.get(key, key): value for key, value in data.items()}
        return {key: plain(x, skip, renamed) for key, x in named.items() if key not in skip}
    return [plain(value, skip, renamed) for value in data] if isinstance(data, list) else data


def differences(one: Any, other: Any, where: str = "", size: float = 0.0) -> Iterator[str]:
    """Where two answers differ; size: of the largest number in the list that holds both."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        for key in {**one, **other}:
            if key in one and key in other:
                yield from differences(one[key], other[key], f"{where}.{key}")
            else:
                yield f"{where}.{key}: only in the {'first' if key in one else 'second'}"
    elif isinstance(one, list) and isinstance(other, list):
        if len(one) != len(other):
            yield f"{where}: {len(one)}, {len(other)} entries"
            return
        size = max((abs(x) for x in [*one, *other] if _number(x)), default=0.0)
        for k, (a, b) in enumerate(zip(one, other, strict=True)):
            yield from differences(a, b, f"{where}[{k}]", size)
    elif _number(one) and _number(other) and not (isinstance(one, int) and isinstance(other, int)):
        near = max(NEAR * max(abs(one), abs(other), size), ZERO)
        if abs(one - other) > near or (math.isnan(one) != math.isnan(other)):
            yield f"{where}: {one!r}, {other!r}"
    elif isinstance(one, str) and isinstance(other, str):
        a, b = (RESIDUAL.sub("#", SECONDS.sub("# s", text)) for text in (one, other))
        if a != b:
            yield f"{where}: {_short(a)}, {_short(b)}"
    elif one != other:
        yield f"{where}: {_short(one)}, {_short(other)}"


def _number(x: Any) -> bool:
    return isinstance(x, int | float) and not isinstance(x, bool)


def _short(x: Any) -> str:
    text = repr(x)
    return text if len(text) < 100 else text[:97] + "..."


def compare(old: Path, new: Path, groups: list[str], printed: bool = False) -> int:
    """Print a line for each difference, and a summary; return how many answers differ."""
    first, second = (json.loads(file.read_text()) for file in (old, new))
    skip = (*IGNORED, *(() if printed else ("printed",)))
    wrong = 0
    for group in groups or [g for g in first if g in second]:
        one, other = first[group], second[group]
        lines = {
            name: list(differences(plain(one[name], skip, RENAMED), plain(other[name], skip), name))
            for name in one
            if name in other
        } | {name: [f"{name}: only in one file"] for name in one.keys() ^ other.keys()}
        for line in chain.from_iterable(lines.values()):
            print(f"{group}: {line}")
        differ = sum(map(bool, lines.values()))
        spent = (sum(answer["seconds"] for answer in answers.values()) for answers in (one, other))
        times = ", ".join(f"{seconds:.1f} s" for seconds in spent)
        print(f"# {group}: {len(lines)} answers, {differ} differ; {times}")
        wrong += differ
    if not groups and first.keys() ^ second.keys():
        print(f"# only in one file: {', '.join(sorted(first.keys() ^ second.keys()))}")
    return wrong


def main(words: list[str]) -> int:
    """Do what the command line asks for (see the module)."""
    if words and words[0] == "--answer":
        for name, ask in GROUPS[words[1]]():
            print(json.dumps({"name": name, **answered(ask)}), flush=True)
        return 0
    if words and words[0] == "--compare":
        old, new, *groups = [word for word in words[1:] if word != "--printed"]
        return 1 if compare(Path(old), Path(new), groups, "--printed" in words) else 0
    if not words or words[0].startswith("-"):
        print(__doc__)
        return 2
    freeze(Path(words[0]), words[1:] or list(GROUPS))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
