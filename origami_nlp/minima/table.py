"""Results as tables for a terminal (rich) and as plain text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.minima.stability import asked, count_words, not_asked_words, verdict
from origami_nlp.show import plain_text

if TYPE_CHECKING:
    from origami_nlp.kkt import ContactForce
    from origami_nlp.minima.find import MinimaResult
    from origami_nlp.minima.full_space import FullSpace

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


def contact_words(contact: ContactForce) -> str:
    """Describe one contact with its moment, or the range of it."""
    low, high = contact.multiplier_range
    if math.isclose(low, high, rel_tol=1e-9, abs_tol=1e-300):
        return f"{contact.text}: moment {contact.multiplier:.4g} N m"
    top = "inf" if math.isinf(high) else f"{high:.4g}"
    return f"{contact.text}: moment {contact.multiplier:.4g} N m (any of {low:.4g} to {top})"


def minima_table(result: MinimaResult) -> Table:
    """Return one row a minimum: energy, kind, verdict where it was asked for, local dimension, residuals, hits."""
    scene = result.scene
    title = (
        f"{scene.label or scene.vertex!r}\n{count_words(result)}, "
        f"symmetry {scene.group.name}, contact {scene.contact}"
    )
    full = asked(result)
    # with the verdicts the table keeps to 80 columns without frames
    look: dict[str, Any] = {"box": box.HEAVY_HEAD}
    if full:
        look = {"box": box.SIMPLE_HEAD, "pad_edge": False, "padding": (0, 1, 0, 0)}
    table = Table(title=Text(title), title_justify="left", **look)
    heads = ["#", "energy [J]", "kind", "dimension", "closure", "KKT", "hits"]
    if full:
        heads.insert(3, "full space")
    for head in heads:
        left = head in ("kind", "full space", "dimension")
        table.add_column(Text(head), justify="left" if left else "right", no_wrap=True)
    for number, m in enumerate(result.minima, start=1):
        known = verdict(scene, m)
        table.add_row(
            str(number),
            f"{m.energy:.9g}",
            Text(m.kind, style=KIND_STYLE[m.kind]),
            *([Text(known, style=VERDICT_STYLE.get(known, ""))] if full else []),
            freedom_words(m.local_dimension, result.model.freedom),
            f"{m.closure_residual:.0e}",
            "-" if math.isnan(m.kkt_residual) else f"{m.kkt_residual:.0e}",
            str(m.hits),
        )
    return table


def state_lines(result: MinimaResult) -> list[str]:
    """Return the fold angles, contact moments and certificate of each minimum, a few lines each."""
    lines = []
    for number, m in enumerate(result.minima, start=1):
        angles = " ".join(f"{a:8.3f}" for a in np.round(np.degrees(m.fold_angles), 3) + 0.0)
        lines.append(f"#{number} fold angles of creases 1..{len(m.fold_angles)} [deg]: {angles}")
        for c in m.contacts:
            lines.append(f"   contact {contact_words(c)}")
        lines.append(f"   {m.certificate}")
        if m.full_space:
            lines += [f"   {words}" for words in full_space_lines(m.full_space)]
    return [*lines, *filter(None, [not_asked_words(result)])]


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


def search_lines(result: MinimaResult) -> list[str]:
    """Say in a few lines how the search went, failures included."""
    s = result.search
    lines = [
        f"{s.starts} starts ({s.feasible_starts} feasible), {s.solves} IPOPT solves, "
        f"{s.seconds:.2f} s, seed {s.seed}; expected undiscovered minima "
        f"{s.expected_undiscovered:.2g}"
        + ("" if s.stopped_by == "rule" else "; stopped at the cap on starts"),
        "IPOPT: " + ", ".join(f"{name} {count}" for name, count in sorted(s.statuses.items())),
        "converged starts ended at: "
        + ", ".join(f"{name} {count}" for name, count in sorted(s.outcomes.items()) if count),
    ]
    reasons: dict[tuple[str, str], int] = {}
    for r in s.rejected:
        if r.hits:
            key = (r.verdict, r.reason)
            reasons[key] = reasons.get(key, 0) + 1
    lines += [
        f"  {count} state{'s' * (count > 1)} {verdict}: {reason}"
        for (verdict, reason), count in sorted(reasons.items())
    ]
    return lines


def undecided_lines(result: MinimaResult) -> list[str]:
    """Name the states that may be minima, but were neither certified nor refuted."""
    return [
        f"not decided: energy {r.energy:.9g} J, hits {r.hits}, fold angles [deg] "
        + " ".join(f"{a:.6g}" for a in np.degrees(r.fold_angles))
        + f": {r.reason}"
        for r in result.search.undecided
    ]


def geometry_lines(result: MinimaResult) -> list[str]:
    """Say how far sector angles were moved to make nearly special relations exact, if they were."""
    found = result.scene.relations
    if not found.made_exact:
        return []
    return [
        f"sector angles moved by up to {found.moved:.1e} rad, so that {len(found.made_exact)} nearly special "
        "relations hold exactly (origami-nlp model lists them)"
    ]


def print_result(result: MinimaResult, console: Console) -> None:
    """Print the table, the states and the record of the search."""
    console.print(minima_table(result))
    for line in state_lines(result):
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    for line in (*undecided_lines(result), *geometry_lines(result)):
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    for line in search_lines(result):
        console.print(line, style="dim", highlight=False, markup=False, soft_wrap=True)


def as_text(result: MinimaResult) -> str:
    """Return the table and the record of the search as plain text."""
    return plain_text(110, lambda console: print_result(result, console)).rstrip()


SUMMARY_HEADS = (
    "scene",
    "symmetric minima",
    "kinds",
    "starts",
    "failed",
    "closure",
    "KKT",
    "seconds",
)
DEMO_HEADS = ("scene", "stable", "kinds of the symmetric minima", "KKT", "seconds")
FULL_HEADS = (
    "scene",
    "symmetric minima",
    "stable",
    "unstable",
    "undecided",
    "how each was decided",
)


def summary_row(r: MinimaResult) -> tuple[str, ...]:
    """Return one scene's counts by kind, starts, failed solves, worst residuals and seconds."""
    kinds = [
        f"{m.kind.removeprefix('contact-')} on a 1-handle"
        if m.local_dimension == 1 < r.model.freedom
        else m.kind.removeprefix("contact-")
        for m in r.minima
    ]
    failed = sum(n for status, n in r.search.statuses.items() if status != "Solve_Succeeded")
    return (
        short_name(r),
        str(len(kinds)),
        ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)),
        str(r.search.starts),
        str(failed),
        f"{max((m.closure_residual for m in r.minima), default=0):.0e}",
        f"{max((m.kkt_residual for m in r.minima if not math.isnan(m.kkt_residual)), default=0):.0e}",
        f"{r.search.seconds:.2f}",
    )


def demo_rows(results: Sequence[MinimaResult]) -> list[tuple[str, ...]]:
    """Return one row a scene: how many of its symmetric minima are stable in the full space, kinds, and the sums."""
    rows = []
    known = [verdict(r.scene, m) for r in results for m in r.minima]
    for r in results:
        name, _, kinds, *_, kkt, seconds = summary_row(r)
        rows.append(
            (name, _stable_of([verdict(r.scene, m) for m in r.minima]), kinds, kkt, seconds)
        )
    return [*rows, ("total", _stable_of(known), "", "", "")]


def _stable_of(verdicts: Sequence[str]) -> str:
    """Say "3 of 4", with the undecided ones where there are any."""
    words = f"{verdicts.count('stable')} of {len(verdicts)}"
    undecided = verdicts.count("undecided")
    return words + (f", {undecided} undecided" if undecided else "")


def short_name(r: MinimaResult) -> str:
    """Return a scene's name without the words that all rows of a table share."""
    name = r.scene.label or repr(r.scene.vertex)
    return name.replace("alpha_1 = ", "").replace("r_k = ", "").replace("degree ", "N = ")


def full_space_row(r: MinimaResult) -> tuple[str, ...]:
    """Return one scene's verdicts in the full space, and the certificates by state."""
    found = [m.full_space for m in r.minima if m.full_space]
    verdicts = [f.verdict for f in found]
    how = []
    for number, f in enumerate(found, start=1):
        words = f.certificate.split(":")[0] if f.verdict == "stable" else f.verdict
        if f.lands_on:
            target = f"#{f.lands_on.symmetric}" if f.lands_on.symmetric else "an asymmetric state"
            words += f", descends to {target} at {f.lands_on.energy:.4g} J"
        how.append(f"#{number} {words}")
    return (
        short_name(r),
        str(len(r.minima)),
        *(str(verdicts.count(v)) for v in ("stable", "unstable", "undecided")),
        "; ".join(how),
    )
