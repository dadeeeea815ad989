"""Verdicts from exact residuals: the few shapes of argument the claims share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from .claim import Verdict
from .identities import Circle, counterexample, vanishes

IDENTITY = "identity modulo c^2+s^2-1"


@dataclass(frozen=True)
class Correction:
    """What should have been printed; `proof` proves it anew in the same run."""

    latex: str
    proof: Callable[[], bool]
    how: str


def refuted(evidence: str, method: str, correction: Correction | None) -> Verdict:
    """Verdict on a statement with a counterexample; the correction is proved on the spot."""
    if correction is None:
        return Verdict("refuted", method, evidence)
    proved = correction.proof()
    return Verdict(
        "refuted",
        method,
        f"{evidence} Corrected: {correction.how}" if proved else evidence,
        correction.latex,
        proved,
    )


def by_identity(
    residuals: Sequence[Any],
    circles: Sequence[Circle],
    sketch: str,
    correction: Correction | None = None,
    fixed: Mapping[Any, Any] | None = None,
    method: str = IDENTITY,
) -> Verdict:
    """Proved when every residual vanishes identically; refuted at an exact rational point.

    sketch: one sentence on why it holds, used as evidence of a proof.
    fixed: exact values of other symbols for the counterexample.
    """
    for i, residual in enumerate(residuals):
        if vanishes(residual, circles):
            continue
        point = counterexample(residual, circles, fixed)
        if point is None:
            return Verdict("unproved", method, f"residual {i + 1} is neither zero nor refuted")
        return refuted(f"Counterexample {point}.", "exact rational counterexample", correction)
    return Verdict("proved", method, sketch)


def by_cases(
    cases: Sequence[tuple[str, bool]],
    sketch: str,
    method: str,
    correction: Correction | None = None,
) -> Verdict:
    """Proved when every named exact check holds; the first that fails is the counterexample.

    Raises `ValueError` without a case: nothing would have been checked.
    """
    if not cases:
        raise ValueError("no case to decide by")
    for name, holds in cases:
        if not holds:
            return refuted(f"Fails: {name}.", method, correction)
    return Verdict("proved", method, sketch)


def as_convention(verdict: Verdict, reading: str, correction: Correction) -> Verdict:
    """Turn a refutation into `convention`: true in another `reading` only than the one printed."""
    if verdict.verdict != "refuted":
        return verdict
    return Verdict(
        "convention",
        verdict.method,
        f"{verdict.evidence} {reading} Corrected: {correction.how}",
        correction.latex,
        correction.proof(),
    )


def latex(expr: Any) -> str:
    """LaTeX of a SymPy expression with the paper's powers of functions."""
    return sp.latex(expr, fold_short_frac=True)
