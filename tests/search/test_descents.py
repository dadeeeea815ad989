"""Ways down: closed and lower at their ends, the same again, without a compiler the same list."""

import numpy as np
import pytest

from origami_nlp import find_minima
from origami_nlp.numerics import SWITCH
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search import FoldedCreases, Follower, Touch, Uniform
from origami_nlp.search.shares import Shares


@pytest.mark.parametrize("kind", [Uniform, FoldedCreases, Touch])
@pytest.mark.parametrize("name", ["yoshimura:2x3", "miura:3x3"])
def test_ends_are_closed_lower_and_do_not_cross(name, kind):
    problem = PatternProblem(as_pattern(name))
    family, rng = kind(problem), np.random.default_rng(1)
    starts, asides = family.draw(rng, 80), rng.normal(size=(80, problem.size))
    legs = Follower(problem).descents(starts, asides, True)
    ways, again = (Follower(problem).each(starts, asides) for _ in range(2))
    arrived = 0
    for leg, way, same in zip(legs, ways, again, strict=True):
        x, why = way()
        assert np.array_equal(x, same()[0])
        if not why:
            arrived += 1
            assert problem.residual(x) < 1e-12 and not problem.refuses(x)
            assert problem.fold_limits.inside(x).all()
            assert problem.scaled_energy(x) <= problem.scaled_energy(leg.begun) + 1e-12
    assert arrived >= 5


def test_without_a_compiler_the_list_is_the_same(monkeypatch):
    def listed():
        return [m.phi for m in find_minima("yoshimura:2x2", starts=40, escape=False).minima]

    compiled = listed()
    monkeypatch.setenv(SWITCH, "0")
    assert not Follower(PatternProblem(as_pattern("yoshimura:2x2"))).descents.usable
    assert np.abs(np.subtract(compiled, listed())).max() < 1e-9


def test_every_family_has_its_turn_and_what_leads_to_more_has_more():
    shares, drawn = Shares(["many", "none"]), []
    for _ in range(1000):
        drawn.append(shares.next())
        shares.work[drawn[-1]] += 100
        shares.new[drawn[-1]] += drawn[-1] == "many"
    assert 200 < drawn.count("none") < drawn.count("many")
