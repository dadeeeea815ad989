"""Barriers: for each pair of minima the lowest pass between them, and a path through it.

A graph of admissible states (`barriers_graph`) and its merge tree (`barriers_merge_tree`) say where sublevel sets of the
energy first meet; Newton on the KKT system makes the top of each lowest path an exact pass (`barriers_pass`).
The exact passes and the descents from them are put back into the graph, so that the tree is that of the exact
heights, and a lower way that the graph knows would still win.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.judge.barriers_graph import StateGraph, energies, grow, side_of_flat
from origami_nlp.judge.barriers_merge_tree import Merge, MergeTree, merge_tree
from origami_nlp.judge.barriers_pass import (
    Critical,
    Descent,
    PassKind,
    both_sides,
    critical_at,
    critical_near,
    leg_is_below,
    slide,
)
from origami_nlp.judge.barriers_thin import thin_curves
from origami_nlp.judge.handles import thin_at
from origami_nlp.judge.loads import row_name
from origami_nlp.judge.minima import MinimaResult, find_minima
from origami_nlp.judge.nearby import is_admissible
from origami_nlp.model.nlp import Model
from origami_nlp.solve.active import closed_contacts
from origami_nlp.solve.starts import flat_foldings
from origami_nlp.state.scene import Scene

SPACING = 0.09
"""Lattice of the graph [rad]."""
MOST_ROUNDS = 6


@dataclass(frozen=True)
class Pass:
    """The lowest pass between two minima.

    from_state, to_state: numbers (1-based) in `Barriers.minima`.  energy: of the pass [the scene's units]; inf where no
    admissible path joins the two.  pass_kind: ``saddle`` (interior), ``contact saddle``, ``corner`` (pieces of the
    feasible set meet), ``flat state``, ``singular`` (another state where two pieces meet in one point, or a
    thin set ends), ``mesh`` (not refined: the energy is that of an explicit path, an upper bound), or ``none``.
    fold_angles: of the pass, all N [rad]; empty for ``none``.  contacts: closed there, in words.
    residual: of its KKT system (scaled; nan where no such system holds: at singular passes and on the mesh).
    path: fold angles [M, N] from the first minimum over the pass to the second.  path_energy: [M].
    mesh_energy: height of the lowest path on the graph alone.  why: what bounds the barrier from below.
    """

    from_state: int
    to_state: int
    energy: float
    pass_kind: PassKind
    fold_angles: tuple[float, ...]
    contacts: tuple[str, ...]
    residual: float
    path: np.ndarray = field(repr=False)
    path_energy: np.ndarray = field(repr=False)
    mesh_energy: float
    why: str

    def to_dict(self) -> dict[str, Any]:
        """Return the entry of the JSON file (no barrier: energy null)."""
        finite = math.isfinite(self.energy)
        return {
            "from": self.from_state,
            "to": self.to_state,
            "energy": self.energy if finite else None,
            "pass_kind": self.pass_kind,
            "fold_angles": list(self.fold_angles),
            "contacts": list(self.contacts),
            "residual": None if math.isnan(self.residual) else self.residual,
            "mesh_energy": self.mesh_energy if math.isfinite(self.mesh_energy) else None,
            "lower_bound": self.why,
            "path": [
                {"fold_angles": p, "energy": u}
                for p, u in zip(self.path.tolist(), self.path_energy.tolist(), strict=True)
            ],
        }


@dataclass(frozen=True)
class Join:
    """Two branches of the merge tree meet: at `energy`, states `first` and `second` (1-based) on either side."""

    energy: float
    pass_kind: PassKind
    first: tuple[int, ...]
    second: tuple[int, ...]


@dataclass(frozen=True)
class Barriers:
    """Passes for every pair of minima, the merge tree, and the graph that they came from."""

    result: MinimaResult = field(repr=False)
    passes: tuple[Pass, ...]
    merges: tuple[Join, ...]
    graph: StateGraph
    unlisted: tuple[tuple[float, tuple[float, ...]], ...] = field(repr=False, default=())

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.result.scene

    def matrix(self) -> np.ndarray:
        """Return the barrier energies [m, m]: an ultrametric; the diagonal holds the minima's own energies."""
        m = len(self.result.minima)
        out = np.full((m, m), math.inf)
        np.fill_diagonal(out, [s.energy for s in self.result.minima])
        for p in self.passes:
            out[p.from_state - 1, p.to_state - 1] = out[p.to_state - 1, p.from_state - 1] = p.energy
        return out

    def to_dict(self) -> list[dict[str, Any]]:
        """Return the issue's ``barriers`` list."""
        return [p.to_dict() for p in self.passes]


def find_barriers(
    scene: Scene,
    result: MinimaResult | None = None,
    space: object | None = None,
    full: bool = False,
    *,
    spacing: float = SPACING,
    seed: int = 0,
) -> Barriers:
    """Find the lowest pass between every two minima of a scene with two symmetric freedoms.

    Parameters
    ----------
    result
        The scene's minima; found here if not given.
    space
        Not needed: accepted so that callers may hand on an analysis they already have.
    spacing
        Lattice of the graph [rad].
    seed
        Of the search for minima and for thin sets.

    Raises
    ------
    OptionError
        If the scene has another number of symmetric freedoms, or `spacing` is out of range.
    """
    if not 0.02 <= spacing <= 0.5:
        raise OptionError(f"spacing = {spacing!r} must lie between 0.02 and 0.5 rad")
    model = scene.model()
    if model.freedom != 2:
        raise OptionError(
            f"barriers need a scene with 2 symmetric degrees of freedom, this one has {model.freedom}: "
            "state another [model] symmetry"
        )
    if result is None:
        result = find_minima(scene, seed=seed, full=full)
    work = _Work(
        model, [model.reduce(np.array(m.fold_angles)) for m in result.minima], spacing, seed
    )
    tree = work.refine()
    passes = tuple(
        work.pass_between(tree, i, j)
        for i in range(len(work.minima))
        for j in range(i + 1, len(work.minima))
    )
    merges = tuple(
        Join(
            m.height, work.kind_of(m), tuple(k + 1 for k in m.first), tuple(k + 1 for k in m.second)
        )
        for m in tree.merges
    )
    unlisted = tuple(
        (life, tuple(model.expand(work.graph.states[v]).tolist())) for life, v in tree.others[:20]
    )
    return Barriers(result, passes, merges, work.graph, unlisted)


class _Work:
    """The graph as it is refined: vertices 0 .. m-1 are the minima, then the states that may be passes by themselves."""

    def __init__(self, model: Model, minima: list[np.ndarray], spacing: float, seed: int) -> None:
        self.model, self.minima, self.spacing = model, minima, spacing
        self.curves = thin_curves(model, seed, tuple(minima))
        known = list(minima)
        self.exact: dict[int, Critical] = {}
        for x in [*flat_foldings(model), *(s for c in self.curves for s in c.states[[0, -1]])]:
            if is_admissible(model, x) and all(np.abs(x - k).max() > 1e-9 for k in known):
                known.append(x)
        self.singular = range(len(minima), len(known))
        thin = [v for v, x in enumerate(known) if thin_at(model, x)]
        self.graph = grow(model, known, spacing, chains=[c.states for c in self.curves], alone=thin)
        self._tie_chains()
        self.mesh = merge_tree(
            self.graph.energy, self.graph.edges, self.graph.height, range(len(minima))
        )
        for v in self.singular:
            flat = np.abs(known[v]).max() <= 1e-9
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
                if gap.min() <= 1e-9:
                    links.append((v, int(here[gap.argmin()])))
                elif v < len(self.minima) and gap.min() <= 0.03:
                    near = np.argsort(gap)[:2]
                    links += [(v, int(here[k])) for k in near]
            at += len(curve.states)
        self._add(np.empty((0, self.model.size)), links)

    def _add(self, states: np.ndarray, links: list[tuple[int, int]]) -> int:
        """Append states and edges whose height is that of their higher end; return the first new vertex."""
        g = self.graph
        start = len(g.states)
        x = np.vstack([g.states, states])
        energy = energies(self.model, x)
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
            self._add_descent(v, side)
        return v

    def _add_descent(self, v: int, side: Descent) -> None:
        start = len(self.graph.states)
        chain = [v, *range(start, start + len(side.states))]
        links = list(zip(chain, chain[1:], strict=False))
        if side.lands_on is not None:
            links.append((chain[-1], side.lands_on))
        self._add(side.states, links)

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
        slack = 1e-12 * max(abs(merge.height), self.model.scale)
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
        depth = merge.height - max(
            min(g.energy[k] for k in merge.first), min(g.energy[k] for k in merge.second)
        )
        best: tuple[float, Critical, tuple[Descent, Descent]] | None = None
        for c in critical_near(self.model, starts, 3 * self.spacing):
            u = self.model.energy(c.x)
            # the parabolas of the graph may be a little low; anything much higher is another pass
            if u > merge.height + 0.2 * depth or (best is not None and u >= best[0]):
                continue
            sides = both_sides(self.model, c, self.minima)
            if sides is None:
                continue
            ends = [s.lands_on for s in sides]
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
            if found is None or found.height >= level - 1e-13 * max(abs(level), self.model.scale):
                break
            if v in g.edges[found.edge] or close_by[found.edge] > 4 * self.spacing:
                break
            height[found.edge] = np.nextafter(level, math.inf) if level else 0.0
        self.graph = replace(g, height=height)

    def pass_between(self, tree: MergeTree, i: int, j: int) -> Pass:
        """Return the pass between minima i and j (0-based) with its path."""
        model, g = self.model, self.graph
        merge = tree.barrier(i, j)
        mesh = self.mesh.barrier(i, j)
        rough = mesh.height if mesh else math.inf
        if merge is None:
            none = np.empty((0, model.scene.degree))
            why = "no admissible path found: the minima lie in different components"
            return Pass(
                i + 1, j + 1, math.inf, "none", (), (), math.nan, none, none[:, 0], rough, why
            )
        v = self.top(merge)
        states = self._path(tree, merge, i, j)
        energy = float(g.energy[v]) if v in self.exact else merge.height
        x = g.states[v] if v in self.exact else states[int(energies(model, states).argmax())]
        kind = self.kind_of(merge)
        critical = critical_at(model, x) if kind not in ("mesh", "flat state", "singular") else None
        contacts = closed_contacts(model, x, model.local(x).gaps)
        rows = (contacts.combinations() or [contacts.base])[0]
        sides = side_of_flat(model.expand(np.array([self.minima[i], self.minima[j]])))
        if kind == "flat state" and sides[0] * sides[1] < 0 and model.scene.contact == "full":
            why = "proved: admissible states above and below the flat state meet there only"
        else:
            why = f"no lower way on {len(g.states)} states, {self.spacing:g} rad apart"
        return Pass(
            i + 1,
            j + 1,
            energy,
            kind,
            tuple(model.expand(x).tolist()),
            tuple(row_name(model, row) for row in rows),
            critical.residual if critical else math.nan,
            model.expand(states),
            energies(model, states),
            rough,
            why,
        )

    def _path(self, tree: MergeTree, merge: Merge, i: int, j: int) -> np.ndarray:
        """Return states from minimum i over the pass to minimum j: descents where they lead there, else the graph."""
        vertices, edges = tree.path(i, j) or ([], [])
        g = self.graph
        at = edges.index(merge.edge)
        v = self.top(merge)
        if v in self.exact:
            halves = []
            k = vertices.index(v)
            for end, side in ((i, vertices[:k][::-1]), (j, vertices[k + 1 :])):
                halves.append(self._half(v, side, end))
            if all(h is not None for h in halves):
                return np.vstack([halves[0][::-1], g.states[v][None], halves[1]])  # type: ignore[index]
        out = [g.states[vertices[0]]]
        for edge, w in zip(edges, vertices[1:], strict=True):
            out += [g.middle[edge], g.states[w]]
        del at
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
