"""Many results in one table: a row a scene."""

from __future__ import annotations

import math
from collections.abc import Sequence

from origami_nlp.display import short_label
from origami_nlp.minima.result import SUCCESS, MinimaResult
from origami_nlp.minima.stability import verdict
from origami_nlp.numerics import residual_words

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
        if m.local_dimension == 1 < m.dof
        else m.kind.removeprefix("contact-")
        for m in r.minima
    ]
    failed = sum(bool(m.solver and m.solver.status != SUCCESS) for m in r.minima)
    return (
        short_label(r.scene.label or repr(r.scene.vertex)),
        str(len(kinds)),
        ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)),
        str(r.search.starts),
        str(failed),
        residual_words(max((m.closure_residual for m in r.minima), default=0)),
        residual_words(
            max((m.kkt_residual for m in r.minima if not math.isnan(m.kkt_residual)), default=0)
        ),
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
        short_label(r.scene.label or repr(r.scene.vertex)),
        str(len(r.minima)),
        *(str(verdicts.count(v)) for v in ("stable", "unstable", "undecided")),
        "; ".join(how),
    )
