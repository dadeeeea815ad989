"""The paper's appendix-A test against the exact reduced Hessian: time a state, and error of the eigenvalues.

Both look at the same states: the symmetric minima of the panels at which no contact is closed, in the full space of
all N fold angles.  The reference is the reduced Hessian to 50 digits.  The errors of appendix A are given for each
of its three steps, and the best of them is the one that is compared: more than its user could know.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.problems import Problem
from benchmarks.reference import Unsolved, solve_reference
from origami_nlp.kkt import State
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.problem import Model
from studies import STEPS, appendix_a


def exact_eigenvalues(model: Model, x: np.ndarray) -> np.ndarray:
    """Return the eigenvalues of the reduced Hessian at a regular state x [N] without contact [scene's units]."""
    piece = State(model, x).on()
    z = piece.tangent
    return model.scale * np.linalg.eigvalsh(z.T @ piece.hessian @ z)


def compare_hessians(
    problems: Sequence[Problem], states: Sequence[Sequence[np.ndarray]], rounds: int
) -> list[dict[str, Any]]:
    """Compare both tests on the states [N] of each problem; one record a state, seconds for each round."""
    out = []
    for problem, of_problem in zip(problems, states, strict=True):
        free = replace(problem.scene, symmetry="none", mirror=None, contact="none")
        model = Model(free)
        for number, phi in enumerate(of_problem, start=1):
            try:
                reference = solve_reference(model, phi, ())
            except Unsolved:
                continue
            if not len(reference.eigenvalues) or reference.angle_error(phi) > DUPLICATE_TOL:
                continue  # not stationary without contact: pinned
            exact_eigenvalues(model, phi)  # warm-up
            out.append(_record(problem, number, model, phi, reference.eigenvalues, rounds))
    return out


def _record(
    problem: Problem, number: int, model: Model, phi: np.ndarray, wanted: np.ndarray, rounds: int
) -> dict[str, Any]:
    size = float(np.abs(wanted).max())

    def error(values: Any) -> float | None:
        if len(values) != len(wanted):
            return None
        return float(np.abs(np.sort(np.array(values)) - wanted).max()) / size

    seconds: dict[str, list[float]] = {"exact": [], "appendix A": []}
    for _ in range(rounds):
        begin = time.process_time()
        for _ in range(20):
            found = exact_eigenvalues(model, phi)
        middle = time.process_time()
        test = appendix_a(problem.scene, phi)
        end = time.process_time()
        seconds["exact"].append((middle - begin) / 20)
        seconds["appendix A"].append(end - middle)
    steps = {f"{s.step:g}": error(s.eigenvalues) for s in test.steps}
    return {
        "problem": problem.name,
        "state": number,
        "seconds": seconds,
        "error_exact": error(found),
        "error_appendix": steps,
        "verdict": test.verdict,
        "steps": list(STEPS),
    }
