"""`origami-nlp paper`: the study of the source paper, and its cones (uniform vertices of any even degree)."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

from origami_nlp.cli import options as o
from origami_nlp.cli.exits import Ended
from origami_nlp.cli.group import Group, writes
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.states import search
from origami_nlp.cli.timed import Clock

MOST_DIGITS = 28_000
"""Largest degree whose numbers are written out: Python converts integers of up to 4,300 digits."""
LISTED = 16
"""Largest degree whose foldings are listed."""


def _search_panels(out: Output, clock: Clock, seed: int, full: bool) -> list[Any]:
    """Find the minima of all 18 panels of the paper's two landscape figures, and print a table of them."""
    from origami_nlp.minima import scenes_table
    from origami_nlp.pattern import examples

    results, scenes = list[Any](), examples.panels()
    with progress("panels", len(scenes)) as done:
        for scene in scenes:
            results.append(search(clock, scene, scene.label, seed=seed, full=full))
            done(len(results))
    seconds = sum(r.search.seconds for r in results)
    out.say(scenes_table(results, f"all panels of the paper, {seconds:.1f} s in total"))
    return results


@writes()
def demo(out: Output, clock: Clock, folder: Path = o.DEMO_FOLDER, seed: int = o.SEED) -> None:
    """Find the symmetric minima of the paper's degree-6 and degree-8 vertices, and which of them are stable."""
    from origami_nlp.io import make_folder, write_json
    from origami_nlp.pattern import examples

    folder = make_folder(folder, "--folder")
    files = [folder / name for name in ("degree6.png", "degree8.png", "minima.json")]
    out.check(*(("--folder", file) for file in files))
    results = _search_panels(out, clock, seed, full=True)
    pictured = (examples.degree6("pi/3", 1.0).name, examples.degree8("pi/4", 1.0).name)
    for file, name in zip(files, pictured, strict=False):
        shown = next(r for r in results if r.scene.name == name)
        out.say(shown)
        shown.draw(file)
    write_json([r.to_dict() for r in results], files[-1])
    out.written(*files)


@writes("json")
def panels(out: Output, clock: Clock, full: bool | None = o.FULL, seed: int = o.SEED) -> None:
    """Find the symmetric minima of the paper's 18 panels; with --full, decide each in the full space."""
    results = _search_panels(out, clock, seed, bool(full))
    out.write("json", lambda: [r.to_dict() for r in results])


@writes("json", "latex")
def verify(out: Output, only: list[str] | None = o.CLAIM) -> int:
    """Prove or refute the equations and statements of the source paper that are in the catalogue.

    Prints one line per claim, and what the catalogue leaves out (figures, searches, remarks without a
    number).  Exit code 0: every claim is decided (proved, or its corrected
    statement proved); 1: some claim is not; 2: an option has a value it cannot take.
    """
    from origami_nlp.symbolic.catalogue import claim_by_id, claims, decide_all
    from origami_nlp.symbolic.report import as_json, as_latex
    from origami_nlp.symbolic.table import print_results

    chosen = [claim_by_id(i) for i in dict.fromkeys(only)] if only else list(claims())
    with progress("deciding", len(chosen)) as said:
        count = itertools.count(1)
        results = decide_all(chosen, progress=lambda claim: said(next(count), text=claim.id))
    print_results(results, out.console)
    out.write("json", as_json, results)
    out.write("latex", as_latex, results)
    return Ended.DONE if all(r.verdict.decided for r in results) else Ended.NO


@writes("json")
def audit(file: str = o.CANDIDATES, seed: int = o.SEED) -> Any:
    """Say of each published candidate in FILE which exact minimum it is, or which artefact."""
    from origami_nlp.paper import audit_candidates, read_candidates

    candidates = read_candidates(file)
    with progress("audit", len(candidates)) as report:
        return audit_candidates(candidates, seed=seed, progress=report)


@writes("json")
def transitions(family: str = o.FAMILY, seed: int = o.SEED) -> Any:
    """Locate every transition of the admissible space of a FAMILY of the paper, over its alpha_1."""
    from origami_nlp.paper import find_transitions

    with progress(family) as show:
        return find_transitions(family, report=lambda what, done: show(text=what), seed=seed)


# ---------------------------------------------------------------- cones


@writes("json")
def count(
    degree: int = o.DEGREE,
    rest_elevation: str = o.REST_ELEVATION,
    ratio: float = o.RATIO,
    rest: str = o.REST_RULE,
    end: str = o.END_RULE,
    full: bool | None = o.FULL,
) -> Any:
    """Count the minima on all 2^(N/2 + 1) branches exactly: interior, pinned by contact, falling at a cut.

    With --full each of them is judged in the full contact-admissible space (degrees up to 16).
    """
    from origami_nlp.paper import cone as cones
    from origami_nlp.pattern import parse_angle

    cone, nu = cones.Cone(degree, rest, end), parse_angle(rest_elevation, "--rest-elevation")
    if not full:
        return cones.count(cone, ratio, nu)
    with progress("branch minima") as report:
        return cones.full_space(cone, ratio, nu, progress=report)


@writes("json")
def foldings(degree: int = o.DEGREE) -> Any:
    """Count foldings up to rotation (necklaces) and up to rotation and reflection (bracelets).

    Up to degree 16 they are listed.
    """
    from origami_nlp.paper import cone as cones

    cones.check_degree(degree, MOST_DIGITS)
    return cones.Foldings.of(degree, degree <= LISTED)


@writes("json", "figure")
def phase(
    degree: int = o.DEGREE,
    rest: str = o.REST_RULE,
    end: str = o.END_RULE,
    size: int = o.PHASE_SIZE,
) -> Any:
    """Map the number of branch minima over (nu_0, r_k), with its exact boundaries."""
    from origami_nlp.paper import cone as cones

    with progress(f"cone of degree {degree}", size) as report:
        return cones.phase_diagram(cones.Cone(degree, rest, end), size=size, progress=report)


paper = Group("The source paper: its 18 panels, its equations, and its families of vertices.")
paper.add(demo, panels, verify, audit, transitions)
cone = Group("Cones (uniform vertices of even degree): minima of branches, different foldings.")
cone.add(count, phase, foldings)
paper.add_typer(cone, name="cone")
