"""How many states springs can hold at once: random admissible states, the problem, and what it refutes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.designed import interior_states
from benchmarks.problems import random_vertex
from origami_nlp.inverse_design import Target, Targets, solve

DEGREES = range(4, 9)
STATES = range(1, 5)
STIFFNESS = (0.01, 1.0)


@dataclass(frozen=True)
class Prescribed:
    """Questions of one kind.

    Attributes
    ----------
    degree, states
        Creases, and states that were asked for.
    wound
        Whether springs may be wound, up to two turns.
    held, refuted, questions
        How many have springs; how many are proved to have none; how many there were.
    """

    degree: int
    states: int
    wound: bool
    held: int
    refuted: int
    questions: int


def bound(degree: int) -> float:
    """Return 2 N / (N - 3): as many random interior states, or more, ask for more than there are springs to choose."""
    return 2 * degree / (degree - 3)


def random_question(degree: int, number: int, states: int, wound: bool) -> Targets:
    """Return a question of random interior states of a random vertex; the same everywhere, more states added to fewer.

    Parameters
    ----------
    degree, number
        Which vertex.
    states
        How many of its states.
    wound
        Whether springs may be wound, up to two turns.

    Returns
    -------
    Targets
    """
    rng = np.random.default_rng([number, degree, 18])
    scene = random_vertex(rng, degree, "full")
    found = interior_states(scene, rng, max(states, STATES[-1]))[:states]
    named = tuple(Target(f"state {i}", tuple(x.tolist())) for i, x in enumerate(found, start=1))
    return Targets(scene.vertex, named, stiffness=STIFFNESS, preload=wound)


def count_prescribed(
    vertices: int,
    degrees: Sequence[int] = DEGREES,
    progress: Callable[[str], object] = lambda text: None,
) -> tuple[Prescribed, ...]:
    """Ask for one to four random states of so many vertices of each degree, without and with wound springs.

    Parameters
    ----------
    vertices
        Of each degree.
    degrees
        Numbers of creases.
    progress
        Called with words on the progress.

    Returns
    -------
    tuple of Prescribed
    """
    return tuple(_counted(n, vertices, s, w, progress) for n, s, w in _kinds(degrees))


def _kinds(degrees: Sequence[int]) -> Iterator[tuple[int, int, bool]]:
    for n in degrees:
        for wound in (False, True):
            yield from ((n, s, wound) for s in STATES)


def _counted(
    n: int, vertices: int, states: int, wound: bool, progress: Callable[[str], object]
) -> Prescribed:
    held = refuted = 0
    for number in range(vertices):
        progress(f"degree {n}, {states} states, {number + 1} of {vertices}")
        posed = solve(random_question(n, number, states, wound))
        held += posed.feasible
        refuted += not posed.feasible and posed.every_refuted
    return Prescribed(n, states, wound, held, refuted, vertices)


def prescribed_rows(counts: Sequence[Prescribed]) -> tuple[list[str], list[list[str]]]:
    """Return heads and rows of a table, one row for each number of states: how many of the questions have springs."""
    degrees = sorted({c.degree for c in counts})
    heads = ["states", *(f"N = {n}" for n in degrees)]
    rows = [
        ["fewer than 2 N/(N - 3), so at most", *(str(math.ceil(bound(n)) - 1) for n in degrees)]
    ]
    for wound in (False, True):
        for s in STATES:
            some = {c.degree: c for c in counts if c.states == s and c.wound == wound}
            cells = [_cell(some[n]) for n in degrees]
            rows.append([f"{s}{', wound' if wound else ''}", *cells])
    return heads, rows


def _cell(c: Prescribed) -> str:
    open_ones = c.questions - c.held - c.refuted
    return f"{c.held} of {c.questions}" + (f", {open_ones} open" if open_ones else "")
