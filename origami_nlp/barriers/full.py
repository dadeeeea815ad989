"""Barriers without the imposed symmetry, for pairs of minima that are stable in the full space.

The symmetric path is admissible in the full space too: its pass bounds the barrier from above.  From below:

- minima on different sides of the flat state are separated by it (`graph.side_of_flat`, a proof);
- a minimum on a thin set leaves it only through states where the set is thin no more, and the lowest of them
  bounds every path out.  For three closed flaps about one edge, the paper's 1-handles, it is proved
  (`flaps`); other sets are sampled (`exits`: a sample, not a proof).

Where the bounds meet, the full barrier is the symmetric one.  Where they do not, the symmetric pass is judged in the
full space: with more than one direction of negative curvature it is no pass there and a lower one exists;
with exactly one it is a pass, and no claim is made that it is the lowest.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.barriers.flaps import flap_exit
from origami_nlp.barriers.graph import side_of_flat
from origami_nlp.barriers.lower_dimensional import last_stratum
from origami_nlp.barriers.passes import Pass, PassKind, critical_at
from origami_nlp.kkt import State, lower_dimensional_at, project
from origami_nlp.minima import full_scene
from origami_nlp.numerics import CLOSURE_TOL, OUTSIDE, SAME_ENERGY, null_space
from origami_nlp.pattern import Scene
from origami_nlp.problem import Contact, Model

EXIT_SPACING = math.pi / 12
"""Distance of the samples of a thin set [rad]."""
MOST_STATES = 1500
"""A thin set that has more samples than this is not sampled to its end, and bounds nothing."""


@dataclass(frozen=True)
class FullPass:
    """What is known of the barrier between two minima in the full contact-admissible space.

    Attributes
    ----------
    from_state, to_state
        Numbers (1-based) of the minima.
    symmetric
        Energy of the symmetric pass.
    upper
        Largest energy along the explicit admissible path.
    lower
        No path is lower.
    pass_kind
        Of the symmetric pass.
    verdict
        ``same`` (bounds agree: no symmetry-breaking path is lower), ``open`` (the pass has index 1 in the full space; a
        lower one elsewhere is not excluded) or ``lower`` (the symmetric pass has a larger index: a lower pass exists,
        between the bounds).
    index
        Directions of negative curvature of the symmetric pass in the full space, None at singular passes.
    why
        The lower bound in words.
    """

    from_state: int
    to_state: int
    symmetric: float
    upper: float
    lower: float
    pass_kind: PassKind
    verdict: str
    index: int | None
    why: str

    @property
    def drop(self) -> float:
        """Largest amount by which a symmetry-breaking path could be lower than the symmetric one."""
        return 0.0 if self.verdict == "same" else self.upper - self.lower


@dataclass(frozen=True)
class Exits:
    """Where a thin set around a state is left.

    held: contacts that stay closed on it.  sampled: number of its states looked at.  lowest: smallest
    energy of a state where it is thin no more (inf where there is none).  state: that state [n], or None.
    dimension: of the thin set.  complete: whether the samples cover it; if not, `lowest` bounds nothing.
    proof: why no exit is lower, in words; empty where that is what the samples say.
    """

    held: tuple[Contact, ...]
    sampled: int
    lowest: float
    state: np.ndarray | None
    dimension: int
    complete: bool = True
    proof: str = ""


def full_pass(
    scene: Scene,
    symmetric: Pass,
    states: tuple[np.ndarray, np.ndarray],
    known_exits: dict[int, Exits],
    others: Sequence[np.ndarray] = (),
) -> FullPass:
    """Bound the barrier between two minima `states` [N] in the full space, given the symmetric pass.

    `known_exits` remembers the exits of thin sets by number of the minimum, and is filled here; `others`
    are fold angles [N] of further passes, which may be exits.
    """
    numbers = (symmetric.from_state, symmetric.to_state)
    at = np.array(symmetric.fold_angles)
    path = symmetric.path
    model = Model(full_scene(scene))
    # an explicit path bounds the barrier from above, whatever else there is
    upper = float(model.energies(model.reduce(path)).max())
    # every path passes both ends; each further bound holds for all paths too, so the largest counts
    bounds = [(max(model.energy(model.reduce(s)) for s in states), "the higher of the two minima")]
    open_sets: list[str] = []
    side = side_of_flat(np.array(states))
    if scene.contact == "full" and side[0] * side[1] < 0:
        flat = model.energy(np.zeros(model.size))
        bounds.append((flat, "the flat state separates them (proved)"))
    # a state on a thin set is left through the exits of the set alone
    for number, state in zip(numbers, states, strict=True):
        if number not in known_exits:
            known_exits[number] = proved_exit(model, state) or exits(
                State(model, model.reduce(state)), [model.reduce(y) for y in (at, *others)]
            )
        out = known_exits[number]
        if out.held and not out.complete:
            open_sets.append(
                f"thin set of state {number} not sampled to its end: {out.sampled} states"
            )
        elif out.held:
            what = f"{out.dimension}-dimensional thin set of state {number}"
            known_by = out.proof or f"{out.sampled} states of it sampled"
            bounds.append((out.lowest, f"lowest exit of the {what} ({known_by})"))
    lower, why = max(bounds, key=lambda b: b[0])
    slack = SAME_ENERGY * max(abs(upper), model.scale)
    if upper > lower + slack:
        why = "; ".join([why, *open_sets])
    index = None
    if symmetric.pass_kind in ("saddle", "contact saddle", "corner"):
        critical = critical_at(State(model, model.reduce(at)))
        # directions of negative curvature, symmetry-breaking ones included
        index = critical.index if critical else None
    if upper <= lower + slack:
        verdict = "same"
    else:
        # two directions down: a path goes round such a state lower
        verdict = "lower" if index is not None and index > 1 else "open"
    return FullPass(
        *numbers, symmetric.energy, upper, lower, symmetric.pass_kind, verdict, index, why
    )


def proved_exit(model: Model, fold_angles: np.ndarray) -> Exits | None:
    """Return the exits of the thin set of three closed flaps around a state [N], or None if it is on none."""
    found = flap_exit(model.scene, fold_angles)
    if found is None:
        return None
    held = lower_dimensional_at(State(model, model.reduce(fold_angles)))
    proof = f"proved: phi_{found.hinge} = 0 at every exit"
    return Exits(held, 0, found.energy, model.reduce(found.fold_angles), 2, proof=proof)


def exits(at: State, known: Sequence[np.ndarray] = (), spacing: float = EXIT_SPACING) -> Exits:
    """Sample the thin set around a state evenly, and return its lowest exit.

    Every step along the set is pulled back onto it; a step to a state that is no longer thin has passed an exit,
    which is then bisected.  Steps to inadmissible states end the set there.  Those of `known` [n] that are exits
    of this set count as well: samples have to beat them.
    """
    model, held = at.problem, lower_dimensional_at(at)
    if not held:
        return Exits((), 0, math.inf, None, model.dof)

    def is_lower_dimensional(state: State) -> bool:
        return set(held) <= set(lower_dimensional_at(state))

    seen = [at.x]
    frontier, count, dimension = [at], 1, 0
    lowest, lowest_at = math.inf, None
    for other in map(at.at, known):
        at_limit = set(held) <= set(other.contacts.base)
        if other.energy < lowest and at_limit and not is_lower_dimensional(other):
            lowest, lowest_at = other.energy, other.x
    # invariant: states in `frontier` are on the set, and what is beside them has not been looked at
    while frontier and count < MOST_STATES and len(seen) < 4 * MOST_STATES:
        here = frontier.pop()
        _, slopes = here.local.openings(held)
        tangent = null_space(np.vstack([here.local.closure_jacobian, slopes]))
        dimension = max(dimension, tangent.shape[1])
        for step in _steps(tangent):
            y, residual = project(model, here.x + spacing * step, held)
            # samples about `spacing` apart: a step back to where one has been is no step
            near = np.linalg.norm(np.array(seen) - y, axis=1).min() < 0.7 * spacing
            if residual > CLOSURE_TOL or near:
                continue
            seen.append(y)
            there = at.at(y)
            if not model.fold_limits.inside(y, OUTSIDE).all() or there.refused:
                continue
            if is_lower_dimensional(there):
                frontier.append(there)
                count += 1
                continue
            if min(here.energy, there.energy) >= lowest:
                continue
            out = at.at(last_stratum(here, y, is_lower_dimensional, held)[1])
            if out.energy < lowest:
                lowest, lowest_at = out.energy, out.x
    return Exits(held, count, lowest, lowest_at, dimension, not frontier)


def _steps(tangent: np.ndarray) -> list[np.ndarray]:
    d = tangent.shape[1]
    if not d:
        return []
    return [tangent @ np.array(v) for v in itertools.product((-1.0, 0.0, 1.0), repeat=d) if any(v)]
