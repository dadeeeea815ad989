"""Sheets with hinge laws start from their straight lines, folded to wells."""

import math

import numpy as np

from origami_nlp import examples
from origami_nlp.pattern import detent, linear, sum_of
from origami_nlp.starts.of_patterns import lines_at_wells, straight_lines
from tests.independent.search_sheets import sheet_of
from tests.patterns import grid


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
