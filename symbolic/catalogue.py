"""All claims, in the order of the paper, and the machinery that decides them.

Modules are imported on demand, so that asking for one claim does not load the others.
"""

from __future__ import annotations

import difflib
import importlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from functools import cache

from origami_nlp.errors import OptionError
from origami_nlp.workers import stop_workers, worker_pool

from .claim import Claim, Verdict

MODULES = (
    "section2_closure",
    "section2_dihedral",
    "section3_energy",
    "section3_contact",
    "section3_degree6",
    "section3_topology",
    "section3_degree8",
    "section3_branches8",
    "section4_cone",
    "section4_combinatorics",
    "section5",
    "appendix_a",
    "appendix_b",
    "derivations",
    "degree4",
    "flat_foldable4",
)
"""Modules of `origami_nlp.symbolic.claims`, in the order of the paper; our own derivations come last."""


@dataclass(frozen=True)
class Result:
    """A claim together with its verdict."""

    claim: Claim
    verdict: Verdict


@cache
def claims() -> tuple[Claim, ...]:
    """Every claim; ids are unique."""
    found: list[Claim] = []
    for name in MODULES:
        found += importlib.import_module(f"{__package__}.claims.{name}").CLAIMS
    ids = [c.id for c in found]
    twice = sorted({i for i in ids if ids.count(i) > 1})
    if twice:
        raise AssertionError(f"claim ids used twice: {', '.join(twice)}")
    return tuple(found)


def claim_by_id(claim_id: str) -> Claim:
    """The claim with this id; `OptionError` names the nearest ids otherwise."""
    by_id = {c.id: c for c in claims()}
    if claim_id in by_id:
        return by_id[claim_id]
    near = difflib.get_close_matches(claim_id, by_id, n=3, cutoff=0.3)
    hint = f"; did you mean {', '.join(near)}?" if near else ""
    raise OptionError(f"--only: there is no claim {claim_id!r}{hint}")


def _decide(claim_id: str) -> Verdict:
    return claim_by_id(claim_id).decide()


def decide_all(
    chosen: Sequence[Claim], workers: int = 2, progress: Callable[[Claim], None] | None = None
) -> list[Result]:
    """Decide the claims, in up to `workers` processes; the order of the answer is that of `chosen`.

    progress: called with each claim as soon as it is decided.
    """
    verdicts: dict[str, Verdict] = {}
    for claim, verdict in _verdicts(chosen, workers):
        verdicts[claim.id] = verdict
        if progress is not None:
            progress(claim)
    return [Result(c, verdicts[c.id]) for c in chosen]


def _verdicts(chosen: Sequence[Claim], workers: int) -> Iterator[tuple[Claim, Verdict]]:
    if workers < 2 or len(chosen) < 4:
        for claim in chosen:
            yield claim, claim.decide()
        return
    pool = worker_pool(workers)
    try:
        running = {pool.submit(_decide, c.id): c for c in chosen}
        for done in as_completed(running):
            yield running[done], done.result()
    finally:  # all are done, or nobody waits for them
        stop_workers(pool)
