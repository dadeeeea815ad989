"""Sheets of thousands of facets: limits of wall time are kept by every search, and each says where it is."""

import time
from contextlib import suppress
from functools import cache

import pytest

from origami_nlp import find_barriers, find_minima, follow, load_path
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.pattern import as_pattern
from tests.computed_once import thinned

LATE = 1.0
"""Seconds by which a limit of wall time may be passed; of those that the process had, as other processes run."""
LIMIT = 1.5
"""Seconds that a search is given."""
LONG, WIDE = "miura:48x48", "waterbomb:20x20"
"""Of 2,304 and 2,400 facets."""
SEARCHES = {
    "minima": lambda sheet, seconds: find_minima(sheet, seconds=seconds),
    "follow": lambda sheet, seconds: follow(sheet, "ratio=0.5:2", seconds=seconds),
    "barriers": lambda sheet, seconds: find_barriers(sheet, seconds=seconds),
    "load": lambda sheet, seconds: load_path(sheet, [1], seconds=seconds),
}


@cache
def warm(search):
    """Import and compile what a search uses: that is none of its time."""
    with suppress(OptionError):  # 2 s of a busy machine may not do for a path
        SEARCHES[search](as_pattern("miura:2x2"), 2.0)


@pytest.mark.parametrize(
    ("search", "sheet"),
    thinned([("minima", WIDE), ("minima", LONG), ("barriers", LONG), ("barriers", WIDE)], 4)
    + thinned([("load", LONG), ("load", WIDE), ("follow", WIDE), ("follow", LONG)], 4),
)
def test_limits_of_wall_time_are_kept_on_large_sheets(search, sheet):
    warm(search)
    pattern = as_pattern(sheet)
    begin, worked = time.perf_counter(), time.process_time()
    try:
        found = SEARCHES[search](pattern, LIMIT)
    except OptionError as error:  # no stable state to load is known
        assert search == "load" and ("time was over" in str(error) or "stable state" in str(error))
        found = None
    wall, worked = time.perf_counter() - begin, time.process_time() - worked
    # beside other processes a second of work takes longer
    assert wall < LIMIT + LATE * max(1.0, wall / worked)
    if found is not None:
        assert OUT_OF_TIME in str(found)


def test_searches_of_sheets_say_where_they_are():
    said, energies = [], []
    result = find_minima(
        "miura:2x2",
        starts=2,
        progress=lambda starts, minima, at: said.append((starts, minima, at)),
        found=lambda energy, phi: energies.append((energy, phi)),
    )
    assert {m.energy for m in result.minima} <= {energy for energy, _ in energies}
    assert [starts for starts, *_ in said] == sorted(starts for starts, *_ in said)
    assert said[-1][:2] == (result.search.starts, len(result.minima))
    assert "random starts" in {at for *_, at in said}
    words = []
    follow("miura:2x2", "ratio=0.5:2", checks=1, starts=1, progress=words.append)
    assert words[0] == "search at ratio = 1" and "arcs followed, now from ratio" in words[-1]
