"""What the minima of a scene say: table, states, and how the search went."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.full_space import FullSpace
from origami_nlp.minima.minimum import JudgedState, SearchReport
from origami_nlp.minima.noise import survival_words
from origami_nlp.minima.stability import (
    asked,
    barrier_head,
    count_words,
    isolated_foldings,
    not_asked_words,
    number_words,
    softest_words,
    stiffness_words,
    verdict,
)
from origami_nlp.minima.stopping import unseen_share
from origami_nlp.numerics import BALANCED, STATIONARY, residual_words
from origami_nlp.pattern import Scene
from origami_nlp.show import Cell, Table, Words

KIND_STYLE = {
    "interior": "green",
    "contact-pinned": "yellow",
    "contact-touching": "cyan",
    "degenerate": "magenta",
}
VERDICT_STYLE = {"stable": "green", "unstable": "red", "undecided": "bold"}


def freedom_words(dimension: int, full: int) -> str:
    """Say what the local dimension of the feasible set means."""
    if dimension == full:
        return f"{dimension}"
    return {0: "0 isolated", 1: "1 handle"}.get(dimension, f"{dimension} of {full}")


def moment_words(moment: Sequence[float], residual: float, degree: int) -> str:
    """Say which moment passes round the vertex, or that there is no such one."""
    largest = max(map(abs, moment))
    vector = ", ".join(f"{v:.6g}" if abs(v) > STATIONARY * largest else "0" for v in moment)
    if residual > BALANCED * (1 + largest):
        return (
            f"no one moment passes round the vertex: ({vector}) N m leaves up to {residual:.2g} N m at a free "
            "crease, which facets that touch carry"
        )
    return (
        f"one moment passes round the vertex: ({vector}) N m, seen from the facet between creases {degree} and 1, "
        f"residual {residual_words(residual)} N m"
    )


def states_table(scene: Scene, minima: Sequence[JudgedState], freedom: int) -> Table:
    """Return one row a minimum: energy, kind, verdict where it was asked for, local dimension, residuals, hits.

    freedom: degrees of freedom of the symmetric states.
    """
    title = (
        f"{scene.label or scene.vertex!r}\n{count_words(scene, minima)}, "
        f"symmetry {scene.group.name}, contact {scene.contact}"
    )
    full = asked(minima)
    heads = [
        "#",
        "energy [J]",
        "kind",
        "dimension",
        "softest",
        barrier_head(scene),
        "closure",
        "KKT",
        "hits",
    ]
    grouped = isolated_foldings(minima)
    noise = any(m.survival is not None for m in minima)
    if full:
        heads.insert(3, "full space")
    if noise:
        heads.append("survives")
    rows = []
    for number, m in enumerate(minima, start=1):
        if number in grouped:
            continue
        known = verdict(scene, m)
        row: list[Cell] = [
            str(number),
            f"{m.energy:.9g}",
            Words(m.kind, KIND_STYLE[m.kind]),
            freedom_words(m.local_dimension, freedom),
            softest_words(m.softest),
            m.escape.words() if m.escape else "-",
            residual_words(m.closure_residual),
            residual_words(m.kkt_residual),
            str(m.hits),
        ]
        if full:
            row.insert(3, Words(known, VERDICT_STYLE.get(known, "")))
        if noise:
            row.append(str(m.survival))
        rows.append(row)
    if grouped:
        some = [minima[k - 1] for k in grouped]
        row = [f"({len(some)})", f"{some[0].energy:.4g} to {some[-1].energy:.4g}", "flat foldings"]
        hits = str(sum(m.hits for m in some))
        row += ["0 isolated", "held", "isolated", "", "", hits]
        if full:
            row.insert(3, "")
        if noise:
            row.append(str(max(m.survival.kept for m in some if m.survival)) + " at most")
        rows.append(row)
    if full:  # softness stands below the table, residuals in JSON and on the page
        rows = [row[:5] + row[6:7] + row[9:] for row in rows]
        heads = heads[:5] + heads[6:7] + heads[9:]
    # with the verdicts the table keeps to 80 columns without frames
    columns = ("rrlllrr" if full else "rrllrrrrr") + "r" * noise
    return Table(heads, rows, title, columns, framed=not full, narrow=full)


def state_lines(scene: Scene, minima: Sequence[JudgedState]) -> list[str]:
    """Return the fold angles, contact moments and certificate of each minimum, a few lines each."""
    lines, grouped = [], isolated_foldings(minima)
    for number, m in enumerate(minima, start=1):
        if number in grouped:
            continue
        angles = " ".join(f"{a:8.3f}" for a in np.round(np.degrees(m.fold_angles), 3) + 0.0)
        lines.append(f"#{number} fold angles of creases 1..{len(m.fold_angles)} [deg]: {angles}")
        if m.winding > 1:
            lines.append(f"   winds {m.winding} times round the axis of {scene.group.name}")
        for c in m.contacts:
            lines.append(f"   contact {c.words()}")
        lines.append(f"   {m.certificate}")
        if m.escape is not None:
            lines.append(f"   {stiffness_words(m)}")
        if m.moment is not None:
            lines.append(f"   {moment_words(m.moment, m.moment_residual, len(m.fold_angles))}")
        if m.solver is not None and not m.solver.agrees:
            lines.append(
                f"   IPOPT, started here, does not stay: {m.solver.status}, {m.solver.moved:.1g} rad away"
            )
        if m.full_space:
            lines += [f"   {words}" for words in full_space_lines(m.full_space)]
    if any(m.survival is not None for m in minima):
        degrees = max(m.survival.degrees for m in minima if m.survival)
        lines.append(survival_words(degrees, "rest and sector angles"))
    if grouped:
        lines.append(
            f"#{number_words(grouped)}: {len(grouped)} isolated flat foldings, each crease open or shut and no other "
            "admissible state near: contact alone holds them, whatever the springs (all are in the JSON)"
        )
    return [*lines, *filter(None, [not_asked_words(scene, minima)])]


def full_space_lines(f: FullSpace) -> list[str]:
    """Say what becomes of a state when its symmetry may break."""
    lines = [f"full space: {f.verdict}: {f.certificate}"]
    if f.unstable_mode:
        lines.append(f"the descent {f.unstable_mode}")
    if f.lands_on:
        name = f"state #{f.lands_on.symmetric}" if f.lands_on.symmetric else "an asymmetric state"
        angles = " ".join(f"{a:.2f}" for a in np.round(np.degrees(f.lands_on.fold_angles), 2) + 0.0)
        lines.append(
            f"it lands on {name} at {f.lands_on.energy:.6g} J, {f.lands_on.kind}: {angles} deg"
        )
    return lines


def search_lines(s: SearchReport) -> list[str]:
    """Say in a few lines how the search went, failures included, and what is known of what it did not find."""
    sources = ", ".join(f"{count} {name}" for name, count in s.by_source.items())
    lines = [
        f"{s.starts} starts ({s.feasible_starts} admissible{'; ' * bool(sources)}{sources}), "
        f"{s.stalled} ended nowhere, {s.seconds:.2f} s, seed {s.seed}, effort {s.effort}"
        if s.starts
        else f"no start was drawn, {s.seconds:.2f} s",
        *completeness_lines(s),
        f"IPOPT: {s.solves} solves: "
        + (", ".join(f"{name} {count}" for name, count in sorted(s.statuses.items())) or "none"),
    ]
    for r in s.refused:
        angles = " ".join(f"{a:.6g}" for a in np.degrees(r.fold_angles))
        lines.append(f"no minimum at the guess {angles} deg: {r.verdict}: {r.certificate}")
    if s.failed:
        reasons = ", ".join(f"{why} {count}" for why, count in s.failed.items())
        lines.append(f"left out, as no state or where linear algebra failed: {reasons}")
    ended = [f"{name} {count}" for name, count in sorted(s.outcomes.items()) if count]
    if ended:
        lines.append("starts ended at: " + ", ".join(ended))
    rejected: dict[tuple[str, str], int] = {}
    for r in s.rejected:
        if r.hits:
            key = (r.verdict, r.certificate)
            rejected[key] = rejected.get(key, 0) + 1
    lines += [
        f"  {count} state{'s' * (count > 1)} {verdict}: {reason}"
        for (verdict, reason), count in sorted(rejected.items())
    ]
    return lines


def completeness_lines(s: SearchReport) -> list[str]:
    """Say what is known of minima that the search did not find: as much as the numbers carry, and no more."""
    if s.stopped_by == "complete":
        return [f"complete: {s.complete}"]
    if s.stopped_by == "time":
        return [
            f"{OUT_OF_TIME}: not all of these starts were followed down, nor all of their ends judged"
        ]
    lines = []
    if s.every_corner:
        lines.append(
            f"all {s.corners} states that fold limits alone leave without freedom were tried: "
            + ("judged, some not decided" if s.undecided else "which of them are minima is decided")
        )
    if s.strata:
        started, listed = sum(c.started for c in s.strata), sum(c.listed for c in s.strata)
        lines.append(
            f"{started} of {listed} strata with touches were started (others are empty, or were not hit)"
        )
    if s.quiet:
        lines.append(
            f"the last {s.quiet} drawn starts found no other minimum: those not found draw less than "
            f"{unseen_share(s.quiet):.2g} of such starts (95 %); nothing follows for their number"
        )
    elif s.starts:
        lines.append("the last drawn start reached another minimum: there may well be more")
    if s.seen_once:
        lines.append(
            f"{s.seen_once} minim{'a were' if s.seen_once > 1 else 'um was'} reached by one drawn start only"
        )
    if s.stopped_by == "cap":
        lines.append(
            "stopped at the cap on starts of this effort, before every minimum was reached often enough"
        )
    return lines


def undecided_lines(search: SearchReport) -> list[str]:
    """Name the states that may be minima, but were neither certified nor refuted."""
    return [
        f"not decided: energy {r.energy:.9g} J, hits {r.hits}, fold angles [deg] "
        + " ".join(f"{a:.6g}" for a in np.degrees(r.fold_angles))
        + f": {r.certificate}"
        for r in search.undecided
    ]


def flag_lines(flags: ResultFlags) -> list[str]:
    """Name the flags that are up."""
    if not flags:
        return []
    return [f"flags up: {', '.join(flags.up)} (causes and cures: docs/flags.md, result.flags)"]


def scene_lines(scene: Scene) -> list[str]:
    """Say what is loaded, and how far sector angles were moved to make nearly special relations exact, if they were."""
    found = scene.relations
    if not found.made_exact:
        return scene.load_lines
    return [
        *scene.load_lines,
        f"sector angles moved by up to {found.moved:.1e} rad, so that {len(found.made_exact)} nearly special "
        "relations hold exactly (origami-nlp model lists them)",
    ]
