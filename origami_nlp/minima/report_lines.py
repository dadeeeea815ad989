"""Tables and lines of a list of minima: states, fold angles, what is not decided."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from origami_nlp.display import KINDS, Cell, Table, Words
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.full_space import FullSpace
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import (
    asked,
    isolated_foldings,
    number_words,
    softest_words,
    stiffness_words,
)
from origami_nlp.minima.summary import MOST_LINES
from origami_nlp.numerics import BALANCED, STATIONARY, residual_words
from origami_nlp.pattern import Scene

MOST_ANGLES = 24
"""Fold angles of a state up to which they are written out; those of larger ones are in the JSON."""
FEW_ANGLES = 9
"""Fold angles that are written to a thousandth of a degree in one line; more, to a hundredth."""
KIND_STYLE = {
    "interior": "green",
    "contact-pinned": "yellow",
    "contact-touching": "cyan",
    "degenerate": "magenta",
}
VERDICT_STYLE = {"stable": "green", "unstable": "red", "undecided": "bold"}


def dof_words(dimension: int, full: int) -> str:
    """Say what the local dimension of the feasible set means."""
    if dimension == full:
        return f"{dimension}"
    return {0: "0 isolated", 1: "1 handle"}.get(dimension, f"{dimension} of {full}")


def moment_words(moment: Sequence[float], residual: float, degree: int) -> str:
    """Report the constant internal moment, or that there is none."""
    largest = max(map(abs, moment))
    vector = ", ".join(f"{v:.6g}" if abs(v) > STATIONARY * largest else "0" for v in moment)
    if residual > BALANCED * (1 + largest):
        return (
            f"no constant internal moment: ({vector}) N m leaves up to {residual:.2g} N m at a free "
            "crease, which facets that touch carry"
        )
    return (
        f"constant internal moment: ({vector}) N m, seen from the facet between creases {degree} and 1, "
        f"residual {residual_words(residual)} N m"
    )


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


def undecided_lines(search: SearchReport) -> list[str]:
    """Name the states that may be minima, but were neither certified nor refuted."""
    return [
        f"not decided: energy {r.energy:.9g} J{_where(r)}: {r.certificate}"
        for r in search.undecided
    ]


def _where(state: JudgedState) -> str:
    if len(state.fold_angles) > MOST_ANGLES:
        return ""
    angles = " ".join(f"{a:.6g}" for a in np.degrees(state.fold_angles))
    return f", hits {state.hits}, fold angles [deg] {angles}"


def angle_lines(
    minima: Sequence[JudgedState], images: Mapping[int, tuple[int, str]]
) -> Iterator[str]:
    """Return the fold angles of states that are no images of others, the first `MOST_LINES` of them.

    images: states by number that are images of others.
    """
    grouped = isolated_foldings(minima)
    some = [k for k in range(1, len(minima) + 1) if k not in images and k not in grouped]
    if not some:
        return
    n = len(minima[0].fold_angles)
    if n > MOST_ANGLES:
        yield f"fold angles of the {n} creases: -o FILE.json"
        return
    yield f"fold angles of creases 1..{n} [deg]"
    for k in some[:MOST_LINES]:
        m = minima[k - 1]
        digits = 3 if n <= FEW_ANGLES else 2
        shown = np.round(np.degrees(m.fold_angles), digits) + 0.0
        angles = " ".join(f"{a:{digits + 5}.{digits}f}" for a in shown)
        winds = f"   winds {m.winding} times round the axis" * (m.winding > 1)
        yield f"{f'#{k}':>5} {angles}{winds}"


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
        "relations hold exactly (origami-nlp inspect lists them)",
    ]


def states_table(
    title: str,
    minima: Sequence[JudgedState],
    known: Sequence[str],
    free: Sequence[int],
    barrier: str,
    last: tuple[str, ...],
    cells: Sequence[Sequence[str]],
) -> Table:
    """Return one row a minimum: energy, kind, verdict where it was asked for, local dimension, and how it is held.

    known, free: of each minimum its verdict in the full space, and the dimension of closed states beside it.
    barrier: head of the column of barriers.  last, cells: further heads, and what stands below them.
    """
    grouped = isolated_foldings(minima)
    full, noise = asked(minima), any(m.survival is not None for m in minima)
    heads = ["#", "energy [J]", "kind", "dimension", "softest", barrier, *last]
    rows = []
    for k, m in enumerate(minima):
        if k + 1 in grouped:
            continue
        row: list[Cell] = [
            str(k + 1),
            f"{m.energy:.9g}",
            Words(m.kind, KIND_STYLE[m.kind], KINDS[m.kind].colour),
            *[Words(known[k], VERDICT_STYLE.get(known[k], ""))] * full,
            dof_words(m.local_dimension, free[k]),
            softest_words(m.softest),
            m.escape.words() if m.escape else "-",
            *cells[k],
        ]
        rows.append([*row, *[str(m.survival)] * noise])
    if grouped:
        some = [minima[k - 1] for k in grouped]
        energies = f"{some[0].energy:.4g} to {some[-1].energy:.4g}"
        row = [f"({len(some)})", energies, "flat foldings", *[""] * full]
        row += ["0 isolated", "held", "isolated", *[""] * (len(last) - 1)]
        row.append(str(sum(m.hits for m in some)) if "hits" in last else "")
        kept = max((m.survival.kept for m in some if m.survival), default=0)
        rows.append([*row, *[f"{kept} at most"] * noise])
    columns = "rrllrr" + ("l" if len(last) == 1 else "r" * len(last))
    if full:
        # softness stands below the table, residuals in JSON and on the page: it keeps to 80 columns
        heads.insert(3, "full space")
        rows = [row[:5] + row[6:7] + row[9:] for row in rows]
        heads, columns = heads[:5] + heads[6:7] + heads[9:], "rrlllrr"
    if noise:
        heads, columns = [*heads, "survives"], columns + "r"
    return Table(heads, rows, title, columns, framed=not full, narrow=full)


def state_lines(minima: Sequence[JudgedState], group: str = "") -> list[str]:
    """Return the fold angles, contact moments and certificate of each minimum, a few lines each.

    group: name of the symmetry round whose axis states wind.
    """
    lines, grouped = [], isolated_foldings(minima)
    for number, m in enumerate(minima, start=1):
        if number in grouped:
            continue
        if len(m.fold_angles) <= MOST_ANGLES:
            angles = " ".join(f"{a:8.3f}" for a in np.round(np.degrees(m.fold_angles), 3) + 0.0)
            lines.append(
                f"#{number} fold angles of creases 1..{len(m.fold_angles)} [deg]: {angles}"
            )
            reported = [m.certificate]
        else:
            lines.append(f"#{number} {m.certificate}")
            reported = []
        if m.winding > 1:
            lines.append(f"   winds {m.winding} times round the axis of {group}")
        shown = [c for c in m.contacts if len(m.fold_angles) <= MOST_ANGLES or not c.is_limit]
        lines += [f"   contact {c.words()}" for c in shown]
        lines += [f"   {words}" for words in reported]
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
    if grouped:
        lines.append(
            f"#{number_words(grouped)}: {len(grouped)} isolated flat foldings, creases unfolded or fully folded and no "
            "other admissible state near: contact alone holds them, whatever the springs (all are in the JSON)"
        )
    return lines
