"""Choices between contacts at a state, as half-spaces: to first order gaps with parallel slopes are one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from operator import itemgetter
from typing import Any, TypeAlias

import numpy as np

from origami_nlp.numerics import INDEPENDENT, NONZERO
from origami_nlp.problem import MOST_LISTED, Contact

Branches: TypeAlias = tuple[tuple[tuple[Contact, ...], ...], ...]


class Choices:
    """The choices at a state, and how fast their contacts open along a direction.

    Where corners lie on each other many sides meet, and most choices say the same to first order: gaps with parallel
    slopes along closed motions are one half-space.  Of choices between the same half-spaces one is kept, and none that
    follows from another: fewer choices are a larger set.
    """

    def __init__(self, state: Any) -> None:
        contacts = state.contacts
        self._base: tuple[Contact, ...] = contacts.base
        branches = contacts.branches
        every = dict.fromkeys(
            (*contacts.base, *(c for branch in branches for option in branch for c in option))
        )
        slopes = state.on(tuple(every)).slopes
        along = slopes @ state.kernel
        lever = np.linalg.norm(along, axis=1)
        size = np.maximum(lever, INDEPENDENT)
        known = dict(zip(every, lever.round(9).tolist(), strict=True))
        self._slopes, self._root = slopes / size[:, None], state.problem.root
        half_spaces = _half_spaces(along / size[:, None])
        self._bit = {c: 1 << k for c, k in zip(every, half_spaces, strict=True)}
        ordered = branches if contacts.complete else _by_levers(branches, known)
        self.branches = ordered if contacts.complete else self._independent(ordered)
        self._said = [[self.said(option) for option in branch] for branch in self.branches]
        number = {c: k for k, c in enumerate(every)}
        self._places = [
            [[number[c] for c in option] for option in branch] for branch in self.branches
        ]

    def said(self, rows: Iterable[Contact]) -> int:
        """Return the half-spaces of contacts, a bit for each."""
        out = 0
        for c in rows:
            out |= self._bit.get(c, 0)
        return out

    def alike(self, rows: Iterable[Contact]) -> tuple[Contact, ...]:
        """Return the contacts that say to first order what some of these say."""
        said = self.said(rows)
        return tuple(c for c, bit in self._bit.items() if said & bit)

    def _independent(self, branches: Branches) -> Branches:
        """Leave out choices that follow from others to first order."""
        # options stay as they are: of two that agree to first order either may allow more to second order
        kept: dict[frozenset[int], tuple[tuple[Contact, ...], ...]] = {}
        for branch in branches:
            kept.setdefault(frozenset(self.said(option) for option in branch), branch)
        options = set().union(*kept)
        within = {o: {held for held in options if held & o == o} for o in options}
        for said in reversed(list(kept)):
            holding = set().union(*(within[o] for o in said))
            if any(other <= holding and other != said for other in kept):
                del kept[said]
        return tuple(kept.values())

    def pieces(self) -> list[tuple[Contact, ...]] | None:
        """Return every way to choose, as contacts with different half-spaces each; None where they are too many."""
        if math.prod(len(branch) for branch in self.branches) > MOST_LISTED:
            return None
        sets: dict[int, tuple[Contact, ...]] = {0: ()}
        for branch in ((self._base,), *self.branches):
            before, sets = sets, {}
            for held, rows in before.items():
                for option in branch:
                    now, more = held, list(rows)
                    for c in option:
                        if now & self._bit[c] != self._bit[c]:
                            now, more = now | self._bit[c], [*more, c]
                    sets.setdefault(now, tuple(more))
        return [
            rows
            for held, rows in sets.items()
            if not any(_holds(held, other) and other != held for other in sets)
        ]

    def open(self, held: int) -> list[int]:
        """Return the choices of which no option holds with contacts of these half-spaces, see `said`."""
        return [
            k for k, options in enumerate(self._said) if not any(_holds(held, o) for o in options)
        ]

    def open_along(self, free: list[int], direction: np.ndarray) -> bool:
        """Return whether a direction [n] passes none of these choices."""
        return not self.passed(free, direction)

    def passed(self, free: list[int], direction: np.ndarray) -> list[int]:
        """Return the choice that a direction [n] passes most, if it passes any: none of its options stays open."""
        d = self._root * direction
        rate = (self._slopes @ (d / max(float(np.linalg.norm(d)), NONZERO))).tolist()
        best = [max(min(rate[i] for i in option) for option in self._places[k]) for k in free]
        least = min(best, default=0.0)
        if least >= -INDEPENDENT:
            return []
        return [next(k for k, b in zip(free, best, strict=True) if b < 0.999 * least)]


def _holds(held: int, said: int) -> bool:
    """Return whether half-spaces, as bits, are among others."""
    return held & said == said


def _half_spaces(normals: np.ndarray) -> list[int]:
    """Number unit normals [r, t], those that agree with an earlier one as it."""
    out, many = np.full(len(normals), -1), 0
    for k, normal in enumerate(normals):
        if out[k] < 0:
            left = np.flatnonzero(out < 0)
            out[left[np.abs(normals[left] - normal).max(axis=1, initial=0.0) <= INDEPENDENT]] = many
            many += 1
    return out.tolist()


def _by_levers(branches: Branches, lever: dict[Contact, float]) -> Branches:
    """Order choices and their options by the levers of their contacts: as numbers of corners do not change it."""

    def levers(option: tuple[Contact, ...]) -> list[float]:
        return sorted(lever[c] for c in option)

    ordered = []
    for branch in branches:
        options = sorted(((levers(option), option) for option in branch), key=itemgetter(0))
        ordered.append(([of for of, _ in options], tuple(option for _, option in options)))
    return tuple(branch for _, branch in sorted(ordered, key=itemgetter(0)))
