"""Is a state that is stable within its symmetry stable in the full contact-admissible space?

The state is classified anew in the model without symmetry, with the certificates of `kkt.certificates`.
A state that is no minimum there gets a descent that anyone can replay: states that close, are admissible, have
strictly falling energy, and end at a lower stable state.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State, classify
from origami_nlp.numerics import BALANCED, ENDPOINT_TOL
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search import DescentPath, descent_path

Group: TypeAlias = Sequence[tuple[str, np.ndarray]]
"""Permutations of creases by their names, the identity first."""
FullVerdict = Literal["stable", "unstable", "undecided"]
MOST_CREASES = 12
MOST_STATES = 64
"""Creases, and states, up to which the full space is asked about unasked: the cost does not hang on the machine."""
KEPT = 1e-6
"""A step keeps a symmetry to this share of it: paths close to 1e-12 and take steps of 1e-6 [rad] or more."""


@dataclass(frozen=True, repr=False)
class LandsOn(ShortRepr):
    """The stable state at the end of a descent.

    fold_angles, energy, kind, certificate: of that state.  symmetric: number (1-based) of the
    symmetric minimum that it is, or None for a state that breaks the symmetry.
    """

    fold_angles: tuple[float, ...]
    energy: float
    kind: str
    certificate: str
    symmetric: int | None


class Step(NamedTuple):
    """A state on the way down: its fold angles, all N [rad], and its energy."""

    fold_angles: tuple[float, ...]
    energy: float


@dataclass(frozen=True, repr=False)
class FullSpace(ShortRepr):
    """Verdict on one state in the full contact-admissible space.

    Attributes
    ----------
    verdict
        ``stable``, ``unstable`` or ``undecided``.
    certificate
        Why, in words.
    kind, local_dimension
        As in `JudgedState`, in the full space (stable states only).
    hessian_eigenvalues
        Of the Hessian of the Lagrangian on the closed states' tangent space [N m/rad]; empty where closure loses rank.
    breaking_eigenvalues
        Of its block on perturbations that break the symmetry.
    unstable_mode
        What symmetry the first step of the descent keeps.
    descent
        States and energies, or None.
    lands_on
        Where it ends, or None.
    """

    verdict: FullVerdict
    certificate: str
    kind: str | None = None
    local_dimension: int = 0
    hessian_eigenvalues: tuple[float, ...] = ()
    breaking_eigenvalues: tuple[float, ...] = ()
    unstable_mode: str | None = None
    descent: tuple[Step, ...] | None = None
    lands_on: LandsOn | None = None


def is_affordable(problem: PatternProblem, states: int) -> bool:
    """Return whether so many states of a problem are judged in the full space without being asked.

    Without imposed symmetry there is nothing to judge.  A verdict takes 1 ms (4 creases) to 0.3 s (12 creases) where
    the state is stable; the search that found it takes 0.1 s to 20 s.

    Parameters
    ----------
    problem
        With its symmetry.
    states
        How many.

    Returns
    -------
    bool
        Where there are at most `MOST_CREASES` creases and `MOST_STATES` states.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.minima import is_affordable
    >>> problem = o.pose(o.examples.degree6("pi/3"))
    >>> is_affordable(problem, 4), is_affordable(problem, 1000)
    (True, False)
    """
    many = problem.pattern.creases
    return problem.orbits is not None and many <= MOST_CREASES and states <= MOST_STATES


def judge_in_full_space(
    problem: PatternProblem, fold_angles: np.ndarray, others: tuple[np.ndarray, ...] = ()
) -> FullSpace:
    """Decide a minimum among symmetric states in the full contact-admissible space.

    Parameters
    ----------
    problem
        Of the symmetric states.
    fold_angles
        All N fold angles of the state.
    others
        Fold angles of the symmetric minima, in order, to name where a descent lands.
    """
    model, group = problem.whole, permutations(problem)
    x = np.asarray(fold_angles, dtype=float)
    state = State(model, x)
    known = FullSpace("undecided", "", None, 0, *hessian_spectra(state, group))
    what = classify(state)
    if what.verdict == "minimum":
        found: Any = {"kind": what.kind, "local_dimension": what.local_dimension}
        return replace(known, verdict="stable", certificate=what.reason, **found)
    # a descent to a lower state proves that it is not a minimum
    path = descent_path(model, x)
    why = f"{what.verdict}: {what.reason}"
    if len(path.states) < 2:
        why += "; but no admissible state lower than it was found"
        return replace(known, certificate=why)
    steps = zip(path.states, path.energies, strict=True)
    descent = tuple(Step(tuple(state.tolist()), float(energy)) for state, energy in steps)
    mode = mode_symmetry(problem, path.states[1] - path.states[0])
    known = replace(known, verdict="unstable", unstable_mode=mode, descent=descent)
    if not path.arrives:
        why = f"lower states exist, but the descent stopped at no minimum: {path.what.reason}"
        return replace(known, certificate=why)
    why += "; a descent of admissible states ends lower"
    return replace(known, certificate=why, lands_on=_landing(path, others))


def _landing(path: DescentPath, others: tuple[np.ndarray, ...]) -> LandsOn:
    what = path.what
    near = [float(np.abs(np.asarray(o) - path.end).max()) for o in others]
    same = int(np.argmin(near)) + 1 if near and min(near) <= ENDPOINT_TOL else None
    return LandsOn(
        tuple(path.end.tolist()), float(path.energies[-1]), str(what.kind), what.reason, same
    )


def permutations(problem: PatternProblem) -> list[tuple[str, np.ndarray]]:
    """Return the crease permutations of the imposed group, with a name for each.

    Rotations are named by their angle, mirrors by the creases (or facets) on them.
    """
    n, pattern = problem.pattern.creases, problem.pattern
    number = {frozenset(pair): c for c, pair in enumerate(pattern.ends.tolist())}
    out = [("identity", np.arange(n))]
    for image in problem.orbits.images if problem.orbits else ():
        to = np.array([number[frozenset(image.corners[pair].tolist())] for pair in pattern.ends])
        on = [str(c + 1) for c in np.flatnonzero(to == np.arange(n))]
        name = f"rotation by {360 * int(to[0]) // n} deg"
        if image.turns < 0:
            creases = f"crease{'s' * (len(on) > 1)} {', '.join(on)}" if on else "facets"
            name = f"mirror through {creases}"
        out.append((name, to))
    return out


def with_full_space(problem: PatternProblem, states: Sequence[Any], full: bool | None) -> list[Any]:
    """Add the verdict in the full space to each minimum among judged states.

    full: whether, None: where it is affordable.
    """
    minima = [s.phi for s in states if s.verdict == "minimum"]
    if not (is_affordable(problem, len(minima)) if full is None else full):
        return list(states)

    def verdict(x: np.ndarray) -> FullSpace:
        if time.monotonic() > problem.until:
            return FullSpace("undecided", f"{OUT_OF_TIME} before it was judged")
        try:
            return judge_in_full_space(problem, x, tuple(minima))
        except (np.linalg.LinAlgError, ArithmeticError) as error:
            return FullSpace("undecided", f"linear algebra failed where it was judged: {error}")

    return [replace(s, full_space=verdict(s.phi)) if s.verdict == "minimum" else s for s in states]


def mode_symmetry(problem: PatternProblem, direction: np.ndarray) -> str:
    """Return which elements of the imposed group a change of the fold angles keeps."""
    least, group = KEPT * float(np.abs(direction).max()), permutations(problem)
    kept = [name for name, p in group if np.abs(direction[p] - direction).max() <= least]
    if len(kept) == len(group):
        return f"keeps {problem.symmetry}"
    kept.remove("identity")
    return "keeps only the " + " and the ".join(kept) if kept else "keeps no symmetry"


def symmetry_blocks(
    group: Group, tangent: np.ndarray, hessian: np.ndarray, scale: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return rising eigenvalues of a Hessian [N, N] on a tangent space [N, t], and on its part that breaks a symmetry.

    The part is orthogonal to symmetric perturbations (paper, appendix A); eigenvalues are times `scale`.
    """
    # a projector that commutes with the tangent space's has the eigenvalues 1 (symmetric) and 0 (breaking) on it
    average = np.mean([np.eye(len(tangent))[p] for _, p in group], axis=0)
    share, vectors = np.linalg.eigh(tangent.T @ average @ tangent)
    spaces = tangent, tangent @ vectors[:, share <= 0.5]
    whole, breaking = ((np.linalg.eigvalsh(z.T @ hessian @ z) * scale).tolist() for z in spaces)
    return tuple(whole), tuple(breaking)


def hessian_spectra(state: State, group: Group) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the `symmetry_blocks` of a state in the full space on the tangent space of closure.

    The Hessian is that of the Lagrangian with the multipliers of smallest norm.  Both are empty where closure loses
    rank or no multipliers balance the springs.
    """
    if not state.regular:
        return (), ()
    piece = state.on(state.pieces[0])
    mu = piece.multiplier_set
    if mu.residual > BALANCED * (1 + np.abs(state.gradient).max()):
        return (), ()
    balance = state.gradient - piece.slopes.T @ mu.smallest
    lam = np.linalg.lstsq(state.jacobian.T, balance, rcond=None)[0]
    hessian = piece.hessian_with(np.concatenate([lam, mu.smallest]))
    return symmetry_blocks(group, state.kernel, hessian, state.problem.scale)
