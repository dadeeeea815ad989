"""Where descents begin: starts are drawn again from the same seed, hold what they say, and wells have their turn."""

import inspect
import itertools
import math

import numpy as np
import pytest

from origami_nlp import examples, search
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import detent, double_well, linear, polynomial, sum_of
from origami_nlp.pattern_problem import PatternProblem, find_labels
from origami_nlp.search import (
    CLOSES_NOT,
    Changed,
    CompiledDescent,
    FoldedCreases,
    Touch,
    other_wells,
)
from origami_nlp.search.starts import lines_at_wells, straight_lines
from tests.independent.search_sheets import sheet_of
from tests.patterns import grid

PATTERN = examples.pattern("yoshimura", 2, 3)
PROBLEM = PatternProblem(PATTERN)
STATES = np.random.default_rng(0).uniform(-3, 3, (3, PATTERN.creases))
KINDS = [
    one
    for name in dir(search)
    if inspect.isclass(one := getattr(search, name))
    and issubclass(one, search.StartKind)
    and not inspect.isabstract(one)
]


def drawn(kind, seed, many):
    """Starts that a family draws; of changed states, of those of `STATES`."""
    family, rng = kind(PROBLEM), np.random.default_rng(seed)
    if kind is Changed:
        assert not family.draw(rng, many)  # there is nothing to change yet
        for x in STATES:
            family.add(x)
    return family.draw(rng, many)


def test_the_table_of_the_room_has_every_family_with_its_sentence():
    rows = (line.strip("|").split("|") for line in search.__doc__.splitlines() if line[:3] == "| `")
    said = {name.strip(" `"): sentence.strip() for name, sentence in rows}
    assert said == {one.__name__: one.sentence for one in KINDS}
    assert len({one.name for one in KINDS}) == len(KINDS)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_the_same_generator_gives_the_same_starts(kind):
    one, two, other = (drawn(kind, seed, 5) for seed in (3, 3, 4))
    assert len(one) == 5
    for a, b in zip(one, two, strict=True):
        assert np.array_equal(a.x, b.x) and np.array_equal(a.side, b.side)
        assert a.picks == b.picks
    assert not all(np.array_equal(a.x, b.x) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("kind", [FoldedCreases, Touch])
def test_what_is_held_is_there_and_starts_close(kind):
    descents, starts = CompiledDescent(PROBLEM), drawn(kind, 1, 60)
    if not descents.usable:
        pytest.skip("no compiler: descents are not compiled")
    ends = descents(starts, np.ones((60, PROBLEM.size)), pauses=True)
    begun = [(s, e) for s, e in zip(starts, ends, strict=True) if e.why != CLOSES_NOT]
    assert len(begun) >= 10
    for start, end in begun:
        x, side = end.begun, start.side
        assert end.held and PROBLEM.residual(x) <= CLOSURE_TOL
        assert side.any() if kind is FoldedCreases else start.picks
        assert np.abs(x[side != 0] - math.pi * side[side != 0]).max(initial=0.0) < 1e-12


def test_minima_are_changed_in_three_ways_in_turn():
    at = np.array([s.x for s in drawn(Changed, 1, 48)])
    same = np.abs(at[:, None] - STATES) == 0  # [48, 3, n]
    pairs = [same[:, a] | same[:, b] for a, b in itertools.combinations(range(3), 2)]
    of_two = np.any([pair.all(axis=1) for pair in pairs], axis=0)
    # round vertices, or at each crease, as one of two has them
    assert of_two[0::3].all() and of_two[2::3].all()
    counts = same.sum(axis=2).max(axis=1)[1::3]
    assert counts.min() == PATTERN.creases - 1


def test_a_hinge_goes_to_each_of_its_other_wells_and_to_a_limit_that_it_is_pushed_to():
    pattern = examples.pattern("metasheet", 2, 2)
    labels, phi = find_labels(pattern), np.array([0.7, -0.7, 0.1, 0.0])
    laws = [double_well(1.0, 0.7), double_well(1.0, 0.7), linear(1.0, 0.0), polynomial([-0.5], 0.0)]
    starts = other_wells(pattern.with_laws(laws), labels, phi)
    moved = {tuple(np.round(x, 9)) for x in starts}
    pi = round(math.pi, 9)
    wanted = {(-0.7, -0.7, 0.1, 0.0), (0.7, 0.7, 0.1, 0.0)}
    # pushed off 0: it rests at either limit
    assert moved == wanted | {(0.7, -0.7, 0.1, pi)} or moved == wanted | {(0.7, -0.7, 0.1, -pi)}


def test_straight_lines_fold_alone_to_their_wells():
    """Of a sheet in other rows and columns; all that is given closes exactly; of lines that cross one is folded."""
    law = sum_of([linear(1.0), detent(1.0, 5)])
    rests = law.rests(-math.pi, math.pi)
    for rows, columns in ((3, 3), (2, 4)):
        pattern = examples.pattern("miura", rows, columns)
        lines = straight_lines(pattern)
        assert sorted(map(len, lines)) == [columns] * (rows - 1)
        starts = list(lines_at_wells(pattern.with_laws([law] * pattern.creases)))
        assert len(starts) == len(rests) ** (rows - 1) - 1
        closed, good = sheet_of(pattern).closed(np.array(starts), 0)
        assert good.all() and np.array_equal(closed, starts)
        assert not list(lines_at_wells(pattern))
    # a cross: two lines, of which one folds at a time
    cross = grid(np.array([[[x, y] for x in range(3)] for y in range(3)], float))
    starts = np.array(list(lines_at_wells(cross.with_laws([law] * 4))))
    assert len(straight_lines(cross)) == 2 and len(starts) == 2 * (len(rests) - 1)
    assert ((starts != 0).sum(axis=1) == 2).all()
