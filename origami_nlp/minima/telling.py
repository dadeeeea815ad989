"""What the minima of a scene say: table, states, and how the search went."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.kkt import ContactForce
from origami_nlp.minima.full_space import FullSpace
from origami_nlp.minima.minimum import Minimum, SearchReport
from origami_nlp.minima.stability import asked, count_words, not_asked_words, verdict
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


def contact_words(contact: ContactForce) -> str:
    """Describe one contact with its moment, or the range of it."""
    low, high = contact.multiplier_range
    if math.isclose(low, high, rel_tol=1e-9, abs_tol=1e-300):
        return f"{contact.text}: moment {contact.multiplier:.4g} N m"
    top = "inf" if math.isinf(high) else f"{high:.4g}"
    return f"{contact.text}: moment {contact.multiplier:.4g} N m (any of {low:.4g} to {top})"


def states_table(scene: Scene, minima: Sequence[Minimum], freedom: int) -> Table:
    """Return one row a minimum: energy, kind, verdict where it was asked for, local dimension, residuals, hits.

    freedom: degrees of freedom of the symmetric states.
    """
    title = (
        f"{scene.label or scene.vertex!r}\n{count_words(scene, minima)}, "
        f"symmetry {scene.group.name}, contact {scene.contact}"
    )
    full = asked(minima)
    heads = ["#", "energy [J]", "kind", "dimension", "closure", "KKT", "hits"]
    if full:
        heads.insert(3, "full space")
    rows = []
    for number, m in enumerate(minima, start=1):
        known = verdict(scene, m)
        row: list[Cell] = [
            str(number),
            f"{m.energy:.9g}",
            Words(m.kind, KIND_STYLE[m.kind]),
            freedom_words(m.local_dimension, freedom),
            f"{m.closure_residual:.0e}",
            "-" if math.isnan(m.kkt_residual) else f"{m.kkt_residual:.0e}",
            str(m.hits),
        ]
        if full:
            row.insert(3, Words(known, VERDICT_STYLE.get(known, "")))
        rows.append(row)
    # with the verdicts the table keeps to 80 columns without frames
    columns = "rrlllrrr" if full else "rrllrrr"
    return Table(heads, rows, title, columns, framed=not full, narrow=full)


def state_lines(scene: Scene, minima: Sequence[Minimum]) -> list[str]:
    """Return the fold angles, contact moments and certificate of each minimum, a few lines each."""
    lines = []
    for number, m in enumerate(minima, start=1):
        angles = " ".join(f"{a:8.3f}" for a in np.round(np.degrees(m.fold_angles), 3) + 0.0)
        lines.append(f"#{number} fold angles of creases 1..{len(m.fold_angles)} [deg]: {angles}")
        for c in m.contacts:
            lines.append(f"   contact {contact_words(c)}")
        lines.append(f"   {m.certificate}")
        if m.full_space:
            lines += [f"   {words}" for words in full_space_lines(m.full_space)]
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
    """Say in a few lines how the search went, failures included."""
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


def undecided_lines(search: SearchReport) -> list[str]:
    """Name the states that may be minima, but were neither certified nor refuted."""
    return [
        f"not decided: energy {r.energy:.9g} J, hits {r.hits}, fold angles [deg] "
        + " ".join(f"{a:.6g}" for a in np.degrees(r.fold_angles))
        + f": {r.reason}"
        for r in search.undecided
    ]


def geometry_lines(scene: Scene) -> list[str]:
    """Say how far sector angles were moved to make nearly special relations exact, if they were."""
    found = scene.relations
    if not found.made_exact:
        return []
    return [
        f"sector angles moved by up to {found.moved:.1e} rad, so that {len(found.made_exact)} nearly special "
        "relations hold exactly (origami-nlp model lists them)"
    ]
