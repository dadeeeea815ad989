"""Barriers of patterns: paths between their states, over curves and over any height."""

import itertools
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.barriers import Known
from origami_nlp.barriers.find import RIGID
from origami_nlp.errors import Interrupted
from origami_nlp.kkt import State, classify
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem, PopSigns
from tests.computed_once import states
from tests.independent.search_sheets import sheet_of


def checked(found) -> None:
    """Paths lead from one minimum to the other, do not cross, climb as high as is said, and change signs where flat."""
    pattern, problem = found.result.pattern, PatternProblem(found.result.pattern)
    for p in found.passes:
        if not len(p.path):
            continue
        ends = [found.result.minima[k - 1].phi for k in (p.from_state, p.to_state)]
        assert all(np.abs(x - y).max() < 1e-6 for x, y in zip(p.path[[0, -1]], ends, strict=True))
        energies = pattern.energy(p.path)
        assert energies.max() == pytest.approx(max(p.path_energy), rel=1e-9)
        assert energies.max() <= p.energy * (1 + 1e-12)
        assert energies.max() >= p.energy * (1 - 1e-9) or p.pass_kind == "bound"
        assert np.abs(np.diff(p.path, axis=0)).max() < 0.5
        for x in p.path:
            assert problem.residual(x) < 1e-12 and not problem.crossings.find(x)
        for vertex in PopSigns(pattern).vertices:
            around = (pattern.ends == vertex).any(axis=1)
            sides = np.sign(np.where(np.abs(s := p.path[:, around].sum(axis=1)) < 1e-9, 0, s))
            passed = [k for k in range(1, len(sides)) if sides[k - 1] * sides[k] < 0]
            assert not passed
            assert not np.abs(p.path[sides == 0][:, around]).any()


def test_the_barrier_of_a_yoshimura(tmp_path):
    """Above 0.372454 J: of the lowest state with its vertex flat, which every path passes."""
    out = tmp_path / "barriers.json"
    o.find_barriers("yoshimura:2x2", states("yoshimura:2x2")).save(out)
    found = o.read_result(out)
    (p,) = found.passes
    flat = float(found.result.pattern.energy(np.zeros(found.result.pattern.creases)))
    assert 0.372453 < p.energy <= flat * (1 + 1e-12) and p.known is Known.BOUND
    checked(found)
    assert found.matrix().max() == p.energy and len(o.draw(found, tmp_path / "b.png").axes) == 1


@pytest.mark.slow  # 28 passes of a sheet
def test_a_twist_passes_through_its_flat_state():
    """Generic vertices of degree 4: one flat, all flat."""
    found = o.find_barriers("squaretwist", o.find_minima("squaretwist", escape=False))
    pattern = found.result.pattern
    flat = float(pattern.energy(np.zeros(pattern.creases)))
    exact = [p for p in found.passes if p.pass_kind == "flat state"]
    assert len(exact) == 6 and all(p.known is Known.EXACT for p in exact)
    assert [p.energy for p in exact] == pytest.approx([flat] * 6, rel=1e-12)
    checked(found)
    others = [p for p in found.passes if math.isinf(p.energy)]
    assert {p.why for p in others} == {RIGID} and len(others) == 22
    # fully folded states are isolated: what closes beside them is there, or beyond fold limits
    sheet, rng = sheet_of(pattern), np.random.default_rng(0)
    alone = [m for m in found.result.minima if not m.local_dimension]
    assert len(alone) == 4 and all((np.abs(m.phi) == math.pi).all() for m in alone)
    for m in alone:
        inward = -np.sign(m.phi) * rng.uniform(0, 0.1, (400, pattern.creases))
        states, closed = sheet.closed(m.phi + inward, 30)
        near = closed & (np.abs(states - m.phi).max(axis=1) < 0.3)
        assert near.sum() > 30 and math.isinf(m.escape.barrier if m.escape else math.inf)
        within = near & (np.abs(states) <= math.pi + 1e-9).all(axis=1)
        assert (np.abs(states[within] - m.phi).max(axis=1) < 1e-3).all()


@pytest.mark.parametrize("signs", ["-++-+-+++-++"])
def test_a_miura_folded_flat_at_all_creases_cannot_move(signs):
    """Planes of motions that closure leaves to second order are shut as well; what closes there is beyond limits."""
    pattern = as_pattern("miura:3x3")
    phi = np.array([math.pi if c == "+" else -math.pi for c in signs])
    what = classify(State(PatternProblem(pattern), phi))
    assert (what.verdict, what.local_dimension) == ("minimum", 0)
    assert what.reason.startswith("isolated: contact closes every direction that closure leaves to")
    rng = np.random.default_rng(0)
    inward = -np.sign(phi) * rng.uniform(0, 0.1, (1000, len(phi)))
    inward *= rng.uniform(size=inward.shape) < 0.5
    states, closed = sheet_of(pattern).closed(phi + inward, 30)
    near = closed & (np.abs(states - phi).max(axis=1) < 0.3)
    assert near.sum() > 900
    assert (np.abs(states[near]).max(axis=1) > math.pi + 1e-6).all()


def test_ctrl_c_keeps_the_paths_that_were_found(monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    result = states("yoshimura:2x2")
    monkeypatch.setattr("origami_nlp.barriers.find.escape_paths_of_each", interrupt)
    with pytest.raises(Interrupted) as stop:
        o.find_barriers("yoshimura:2x2", result)
    found = stop.value.result
    assert found.left_out == ("escape paths", "saddles beside paths") and found.interrupted
    checked(found)
    assert math.isfinite(found.passes[0].energy) and "time limit" not in str(found)


def test_states_and_passes_are_a_graph():
    networkx = pytest.importorskip("networkx")
    found = o.find_barriers("metasheet:2x2", o.find_minima("metasheet:2x2", escape=False))
    graph = found.to_networkx()
    assert [graph.nodes[k]["energy"] for k in graph] == [m.energy for m in found.result.minima]
    assert {d["known"] for *_, d in graph.edges(data=True)} <= {"exact", "bound"}
    # the least highest pass between two states is one of the minimum spanning tree
    tree = networkx.minimum_spanning_tree(graph, weight="energy")
    for i in graph:
        for j in set(graph) - {i}:
            way = networkx.shortest_path(tree, i, j)
            over = max(tree.edges[e]["energy"] for e in itertools.pairwise(way))
            assert over == pytest.approx(found.matrix()[i - 1, j - 1], rel=1e-12)


def test_where_facets_may_cross_paths_close_and_climb_no_higher():
    free = o.find_minima("yoshimura:2x2", contact="fold-limits", starts=2, escape=False)
    pattern = free.pattern
    assert len(free.minima) > 1
    for p in o.find_barriers(pattern, free).passes:
        assert math.isfinite(p.energy) and np.abs(p.path).max() <= math.pi + 1e-12
        assert np.abs(sheet_of(pattern).closure(p.path)[0]).max() < 1e-9
        assert pattern.energy(p.path).max() <= p.energy * (1 + 1e-12)
