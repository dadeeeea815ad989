"""`origami-nlp paper`: the study of the source paper, and its cones (uniform vertices of any even degree)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.cli import options as o
from origami_nlp.cli.exits import Ended
from origami_nlp.cli.group import Group, writes
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.states import search
from origami_nlp.cli.timed import Clock

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult

MOST_DIGITS = 28_000
"""Largest degree whose numbers are written out: Python converts integers of up to 4,300 digits."""

LISTED = 16
"""Largest degree whose foldings are listed."""
DRAWN_AT = 0.45
"""Elevation [rad] at which all foldings are drawn."""


def _search_panels(clock: Clock, seed: int, full: bool) -> tuple[list[MinimaResult], str]:
    """Find the minima of all 18 panels of the paper's two landscape figures; a title."""
    from origami_nlp.pattern import examples

    results, scenes = list[Any](), examples.panels()
    with progress("panels", len(scenes)) as done:
        for scene in scenes:
            results.append(search(clock, scene, scene.label, seed=seed, full=full))
            done(len(results))
    seconds = sum(r.search.seconds for r in results)
    return results, f"all panels of the paper, {seconds:.1f} s in total"


@writes()
def demo(out: Output, clock: Clock, folder: Path = o.DEMO_FOLDER, seed: int = o.SEED) -> None:
    """Find the symmetric minima of the paper's degree-6 and degree-8 vertices, and which of them are stable."""
    from origami_nlp.display import rows_table
    from origami_nlp.io import make_folder, write_json
    from origami_nlp.minima import DEMO_HEADS, demo_rows, draw_minima
    from origami_nlp.pattern import examples

    folder = make_folder(folder, "--folder")
    files = [folder / name for name in ("minima.json", "degree6.png", "degree8.png")]
    out.check(*(("--folder", file) for file in files))
    results, title = _search_panels(clock, seed, full=True)
    drawn = [examples.degree6("pi/3", 1.0).name, examples.degree8("pi/4", 1.0).name]
    shown = [result for name in drawn for result in results if result.scene.name == name]
    for file, result in zip(files[1:], shown, strict=True):
        result.print_to(out.console)
        out.say("")
        draw_minima(result, file)
    out.say(rows_table(DEMO_HEADS, demo_rows(results), f"{title}: stable in the full space"))
    write_json([r.to_dict() for r in results], files[0])
    out.written(*files)


@writes("json")
def panels(out: Output, clock: Clock, full: bool | None = o.FULL, seed: int = o.SEED) -> None:
    """Find the symmetric minima of the paper's 18 panels; with --full, decide each in the full space."""
    from origami_nlp.display import rows_table
    from origami_nlp.minima import table

    results, title = _search_panels(clock, seed, bool(full))
    heads = table.FULL_HEADS if full else table.SUMMARY_HEADS
    rows = [table.full_space_row(r) if full else table.summary_row(r) for r in results]
    if full:
        totals = [str(sum(int(row[k]) for row in rows)) for k in range(1, 5)]
        rows.append(("total", *totals, ""))
    out.say(rows_table(heads, rows, title))
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
        results = decide_all(chosen, progress=lambda claim: said.at(claim.id, (said.done or 0) + 1))
    print_results(results, out.console)
    out.write("json", as_json, results)
    out.write("latex", as_latex, results)
    return Ended.DONE if all(r.verdict.decided for r in results) else Ended.NO


@writes("json")
def audit(out: Output, file: str = o.CANDIDATES, seed: int = o.SEED) -> None:
    """Say of each published candidate in FILE which exact minimum it is, or which artefact."""
    from origami_nlp.paper import audit_candidates, audit_table, audit_to_dict, read_candidates

    candidates = read_candidates(file)
    with progress("audit", len(candidates)) as report:
        found = audit_candidates(candidates, seed=seed, progress=report)
    out.say(audit_table(found))
    out.write("json", audit_to_dict, found)


@writes("json")
def transitions(family: str = o.FAMILY, seed: int = o.SEED) -> Any:
    """Sweep alpha_1 over a FAMILY of the paper and locate every transition of its admissible space."""
    from origami_nlp.paper import find_transitions

    with progress(family, 1.0) as report:
        return find_transitions(family, report=report.at, seed=seed)


# ---------------------------------------------------------------- cones


@writes("json")
def count(
    out: Output,
    degree: int = o.DEGREE,
    rest_elevation: str = o.REST_ELEVATION,
    ratio: float = o.RATIO,
    rest: str = o.REST_RULE,
    end: str = o.END_RULE,
    full: bool | None = o.FULL,
) -> None:
    """Count the minima on all 2^(N/2 + 1) branches exactly: interior, pinned by contact, falling at a cut.

    With --full each of them is judged in the full contact-admissible space (degrees up to 16).
    """
    from origami_nlp.paper import cone as cones

    cone, nu = cones.Cone(degree, rest, end), _angle(rest_elevation, "--rest-elevation")
    if full:
        with progress("branch minima") as report:
            judged = cones.full_space(cone, ratio, nu, progress=report)
        cones.print_full_space(judged, out.console)
        out.write("json", cones.full_space_to_dict, judged)
        return
    found = cones.count(cone, ratio, nu)
    cones.print_count(found, out.console)
    out.save("json", cones.write_lines, cones.count_to_dict(found))


@writes("json", "figure")
def foldings(out: Output, degree: int = o.DEGREE) -> None:
    """Count foldings up to rotation (necklaces) and up to rotation and reflection (bracelets).

    Up to degree 16 they are listed, and -o FILE.png draws them.
    """
    from origami_nlp.paper import cone as cones

    cones.check_degree(degree, MOST_DIGITS)
    cones.print_foldings(degree, out.console, degree <= LISTED)
    out.save("json", cones.write_lines, cones.foldings_to_dict(degree, degree <= LISTED))
    out.write("figure", lambda: cones.draw_foldings(degree, DRAWN_AT))


@writes("json", "figure")
def branch(
    out: Output, flaps: str = o.FLAPS, elevation: str = o.ELEVATION, end: str = o.END_RULE
) -> None:
    """Print the fold angles of a folded cone, in radians and (as in FOLD files) in degrees; -o FILE.png draws it."""
    from origami_nlp.paper import cone as cones

    nu = _angle(elevation, "--elevation")
    state = cones.branch(flaps, -1 if nu < 0 else 1, end=end)
    data = cones.branch_to_dict(state, nu)  # an error past the end, before anything is written
    cones.print_branch(state, nu, out.console)
    out.save("json", cones.write_lines, data)
    out.write("figure", cones.draw_branch, state, [nu])


@writes("json", "csv", "figure")
def phase(
    out: Output,
    degree: int = o.DEGREE,
    rest: str = o.REST_RULE,
    end: str = o.END_RULE,
    size: int = o.PHASE_SIZE,
) -> None:
    """Map the number of branch minima over (nu_0, r_k), with its exact boundaries."""
    from origami_nlp.paper import cone as cones

    cones.check_size(size)
    with progress(f"cone of degree {degree}", size) as report:
        diagram = cones.phase_diagram(cones.Cone(degree, rest, end), size=size, progress=report)
    cones.print_diagram(diagram, out.console)
    out.write("csv", cones.map_as_csv, diagram)
    out.write("json", cones.diagram_to_dict, diagram)
    out.write("figure", cones.draw_phase, diagram)


def _angle(text: str, option: str) -> float:
    from origami_nlp.pattern import parse_angle

    return parse_angle(text, option)


paper = Group("The source paper: its 18 panels, its equations, and its families of vertices.")
paper.add(demo, panels, verify, audit, transitions)
cone = Group("Cones (uniform vertices of even degree): branches, their minima, different foldings.")
cone.add(count, phase, foldings, branch)
paper.add_typer(cone, name="cone")
