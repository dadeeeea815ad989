"""A search of a vertex that the user interrupts: what it had found comes with the exception, judged as ever."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import Interrupted

SCENE = o.examples.degree6("pi/4", ratio=1)


def interrupted(after):
    """A `found` that stops the search at so many minima."""
    seen = []

    def found(energy, _):
        seen.append(energy)
        if len(seen) == after:
            raise KeyboardInterrupt

    return found


def told(m):
    return m.kind, m.certificate, *np.round([m.energy, *m.fold_angles], 9).tolist()


def test_what_was_found_is_kept():
    whole = {told(m) for m in o.find_minima(SCENE, prove=False).minima}
    with pytest.raises(Interrupted) as stop:
        o.find_minima(SCENE, found=interrupted(1))
    result = stop.value.result
    assert result.search.interrupted and result.search.stopped_by == "time"
    assert result.minima and result.completeness is None
    assert {told(m) for m in result.minima} <= whole


def test_one_that_had_found_nothing_decides_nothing():
    found = o.find_minima(o.examples.degree6("pi/3", ratio=1, symmetry="none"), seconds=0)
    assert not found.minima
    assert "not decided whether there is a stable state: none was found; interrupted" in str(found)
