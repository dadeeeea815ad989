"""Vertices that people try first, where many facets meet: what judging their states costs."""

from __future__ import annotations

import math
import time

import pytest

from origami_nlp import Scene, Vertex, classify, find_minima
from origami_nlp.minima import find

pytestmark = pytest.mark.slow
h = math.pi / 2
CROWDED = {
    "eight of 45 degrees": (8, (-math.pi, -h, math.pi, h) * 2),
    "six of 60 degrees, alternating": (6, (math.pi, -math.pi) * 3),
    "six of 60 degrees, all but one alike": (6, (math.pi,) * 5 + (-math.pi,)),
}
WANTED = 10.0
"""Processor seconds of a usual machine; a test allows for one three times slower."""


@pytest.mark.parametrize("name", CROWDED)
def test_judging_every_state_of_a_search_takes_seconds(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    n, rest = CROWDED[name]
    scene = Scene(Vertex((2 * math.pi / n,) * n), (1.0,) * n, rest, "none", "full")
    spent = 0.0

    def timed(*arguments, **options):
        nonlocal spent
        begin = time.process_time()
        what = classify(*arguments, **options)
        spent += time.process_time() - begin
        return what

    monkeypatch.setattr(find, "classify", timed)
    assert find_minima(scene).minima
    assert spent < 3 * WANTED
