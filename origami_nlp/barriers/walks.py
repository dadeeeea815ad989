"""Ways between stable states: straight to the flat state, and to each other, over any height.

Walks from minima lead straight to the flat state and to other minima; and from where such a walk meets contact, down
again.  Sheets that are folded onto themselves are unfolded in stages: to where every crease is flat or fully folded,
and on to flatter such states.  Each way is closed, and facets do not cross at the states that are looked at: how high
it climbs is an upper bound.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from origami_nlp.escapes import Move, Terrain, down_to, number_of
from origami_nlp.numerics import OUTSIDE, groups


class Walks:
    """Walks from minima, and what they have joined.

    Parameters
    ----------
    terrain
        With the minima.
    tops
        States that ways may pass, [n] each: the flat one, if there is one.
    joined
        Pairs that a way is known between: of minima by number, and of tops, M and further.
    moves
        Symmetries of the problem, as functions of states.
    """

    def __init__(
        self,
        terrain: Terrain,
        tops: Sequence[np.ndarray],
        joined: Sequence[tuple[int, int]],
        moves: Sequence[Move],
    ) -> None:
        self.terrain, self.minima, self.joined = terrain, terrain.minima, list(joined)
        self._moves, self._nodes = moves, np.array([*self.minima, *tops])
        # so many from where walks meet contact, in all
        self._sides, self._descents = terrain.sides(self._nodes), 60

    def ways(self) -> Iterator[tuple[int, int, np.ndarray]]:
        """Yield the number of the minimum that a way begins at, -1 for a top; of that it ends at; its states [S, n]."""
        many = len(self.minima)
        for top in range(many, len(self._nodes)):
            for k in range(many):
                if not self._differ(k, top) and (k, top) not in self.joined:
                    path, arrives = self.terrain.walk_to(self.minima[k], self._nodes[top])
                    if arrives:
                        yield from self._with_images(top, k, path[::-1])
        yield from self._unfolded()
        for one, other in self._pairs():
            for k, to in ((one, other), (other, one)):
                if not self._apart(k, to):
                    break
                path, arrives = self.terrain.walk_to(self.minima[k], self.minima[to])
                if not arrives:
                    to, path = self._down(k, path)
                if to >= 0 and self._apart(k, to):
                    yield from self._with_images(k, to, path)

    def _unfolded(self) -> Iterator[tuple[int, int, np.ndarray]]:
        """Unfold minima that are fully folded at some creases, in stages, to the flat state."""
        top = next((k for k, x in enumerate(self._nodes) if not x.any()), None)
        if top is None:
            return
        is_full = self.terrain.problem.fold_limits.room(self.minima) <= OUTSIDE
        folded = np.where(is_full, self.minima, 0.0)
        routes = {self._nodes[top].tobytes(): self._nodes[top][None]}
        for x in sorted(np.unique(folded, axis=0), key=np.count_nonzero):
            # flatter states whose folds are folds here too: the flattest first
            inner = [way[0] for way in routes.values() if ((way[0] == x) | (way[0] == 0)).all()]
            for y in inner if x.any() and self.terrain.is_admissible(x) else ():
                path, arrives = self.terrain.walk_to(x, y)
                if arrives:
                    routes[x.tobytes()] = np.concatenate([path, routes[y.tobytes()][1:]])
                    break
        for k in np.flatnonzero(is_full.any(axis=1)).tolist():
            if (route := routes.get(folded[k].tobytes())) is not None and self._apart(k, top):
                path, arrives = self.terrain.walk_to(self.minima[k], folded[k])
                if arrives:
                    yield from self._with_images(top, k, np.concatenate([path, route[1:]])[::-1])

    def _differ(self, one: int, other: int) -> bool:
        """Whether a vertex is on different sides in two states, so that no straight way leads from one to the other."""
        return bool((self._sides[one] * self._sides[other] < 0).any())

    def _apart(self, one: int, other: int) -> bool:
        """Whether no way is known between two states."""
        group = groups(len(self._nodes), self.joined)
        return bool(group[one] != group[other])

    def _pairs(self) -> Iterator[tuple[int, int]]:
        """Minima that are not joined, the nearest ones of each, in order of distance."""
        many = len(self.minima)
        # more decimals of distances are rounding
        far = np.linalg.norm(self.minima[:, None] - self.minima, axis=2).round(6)
        group = groups(len(self._nodes), self.joined)[:many]
        pairs = set()
        for k in range(many):
            nearest = np.argsort(far[k], kind="stable").tolist()
            others = [j for j in nearest if group[j] != group[k] and not self._differ(k, j)]
            # walks lead to the nearest ones, while no way to them is known
            pairs |= {(min(k, j), max(k, j)) for j in others[:8]}
        yield from sorted(pairs, key=lambda pair: (far[pair], pair))

    def _down(self, k: int, path: np.ndarray) -> tuple[int, np.ndarray]:
        """Go down from where a walk ended; number of the minimum that leads to, -1 for none."""
        if len(path) < 2 or not self._descents:
            return -1, path
        self._descents -= 1
        down = down_to(self.terrain, path[-1])
        if down is None or down[1] == k:
            return -1, path
        return down[1], np.concatenate([path, down[0][1:]])

    def _with_images(
        self, start: int, to: int, path: np.ndarray
    ) -> Iterator[tuple[int, int, np.ndarray]]:
        """Note a way and its images under symmetries of the sheet with its springs."""
        many, whole = len(self.minima), self.terrain.through_flat(path)
        if whole is None or (whole := self.terrain.with_tops(whole)) is None:
            return
        path = np.concatenate([self._nodes[start][None], whole[1:-1], self._nodes[to][None]])
        self.joined.append((to, start))
        yield (start if start < many else -1), to, path
        for move in self._moves:
            whole = move(path)
            start, to = (number_of(x, self._nodes) for x in (whole[0], whole[-1]))
            if min(start, to) >= 0 and not {(to, start), (start, to)} & set(self.joined):
                self.joined.append((to, start))
                whole[0], whole[-1] = self._nodes[start], self._nodes[to]
                yield (start if start < many else -1), to, whole
