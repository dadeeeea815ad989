"""Patterns for which what is compiled is compared with NumPy."""

import pytest

from origami_nlp import examples
from origami_nlp.numerics import SWITCH
from origami_nlp.pattern_problem import PatternProblem
from tests.patterns import miura, strip

HOLE = ((1, 2), (1, 3), (2, 2), (2, 3))
PATTERNS = {
    "miura": lambda: examples.pattern("miura", 6, 6),
    "waterbomb": lambda: examples.pattern("waterbomb", 3, 3),
    "hole": lambda: miura(5, 5, without=HOLE),
    "strip": lambda: strip(1),
    "cell": lambda: examples.pattern("miura", 2, 2, cell=True),
}
"""Vertices, a hole (translations close as well), a pattern without symmetry, and lattice vectors."""


def with_and_without(name: str, monkeypatch) -> tuple[PatternProblem, PatternProblem]:
    """Return a problem with what is compiled, and the same without."""
    pattern = PATTERNS[name]()
    one, other = PatternProblem(pattern), PatternProblem(pattern)
    if not one.closure.compiled.usable:
        pytest.skip("no C compiler, or it is switched off")
    with monkeypatch.context() as patched:
        patched.setenv(SWITCH, "0")
        assert not other.closure.compiled.usable and other.crossings.poses.compiled is None
    return one, other
