"""What a search of a sheet enumerates: flat-folded states, their branch directions, wells and contacts."""

import importlib
import itertools
import math
import time
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
from scipy.spatial.transform import Rotation

import origami_nlp as o
from origami_nlp import examples
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern import make_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import (
    Clearance,
    find_states,
    follow_curve,
    interpolate,
    judge,
    list_branches,
    list_flat_folded,
    tangents,
    wells,
)
from tests.command_line import run
from tests.patterns import metasheet, miura, strip, wheel


def _closes(sectors, phi):
    """Whether a vertex closes, turning about each crease in turn: matrices of scipy."""
    azimuth = np.concatenate([[0.0], np.cumsum(sectors)[:-1]])
    turn = Rotation.identity()
    for a, p in zip(azimuth, phi, strict=True):
        turn = turn * Rotation.from_rotvec(p * np.array([math.cos(a), math.sin(a), 0.0]))
    return turn.magnitude() < 1e-9


@pytest.mark.parametrize("sectors", [(60, 80, 120, 100), (90, 90, 90, 90), (80, 95, 85, 100)])
def test_flat_foldings_of_a_vertex(sectors):
    """All 81 choices; on the paper's sheet are those with an odd number of mountains among four, or pleats."""
    a = np.deg2rad(sectors)
    pattern = wheel(a)
    found = {
        tuple(np.round(x / math.pi).astype(int).tolist())
        for x in list_flat_folded(PatternProblem(pattern, False)).states
    }
    expected = set()
    for choice in itertools.product((0, 1, -1), repeat=4):
        signs = math.pi * np.array(choice, float)
        folded = np.count_nonzero(signs)
        mountains = int((signs < 0).sum())
        # a turn of -pi is one of pi, but for the sheet it is on: a pleat folds both creases alike, four fold 3 : 1
        if _closes(a, signs) and (folded != 2 or mountains != 1) and (folded != 4 or mountains % 2):
            expected.add(choice)
    assert found == expected


def test_ways_across_a_shut_row():
    """A Miura sheet with its first row closed folds on across it; a state there is found without random starts."""
    pattern = examples.pattern("miura", 3, 3)
    straight = np.abs(pattern.directions[:, 1]) < 1e-9
    heights = pattern.corners[pattern.ends[:, 0], 1]
    row = straight & (np.abs(heights - heights[straight].min()) < 1e-9)
    phi = np.where(row, math.pi, 0.0)
    problem = PatternProblem(pattern)
    assert problem.residual(phi) < 1e-13
    ways = list_branches(PatternProblem(pattern), phi)
    across = [d for d in ways.lines if np.abs(d[row]).max() < 1e-6]
    assert across
    for d in across:
        closed, residual = problem.project(phi + 0.3 * d / np.abs(d).max(), row)
        assert residual < 1e-13 and np.abs(closed - phi).max() > 0.2
        assert pattern.creases - problem.rank(closed) == 1


def test_all_wells_of_a_curve_in_long_steps():
    """As a fine scan of its energy sees them."""
    pattern = strip(0)
    problem = PatternProblem(pattern)
    line = list_branches(PatternProblem(pattern)).lines[0]
    phi, _ = problem.project(0.2 * line / np.abs(line).max())
    curve = interpolate(problem, follow_curve(problem, phi, tangents(problem, phi)[:, 0], 0.3))
    fine = np.array(
        [
            curve.at(k, u)
            for k in range(len(curve.control))
            for u in np.linspace(0, 1, 200, endpoint=False)
        ]
    )
    energy = np.array([problem.scaled_energy(x) for x in fine])
    inside = np.flatnonzero((energy[1:-1] < energy[:-2]) & (energy[1:-1] < energy[2:])) + 1
    found = [x for x in wells(problem, curve) if np.abs(x).max() < math.pi - 1e-9]
    assert len(found) == len(inside)
    for i in inside:
        assert min(np.abs(x - fine[i]).max() for x in found) < 5e-3
    assert max(problem.residual(x) for x in found) < 1e-5


def curves(pattern, many, step):
    problem = PatternProblem(pattern)
    for line in list_branches(PatternProblem(pattern)).lines[:many]:
        phi, _ = problem.project(0.4 * line / np.abs(line).max())
        yield (
            problem,
            interpolate(problem, follow_curve(problem, phi, tangents(problem, phi)[:, 0], step)),
        )


def parted(a, b, common):
    """Whether a plane parts two polygons [q, 3], through their common corner if they have one: a linear program."""
    if common is not None:
        a, b = ((x - common)[np.abs(x - common).max(axis=1) > 1e-9] for x in (a, b))
    rows = np.vstack(
        [np.column_stack([a, -np.ones(len(a))]), np.column_stack([-b, np.ones(len(b))])]
    )
    free = (None, None)
    last = free if common is None else (0.0, 0.0)
    found = scipy.optimize.linprog(
        np.zeros(4), rows, -np.ones(len(rows)), bounds=[free] * 3 + [last]
    )
    return found.status == 0


@pytest.mark.parametrize("pattern", [miura(3, 3), metasheet(3)[0]], ids=["miura", "metasheet"])
def test_facets_shown_to_be_apart_over_a_step_are_parted_inside_it(pattern):
    """By linear programs at states inside, drawn; and most steps of these curves need no halving."""
    rng, asked = np.random.default_rng(0), 0
    for problem, curve in curves(pattern, 2, 0.15):
        clearance, c = Clearance(problem), problem.crossings
        motions = [c.poses.motions(x) for x in curve.states]
        turn, shift = (np.array(x) for x in zip(*motions, strict=True))
        every = np.arange(len(clearance.first))
        ends = (turn[:-1], shift[:-1]), (turn[1:], shift[1:])
        step, pair, _ = clearance.touching(*ends, curve.control, every)
        apart = np.ones((len(curve.control), len(every)), bool)
        apart[step, pair] = False
        assert apart.mean() > 0.6
        for s, k in rng.permutation(np.argwhere(apart))[:60]:
            placed = c.placed(curve.at(s, rng.uniform()))
            i, j = clearance.first[k], clearance.second[k]
            shared = set(c.pieces[i].tolist()) & set(c.pieces[j].tolist())
            common = placed[i][c.pieces[i].tolist().index(shared.pop())] if shared else None
            assert parted(placed[i], placed[j], common)
            asked += 1
    assert asked == 120


def test_corners_are_no_further_off_their_chords_than_stated():
    """As one facet sees another: its own frame, from three corners."""
    rng = np.random.default_rng(1)
    for problem, curve in curves(miura(3, 3), 2, 0.15):
        clearance, c = Clearance(problem), problem.crossings
        bound = clearance.remainders(curve.control) * c.size

        def seen(x, i, j, c=c):
            placed = c.placed(x)
            first, second = placed[i][1] - placed[i][0], placed[i][2] - placed[i][0]
            first = first / np.linalg.norm(first)
            second = second - first * (first @ second)
            second = second / np.linalg.norm(second)
            frame = np.column_stack([first, second, np.cross(first, second)])
            return (placed[j] - placed[i][0]) @ frame

        for s in rng.integers(len(curve.control), size=40):
            k = rng.integers(len(clearance.first))
            u = rng.uniform()
            i, j = clearance.first[k], clearance.second[k]
            if set(c.pieces[i].tolist()) & set(c.pieces[j].tolist()):
                continue
            both = []
            for a, b in ((i, j), (j, i)):
                before, inside, after = (seen(curve.at(s, v), a, b) for v in (0.0, u, 1.0))
                chord = (1 - u) * before + u * after
                both.append(np.linalg.norm(inside - chord, axis=1).max())
            assert min(both) <= bound[s, k] + 1e-9


def test_the_unit_of_length_does_not_part_facets():
    """By powers of two nothing rounds differently: along a motion the same facets are seen to cross."""
    seen = []
    for scale in (1.0, 2.0**-30):
        pattern, _ = metasheet(3)
        problem = PatternProblem(replace(pattern, corners=scale * pattern.corners))
        line = list_branches(PatternProblem(pattern)).lines[1]
        phi, _ = problem.project(0.2 * line / np.abs(line).max())
        curve = interpolate(problem, follow_curve(problem, phi, tangents(problem, phi)[:, 0], 0.3))
        seen.append(Clearance(problem).along(curve))
    one, other = seen
    assert (one.unclear == other.unclear).all() and (one.states == other.states).all()
    assert (one.crosses == other.crosses).all() and one.crosses.any()


def test_one_facet_has_nothing_to_fold():
    alone = make_pattern(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), [(0, 1, 2)])
    with pytest.raises(o.OrigamiError, match="no crease"):
        find_states(alone, starts=1)


@pytest.mark.parametrize(
    ("name", "size", "part"),
    [
        ("degree8", (), "random starts"),
        ("miura", (8, 8), "random starts"),
    ],
)
def test_a_search_ends_in_its_time_and_says_what_it_left_out(name, size, part):
    """Each of them takes several seconds to its end, most of them tens."""
    pattern = examples.pattern(name, *size).with_springs(1.0, 1.0)
    seconds, begin = 0.4, time.process_time()
    found = find_states(pattern, seconds=seconds)
    assert time.process_time() - begin < 2 * seconds + 4
    assert part in found.search.left_out
    for state in found.states:  # what was found is whole
        again = judge(PatternProblem(pattern), state.phi)
        assert (again.verdict, again.kind) == (state.verdict, state.kind)
    assert MinimaResult.from_dict(found.to_dict()).search == found.search


def stopped(monkeypatch, after):
    """The user interrupts the search at this random start."""
    shares = importlib.import_module("origami_nlp.search.shares").Shares
    draw, drawn = shares.next, []

    def following(self):
        drawn.append(1)
        if len(drawn) > after:
            raise KeyboardInterrupt
        return draw(self)

    monkeypatch.setattr(shares, "next", following)


def test_an_interrupted_search_keeps_what_it_found(monkeypatch, tmp_path):
    whole = find_states("metasheet:3x3", starts=2)
    stopped(monkeypatch, 1)
    with pytest.raises(KeyboardInterrupt) as end:  # as programs expect it
        find_states("metasheet:3x3", starts=200)
    found = end.value.result
    assert found.search.interrupted and found.search.left_out[0] == "random starts"
    assert "interrupted, not through with: random starts" in str(found)
    assert [m.energy for m in found.minima] == pytest.approx([m.energy for m in whole.minima])
    file = tmp_path / "found.json"
    code, out, err = run("minima", "metasheet:3x3", "-o", file)
    assert code == 130 and "interrupted" in err and f"written: {file}" in out
    again = o.read_result(file)
    assert again.search.interrupted and len(again.minima) == len(found.minima)


def test_a_search_that_has_time_leaves_nothing_out():
    found = o.find_minima("miura:2x2", starts=1, contact="fold-limits", seconds=3600.0)
    assert not found.search.left_out
    nothing = o.find_minima(strip(3), starts=1, contact="fold-limits", seconds=0.0)
    assert not nothing.states and "what the pattern gives" in nothing.search.left_out
