"""Branch and prune excludes nothing that closes: its tree, replayed at states that close and at critical points."""

import math

import numpy as np
import pytest

from benchmarks import family_scene
from origami_nlp import Model, find_minima
from origami_nlp.pattern import examples
from origami_nlp.problem import random_strata
from origami_nlp.proof import NodeKind, Proof, Tree, prove
from origami_nlp.proof.boxes import BEYOND, strata
from tests.computed_once import shared, thinned

OUTSIDE = 1e-9
"""A state in doubles closes to 1e-14; by how much [rad] it may lie outside a box that holds the exact one."""


class Replay:
    """Walks a tree from the box of a stratum to the leaf that holds a state."""

    def __init__(self, tree: Tree, size: int) -> None:
        self.tree = tree
        self.start = strata(size)
        self.children: list[list[int]] = [[] for _ in tree.kind]
        open_: list[int] = []
        self.roots = []
        for node, kind in enumerate(tree.kind):
            if open_:
                parent = open_[-1]
                self.children[parent].append(node)
                full = 2 if tree.kind[parent] == NodeKind.SPLIT else 1
                if len(self.children[parent]) == full:
                    open_.pop()
            else:
                self.roots.append(node)
            if kind in (NodeKind.SPLIT, NodeKind.CONTRACT, NodeKind.NARROW):
                open_.append(node)
        assert not open_

    def leaf(self, x: np.ndarray, pins: np.ndarray, critical: bool = False) -> tuple[int, bool]:
        """The leaf, and whether the state was in every box that it was to be in; a curve may leave a NARROW box."""
        which = next(i for i in range(len(self.start)) if (self.start.pins[:, i] == pins).all())
        lower, upper = self.start.lower[:, which].copy(), self.start.upper[:, which].copy()
        x = x.copy()
        node = self.roots[which]
        while True:
            kind, data = NodeKind(self.tree.kind[node]), int(self.tree.data[node])
            if kind == NodeKind.SPLIT:
                middle = 0.5 * (lower[data] + upper[data])
                side = int(x[data] > middle)
                (upper, lower)[side][data] = middle
                node = self.children[node][side]
            elif kind in (NodeKind.CONTRACT, NodeKind.NARROW):
                lower, upper = self.tree.lower[data].copy(), self.tree.upper[data].copy()
                outside = np.maximum(lower - x, x - upper).max()
                if outside > OUTSIDE:
                    return node, kind == NodeKind.NARROW and not critical
                x = np.clip(x, lower, upper)
                node = self.children[node][0]
            else:
                return node, True


@shared
def recorded(name: str) -> Proof:
    return prove(Model(SCENES[name]), record=True)


def proof_of(name: str) -> tuple[Model, Proof, Replay]:
    model, proof = Model(SCENES[name]), recorded(name)
    return model, proof, Replay(proof.tree, model.size)


SCENES = {
    "degree 4": family_scene("fold-limits", 0),
    "degree 5": family_scene("fold-limits", 1),
    "D1": examples.degree6("pi/3", 1.0, contact="fold-limits"),
    "D2": examples.degree8("pi/6", 1.0, contact="fold-limits"),
}


@pytest.mark.parametrize("name", thinned([*SCENES], 2))
def test_no_closed_state_is_excluded_by_closure(name):
    model, _, replay = proof_of(name)
    rng = np.random.default_rng(0)
    states = random_strata(model, rng, 400)
    pins = np.where(np.abs(states) == math.pi, np.sign(states), 0).astype(int)
    assert len({tuple(p) for p in pins}) >= 5
    met = set()
    for x, s in zip(states, pins, strict=True):
        node, inside = replay.leaf(x, s)
        assert inside
        kind = NodeKind(replay.tree.kind[node])
        met.add(kind)
        assert kind not in (NodeKind.CLOSED, NodeKind.EMPTY)
    assert NodeKind.MINOR in met or name.startswith("D")


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_critical_points_end_in_their_leaves(name):
    model, proof, replay = proof_of(name)
    for number, point in enumerate(proof.points):
        node, inside = replay.leaf(np.array(point.x), np.array(point.stratum), critical=True)
        assert inside and replay.tree.kind[node] == NodeKind.ROOT
        assert replay.tree.data[node] == number
    for minimum in find_minima(model.scene, prove=False, escape=False).minima:
        x = model.reduce(np.array(minimum.fold_angles))
        pins = np.where(np.abs(np.abs(x) - math.pi) < 1e-12, np.sign(x), 0).astype(int)
        node, inside = replay.leaf(x, pins, critical=True)
        assert inside
        assert replay.tree.kind[node] in (NodeKind.ROOT, NodeKind.SINGULAR)


@pytest.mark.slow
def test_leaves_lie_where_they_say():
    """Boxes of leaves: roots within uniqueness, flat ones within the radius, clusters within their hulls."""
    _, proof, replay = proof_of("degree 5")
    tree, start = proof.tree, replay.start
    seen = dict.fromkeys((NodeKind.ROOT, NodeKind.FLAT), 0)
    for which, root in enumerate(replay.roots):
        stack = [(root, start.lower[:, which], start.upper[:, which])]
        while stack:
            node, lower, upper = stack.pop()
            assert (lower <= upper).all() and (np.abs([lower, upper]) <= BEYOND).all()
            kind, data = NodeKind(tree.kind[node]), int(tree.data[node])
            if kind == NodeKind.SPLIT:
                middle = 0.5 * (lower[data] + upper[data])
                first, second = upper.copy(), lower.copy()
                first[data] = second[data] = middle
                low, high = replay.children[node]
                stack += [(low, lower, first), (high, second, upper)]
            elif kind in (NodeKind.CONTRACT, NodeKind.NARROW):
                inner = tree.lower[data], tree.upper[data]
                assert (inner[0] >= lower).all() and (inner[1] <= upper).all()
                stack.append((replay.children[node][0], *inner))
            elif kind == NodeKind.ROOT:
                point = proof.points[data]
                assert point.stratum == tuple(start.pins[:, which].tolist())
                far = np.maximum(np.abs(lower - point.x), np.abs(upper - point.x)).max()
                assert far <= point.unique_radius
            elif kind == NodeKind.FLAT:
                assert np.abs([lower, upper]).max() <= proof.flat_radius
            if kind in seen:
                seen[kind] += 1
    assert seen[NodeKind.ROOT] >= len(proof.points) and seen[NodeKind.FLAT] > 0


def test_the_time_limit_leaves_the_rest_undecided():
    proof = prove(Model(family_scene("fold-limits", 2)), seconds=0.3, record=True)
    assert not proof.finished and not proof.complete
    late = [c for c in proof.undecided if c.reason == "time was up"]
    assert late and all(c.boxes > 0 and c.energies[0] <= c.energies[1] for c in late)
    assert (proof.tree.kind == NodeKind.UNDECIDED).sum() >= sum(c.boxes for c in late)


def test_recording_changes_nothing():
    model = Model(SCENES["degree 4"])
    one, two = prove(model), prove(model, record=True)
    assert one.points == two.points and one.boxes == two.boxes and one.tree is None
