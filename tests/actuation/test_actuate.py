"""Torques on creases: what they start, against the lists of the sources, enumeration and descents of our own."""

import json
import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.actuation import driven_set
from origami_nlp.errors import OptionError
from origami_nlp.pattern import make_pattern
from tests.command_line import run, scene_file
from tests.computed_once import thinned
from tests.independent.flat_descents import Sheet
from tests.patterns import grid, metasheet

QUADS = {
    "generic": [(0, 0), (1.0, 0.1), (1.25, 0.9), (0.1, 1.2)],
    "another": [(0, 0), (1.1, -0.2), (1.3, 0.8), (-0.1, 1.0)],
    "a third": [(0, 0), (0.9, 0.15), (1.4, 1.1), (0.2, 0.8)],
    "chicken wire": [(0, 0), (1.0, 0.0), (0.8, 0.7), (0.2, 0.7)],
}


def tiling(quad, rows, columns):
    """Copies of a quadrilateral, each turned by half about the middle of the side that it shares with the next."""
    tiles, points = {}, {}
    for i in range(rows):
        for j in range(columns):
            if i == j == 0:
                tiles[i, j] = np.array(quad, float)
                continue
            before = tiles[(i, j - 1) if j else (i - 1, j)]
            turned = (i + j - 1) % 2
            a, b = ((3, 0) if turned else (1, 2)) if j else ((0, 1) if turned else (2, 3))
            tiles[i, j] = before[a] + before[b] - before
    polygons = [
        [points.setdefault(tuple(np.round(x, 9)), len(points)) for x in tile]
        for tile in tiles.values()
    ]
    return make_pattern(np.array(list(points)), polygons).with_springs(0.02, 0.0)


def sheets():
    generic = {f"{k} {m}x{n}": tiling(QUADS[k], m, n) for k in QUADS for m, n in ((3, 3), (3, 4))}
    named = {name: o.examples.pattern(name) for name in ("miura:3x3", "miura:3x4", "metasheet:3x3")}
    return generic | {k: p.with_springs(0.02, 0.0) for k, p in named.items()}


CAN = {name: "generic" in name or "a" == name[0] or "metasheet" in name for name in sheets()}
"""Hull and Tachi 2018: unique for generic tiles turned about midpoints; Miura and chicken wire are not."""


@pytest.mark.parametrize("name", CAN)
def test_which_tilings_fold_uniquely_is_what_the_source_says(name):
    sheet = sheets()[name]
    seen = o.actuate(sheet)
    assert seen.can_be_unique is CAN[name] and seen.unique is None
    # a second way: modes of each vertex, one of two each, and ranks
    bases = Sheet(sheet.corners, sheet.ends).velocities()
    assert sorted(b.shape[1] for b in bases) == sorted(b.velocities.shape[1] for b in seen.branches)
    for branch in seen.branches:
        same = [
            np.abs(b @ (b.T @ branch.velocities) - branch.velocities).max() < 1e-6 for b in bases
        ]
        assert sum(same) == 1
        others = [b for b, mine in zip(bases, same, strict=True) if not mine]
        rest = np.column_stack([np.zeros((sheet.creases, 1)), *others])
        rank = [np.linalg.matrix_rank(m, 1e-7) for m in (rest, np.c_[rest, branch.velocities])]
        assert branch.drivable is bool(rank[1] > rank[0])


@pytest.mark.parametrize("name", ["generic 3x3", "metasheet:3x3"])
def test_the_fewest_creases_start_their_branch_alone_and_fewer_do_not(name):
    sheet = sheets()[name]
    seen = o.actuate(sheet)
    for driven in seen.driven:
        assert driven.fewest and len(driven.creases) == 2
        torques = {c: 0.01 * t for c, t in zip(driven.creases, driven.torques, strict=True)}
        one = o.actuate(sheet, torques)
        assert one.unique and one.started == (driven.branch,) and len(one.reached) == 1
        work = 0.01 * driven.work
        assert one.branches[driven.branch - 1].work == pytest.approx(work, rel=1e-6)
    for crease in range(1, sheet.creases + 1):
        assert o.actuate(sheet, {crease: 0.01}).unique is False


def test_sets_that_are_not_gone_through_are_left_by_leaving_out():
    rng = np.random.default_rng(3)
    target, others = rng.normal(size=(6, 1)), rng.normal(size=(6, 2))
    few = driven_set(1, target, others)
    more = driven_set(1, target, others, 10)
    assert few.fewest and not more.fewest and len(few.creases) == len(more.creases) == 3
    for found in (few, more):
        torques = np.zeros(6)
        torques[np.array(found.creases) - 1] = found.torques
        assert np.abs(torques @ others).max() < 1e-9 and abs(torques @ target).item() > 1e-3
    assert driven_set(1, others @ [[1.0], [2.0]], others) is None


def test_signs_alone_are_enough_where_some_sizes_work_on_one_branch_only():
    """On two creases of a generic vertex: those of the vector without work on the other branch, and no others."""
    scene = o.Scene(
        o.Vertex.from_degrees((70, 95, 108, 87)), (0.02,) * 4, (0.0,) * 4, symmetry="none"
    )
    sheet = o.actuate(scene).pattern
    mine = Sheet(sheet.corners, sheet.ends)
    modes = [m[np.argsort(mine.rings[0][0])] for m in mine.modes()[0]]
    for i, j in ((0, 1), (0, 2), (1, 3)):
        alone = {tuple(np.sign([s * m[j], -s * m[i]])) for m in modes for s in (1, -1)}
        for pair in product((1, -1), repeat=2):
            seen = o.actuate(scene, {i + 1: "-+"[pair[0] > 0], j + 1: "-+"[pair[1] > 0]})
            assert seen.can_be_unique is (pair in alone) and seen.unique is None
            for driven in seen.driven:
                assert tuple(np.sign(driven.torques)) == pair
                sizes = dict(zip(driven.creases, np.multiply(driven.torques, 0.01), strict=True))
                assert o.actuate(scene, sizes).started == (driven.branch,)
    assert o.actuate(scene, {1: "+"}).can_be_unique is False
    assert "always" in str(o.actuate(scene, {1: "+"}))


def ends_of(sheet, load, draws):
    """States in which sheets that were pushed out of the flat state at random come to rest, each once."""
    mine, rng, ends = Sheet(sheet.corners, sheet.ends), np.random.default_rng(7), []
    for _ in range(draws):
        begun = mine.closed(rng.normal(0, 0.1, sheet.creases), far=1.0)
        end = None if begun is None else mine.descend(begun, sheet.stiffness, load)
        if end is None or np.abs(end).max() < 1e-3:  # back at the flat state: to be pushed again
            continue
        if not any(np.abs(end - e).max() < 1e-4 for e in ends):
            ends.append(end)
    return ends


LOADS = {
    "one Miura vertex, crease 1": ("miura:2x2", {1: 0.01}),
    "one Miura vertex, crease 2": ("miura:2x2", {2: 0.01}),
    "one Miura vertex, creases 2 and 3": ("miura:2x2", {2: 0.01, 3: 0.01}),
    "Miura": ("miura:3x3", {1: 0.01, 3: 0.02}),
    "generic, crease 1": ("generic 3x3", {1: 0.01}),
    "generic, two creases": ("generic 3x3", None),
}


@pytest.mark.parametrize("draws", [12, pytest.param(50, marks=pytest.mark.slow)])
@pytest.mark.parametrize("case", thinned(list(LOADS)[::-1], 2))
def test_random_pushes_out_of_the_flat_state_end_where_it_says(case, draws):
    name, torques = LOADS[case]
    sheet = sheets()[name] if name in CAN else o.examples.pattern(name).with_springs(0.02, 0.0)
    if torques is None:
        (driven, _) = o.actuate(sheet).driven
        torques = {c: 0.01 * t for c, t in zip(driven.creases, driven.torques, strict=True)}
    seen = o.actuate(sheet, torques)
    ends = ends_of(sheet, seen.loads[0], draws)
    assert len(ends) == len(seen.reached) == len(seen.started) and seen.unique is (len(ends) == 1)
    for state in seen.reached:
        assert state.verdict == "minimum"
        assert min(np.abs(state.phi - end).max() for end in ends) < 1e-4


def shallow():
    vertex = o.Vertex.from_degrees((70, 95, 108, 87))
    return o.Scene(vertex, (0.02,) * 4, (0.8, -1.2, 0.5, 1.0), symmetry="none")


def test_the_graph_of_states_is_that_of_load_paths():
    loads = [{1: 0.1}, {1: -0.1}, {2: 0.1}, {2: -0.1}]
    seen = o.actuate(shallow(), loads, start="all")
    assert len(seen.states) == len(o.find_minima(shallow(), prove=False).minima) == 2
    led = {(t.start, t.load): t for t in seen.transitions}
    assert len(led) == 8 and [led[1, k].end for k in (1, 2, 3, 4)] == [1] * 4
    assert [led[2, k].end for k in (1, 2, 3, 4)] == [2, 1, 1, 2]
    for k in (1, 3):  # one load makes state 2 snap, one does not
        ((crease, size),) = loads[k].items()
        path = o.load_path(
            shallow(), crease, to=size, state=2, unload=True, confirm=False, full=False
        )
        snaps = [s.t / size for s in path.snaps]
        assert led[2, k + 1].snaps == pytest.approx(snaps, rel=1e-6)
        at = np.array(path.legs[-1].points[-1].fold_angles)
        assert np.abs(at - seen.states[led[2, k + 1].end - 1].phi).max() < 1e-5
    walk = o.actuate(shallow(), [loads[0], loads[1], loads[1]], start=2).walk
    assert walk == (2, 2, 1, 1)


def test_a_load_leaves_the_flat_state_along_the_branch_that_it_works_on():
    """On its way along one branch a state comes to the flat one: from there it must go along the other."""
    from origami_nlp.pattern import scene_pattern

    sheet = scene_pattern(shallow())
    path = o.load_path(sheet, 1, to=-0.03, state=2, confirm=False)
    (snap,) = path.snaps
    assert snap.type == "flat state" and not np.any(snap.before)
    load = np.array(shallow().stiffness) * shallow().rest_angles + snap.t * np.eye(4)[0]
    mine = Sheet(sheet.corners, sheet.ends)
    ring = mine.rings[0][0]
    works = [abs(float(load[ring] @ v)) / np.linalg.norm(v) for v in mine.modes()[0]]
    assert min(works) < 1e-9 and max(works) > 1e-3
    rng, rest = np.random.default_rng(1), load / 0.02
    ends = [
        mine.descend(mine.closed(rng.normal(0, 1e-3, 4)), sheet.stiffness, 0.02 * rest)
        for _ in range(5)
    ]
    assert max(np.abs(end - snap.after).max() for end in ends) < 1e-5


def test_a_walk_from_flat_goes_back_to_it_where_springs_rest_there():
    sheet = o.examples.pattern("miura:2x2")
    seen = o.actuate(sheet, [{1: 0.03}, {2: -0.03}], relaxed=True)
    assert seen.walk == (0, 0, 0) and not seen.states
    assert {t.end for t in seen.transitions} == {0} and len(seen.transitions) == 3


def test_what_is_not_enumerated_is_not_decided():
    seen = o.actuate("waterbomb:1x2", {1: 0.01})
    assert seen.unique is None and seen.can_be_unique is None and not seen.branches
    assert "2 vertices have cones" in seen.verdict


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (({5: 0.01}, {}), "crease = 5"),
        (({1: float("nan")}, {}), "torque on crease 1"),
        (({1: 0.0}, {}), "all of them are 0"),
        ((None, {"start": 1}), "torques is missing"),
        (({1: 0.1}, {"start": "open"}), "start = 'open'"),
        (({1: 0.1}, {"start": 9}), "start = 9"),
        (([0.1], {}), "must be {crease: torque}"),
        (({1: "+", 2: 0.1}, {}), "numbers, or '\\+' or '-'"),
        (({1: "+"}, {}), "at rest when flat"),
        (({1: "+"}, {"start": "all", "relaxed": True}), "signs alone act on the flat state"),
    ],
)
def test_wrong_arguments_are_named(asked, said):
    torques, more = asked
    with pytest.raises(o.OrigamiError, match=said):
        o.actuate("miura:2x2", torques, **more)


def test_the_command_says_the_same_and_writes_it(tmp_path):
    out = tmp_path / "seen.json"
    done = run(
        "actuate",
        "miura:2x2",
        "--relaxed",
        "--torques",
        "2=0.01,3=0.01",
        "-o",
        out,
        "-o",
        tmp_path / "a.png",
    )
    assert done.code == 0 and "fold it uniquely" in done.out
    again = o.load(out)
    assert again.unique and json.loads(out.read_text())["unique"] is True
    assert again.to_dict() == o.actuate("miura:2x2", {2: 0.01, 3: 0.01}, relaxed=True).to_dict()
    signs = run("actuate", "miura:2x2", "--relaxed", "--torques", "2=+,3=-", "-o", out)
    assert signs.code == 0 and o.load(out).signs == (0, 1, -1, 0)
    assert run("actuate", "miura:2x2", "--torques", "2").code == 2
    assert (
        run(
            "actuate", scene_file(tmp_path, shallow()), "--start", "all", "--torques", "1=-0.1"
        ).code
        == 0
    )


def test_shares_of_a_torque_follow_what_winds_the_springs():
    """A load path under shares is that of springs that are wound by them."""
    from origami_nlp.pattern_problem import Torque

    sheet = o.examples.pattern("metasheet:2x3")
    torque = Torque(sheet, (1, 3), (1.0, -0.5))
    state = o.find_minima(sheet, effort="quick", starts=2, escape=False).minima[0]
    end = o.load_path(sheet, torque, to=0.01, state=state, confirm=False).legs[-1].points[-1]
    wound = torque.loaded(0.01)
    found = o.classify(wound, end.fold_angles)
    assert found.verdict == "minimum"
    assert torque.room(0.01) == pytest.approx(
        float((wound.stiffness * wound.rest**2 - sheet.stiffness * sheet.rest**2).sum()) / 2,
        rel=1e-9,
    )
    for wrong in ((1.0,), (0.0, 0.0)):
        with pytest.raises(o.OrigamiError, match="shares"):
            Torque(sheet, (1, 3), wrong)


def test_the_examples_of_the_package_are_tilings_turned_about_midpoints():
    assert o.actuate(metasheet(3)[0]).can_be_unique
    i, j = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    assert o.actuate(grid(np.stack([i, j], axis=2))).can_be_unique is False  # squares


def test_stops_of_the_flat_state_are_in_the_way():
    """Along a branch three creases fold one way and one the other (Kawasaki), and x and -x are both closed to first
    order: a stop at 0 leaves one way, stops on all creases none."""
    scene = o.Scene(o.Vertex.from_degrees((70, 80, 120, 90)), (1,) * 4, (0,) * 4, "none")
    free = o.actuate(scene)
    assert len(free.branches) == 2
    for crease in range(4):
        for pair in ((0.0, math.pi), (-math.pi, 0.0)):
            limits = [(-math.pi, math.pi)] * 4
            limits[crease] = pair
            found = o.actuate(replace(scene, limits=limits))
            assert len(found.branches) == 2
            side = 1 if pair[0] == 0.0 else -1
            assert all(side * b.velocities[crease, 0] > 0 for b in found.branches)
    held = o.actuate(replace(scene, limits=(0.0, math.pi)))
    assert not held.branches and held.can_be_unique is None
    with pytest.raises(OptionError, match="beyond the stop of crease 3"):
        o.actuate(replace(scene, limits=[(-1, 1), (-1, 1), (0.2, 1), (-1, 1)]))
    six = o.Scene(
        o.Vertex(("pi/3",) * 6), (1,) * 6, (0,) * 6, "none", limits=[(0, 3)] + [(-3, 3)] * 5
    )
    cut = o.actuate(six)
    assert not cut.reason and [b.kind for b in cut.branches] == ["cone"] * 2
