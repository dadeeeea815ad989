"""The graph of a scene, refined until the tops of its lowest paths are exact passes.

The exact passes and the descents from them are put back into the graph, so that the tree is that of the exact
heights, and a lower way that the graph knows would still win.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from origami_nlp.barriers.graph import grow
from origami_nlp.barriers.lower_dimensional import stratum_curves
from origami_nlp.barriers.passes import (
    Critical,
    Descent,
    PassKind,
    both_sides,
    critical_near,
    leg_is_below,
    slide,
)
from origami_nlp.kkt import State, lower_dimensional_at
from origami_nlp.numerics import DUPLICATE_TOL, LEVEL, SAMPLED, Merge, MergeTree, merge_tree
from origami_nlp.problem import Model
from origami_nlp.starts import flat_foldings

MOST_ROUNDS = 6


class RefinedGraph:
    """Vertices 0 .. m-1 are the minima; next come the states that may be passes by themselves.

    graph: the graph as it is refined.  mesh: merge tree of the graph before any refinement.
    exact: vertices that are exact passes.  curves: thin sets.
    """

    def __init__(self, model: Model, minima: list[np.ndarray], spacing: float, seed: int) -> None:
        self.model, self.minima, self.spacing = model, minima, spacing
        self.curves = stratum_curves(model, seed, tuple(minima))
        known = list(minima)
        self.exact: dict[int, Critical] = {}
        for x in [*flat_foldings(model), *(s for c in self.curves for s in c.states[[0, -1]])]:
            if not model.refuses(x) and all(np.abs(x - k).max() > DUPLICATE_TOL for k in known):
                known.append(x)
        self.singular = range(len(minima), len(known))
        thin = [v for v, x in enumerate(known) if lower_dimensional_at(State(model, x))]
        self.graph = grow(model, known, spacing, chains=[c.states for c in self.curves], alone=thin)
        self._tie_chains()
        self.mesh = merge_tree(
            self.graph.energy, self.graph.edges, self.graph.height, range(len(minima))
        )
        for v in self.singular:
            flat = np.abs(known[v]).max() <= DUPLICATE_TOL
            kind: PassKind = "flat state" if flat else "singular"
            self.exact[v] = Critical(known[v], (), 1, math.nan, kind)

    def _tie_chains(self) -> None:
        """Join each seed to the chain vertex that is the same state, or lies between the same two."""
        first = len(self.minima) + len(self.singular)
        at = first
        links = []
        for curve in self.curves:
            here = np.arange(at, at + len(curve.states))
            for v in range(first):
                gap = np.linalg.norm(curve.states - self.graph.states[v], axis=1)
                if gap.min() <= DUPLICATE_TOL:
                    links.append((v, int(here[gap.argmin()])))
                elif v < len(self.minima) and gap.min() <= SAMPLED:
                    near = np.argsort(gap)[:2]
                    # a minimum between two samples of the curve is joined to both
                    links += [(v, int(here[k])) for k in near]
            at += len(curve.states)
        self._add(np.empty((0, self.model.size)), links)

    def _add(self, states: np.ndarray, links: list[tuple[int, int]]) -> int:
        """Append states and edges whose height is that of their higher end; return the first new vertex."""
        g = self.graph
        start = len(g.states)
        x = np.vstack([g.states, states])
        energy = self.model.energies(x)
        if links:
            new = np.array(links)
            self.graph = replace(
                g,
                states=x,
                energy=energy,
                edges=np.vstack([g.edges, new]),
                middle=np.vstack([g.middle, x[new[:, 1]]]),
                height=np.concatenate([g.height, energy[new].max(axis=1)]),
            )
        return start

    def _add_pass(self, critical: Critical, sides: tuple[Descent, ...]) -> int:
        """Append a pass and the descents from it; return its vertex."""
        v = self._add(critical.x[None], [(len(self.graph.states),) * 2])
        self.exact[v] = critical
        for side in sides:
            start = len(self.graph.states)
            chain = [v, *range(start, start + len(side.states))]
            chain += [] if side.lands_on is None else [side.lands_on]
            self._add(side.states, list(itertools.pairwise(chain)))
        return v

    def refine(self) -> MergeTree:
        """Make every merge exact where that succeeds; return the tree of the refined graph."""
        done: set[int] = set()
        for _ in range(MOST_ROUNDS):
            g = self.graph
            tree = merge_tree(g.energy, g.edges, g.height, range(len(self.minima)))
            todo = [m for m in tree.merges if self.top(m) not in self.exact and m.edge not in done]
            if not todo:
                break
            for merge in todo:
                done.add(merge.edge)
                self._refine_merge(tree, merge)
        return tree

    def top(self, merge: Merge) -> int:
        """Return the vertex at the top of a merging edge: the exact pass if one end is one."""
        g = self.graph
        slack = LEVEL * max(abs(merge.height), self.model.scale)
        for v in g.edges[merge.edge].tolist():
            if v in self.exact and abs(g.energy[v] - merge.height) <= slack:
                return v
        return int(max(g.edges[merge.edge].tolist(), key=lambda v: g.energy[v]))

    def kind_of(self, merge: Merge) -> PassKind:
        """Return the kind of pass of a merge."""
        v = self.top(merge)
        return self.exact[v].kind if v in self.exact else "mesh"

    def _refine_merge(self, tree: MergeTree, merge: Merge) -> None:
        """Look for the exact pass near the top of the lowest path, and keep the lowest that joins both sides."""
        g = self.graph
        way = tree.path(merge.first[0], merge.second[0])
        assert way is not None
        vertices, edges = way
        at = edges.index(merge.edge)
        near = vertices[max(0, at - 6) : at + 8]
        starts = np.vstack([g.middle[merge.edge], g.states[near]])
        # height over the higher of the two valleys that meet
        depth = merge.height - max(
            min(g.energy[k] for k in merge.first), min(g.energy[k] for k in merge.second)
        )
        best: tuple[float, Critical, tuple[Descent, Descent]] | None = None
        for c in critical_near(self.model, starts, 3 * self.spacing):
            u = self.model.energy(c.x)
            # the parabolas of the graph may be a little low; anything much higher is another pass
            # KKT points of index 1 near the top of the rough path: the lowest that parts the two sides
            if u > merge.height + 0.2 * depth or (best is not None and u >= best[0]):
                continue
            sides = both_sides(self.model, c, self.minima)
            if sides is None:
                continue
            ends = [s.lands_on for s in sides]
            # the evidence: descents down both sides land in valleys that this merge joins
            apart = any(a in merge.first and b in merge.second for a, b in (ends, ends[::-1]))
            if apart:
                best = (u, c, sides)
        if best is not None:
            v = self._add_pass(best[1], best[2])
            # edges of the graph that pass this place are known to be less exact: they cost at least the pass
            self._lift(merge, v, best[0])

    def _lift(self, merge: Merge, v: int, level: float) -> None:
        """Let edges near an exact pass that claim to cross lower cost as much as it."""
        g = self.graph
        a, b = g.states[g.edges[:, 0]], g.states[g.edges[:, 1]]
        x = g.states[v]
        close_by = np.minimum(np.linalg.norm(a - x, axis=1), np.linalg.norm(b - x, axis=1))
        height = g.height.copy()
        while True:
            tree = merge_tree(g.energy, g.edges, height, range(len(self.minima)))
            found = tree.barrier(merge.first[0], merge.second[0])
            if found is None or found.height >= level - LEVEL * max(abs(level), self.model.scale):
                break
            if v in g.edges[found.edge] or close_by[found.edge] > 4 * self.spacing:
                break
            # just above the pass, so that the tree takes the pass itself
            height[found.edge] = np.nextafter(level, math.inf) if level else 0.0
        self.graph = replace(g, height=height)

    def only_exit(self, v: int, i: int, j: int) -> bool:
        """Return whether vertex v is the one end at which a thin set with just one of minima i and j is left."""
        for curve in self.curves:
            on = [
                bool(np.abs(curve.states - self.minima[k]).max(axis=1).min() <= SAMPLED)
                for k in (i, j)
            ]
            ends = [
                s for s, goes_on in zip(curve.states[[0, -1]], curve.ends, strict=True) if goes_on
            ]
            if (
                on[0] != on[1]
                and len(ends) == 1
                and np.abs(ends[0] - self.graph.states[v]).max() <= DUPLICATE_TOL
            ):
                return True
        return False

    def path(self, tree: MergeTree, merge: Merge, i: int, j: int) -> np.ndarray:
        """Return states from minimum i over the pass to minimum j: descents where they lead there, else the graph."""
        vertices, edges = tree.path(i, j) or ([], [])
        g = self.graph
        v = self.top(merge)
        if v in self.exact:
            k = vertices.index(v)
            one = self._half(v, vertices[:k][::-1], i)
            two = self._half(v, vertices[k + 1 :], j)
            if one is not None and two is not None:
                return np.vstack([one[::-1], g.states[v][None], two])
        out = [g.states[vertices[0]]]
        for edge, w in zip(edges, vertices[1:], strict=True):
            out += [g.middle[edge], g.states[w]]
        states = np.array(out)
        return states[np.concatenate([[True], np.abs(np.diff(states, axis=0)).max(axis=1) > 0])]

    def _half(self, v: int, side: list[int], end: int) -> np.ndarray | None:
        """Return a descent from pass v to minimum `end` that starts like the graph's path `side`; None if it lands
        elsewhere."""
        g, model = self.graph, self.model
        for w in side[:4]:
            if g.energy[w] >= g.energy[v]:
                continue
            leg = leg_is_below(model, g.states[v], g.states[w], float(g.energy[v]))
            if leg is None:
                continue
            down = slide(model, g.states[w], self.minima)
            if down is not None and down.lands_on == end:
                return np.vstack([leg, down.states])
        return None
