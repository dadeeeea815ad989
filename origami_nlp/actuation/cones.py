"""Motions of the flat state with several degrees of freedom: cones of second order, and where torques lead on them.

Round a flat vertex of degree n closure allows a space of n - 2 flat velocities to first order, and of these to second
order those on which one quadratic form vanishes, the area of a closed polygon with sides along the creases.  It has the
signs of (1, n - 3) (Kapovich and Millson, Publ. RIMS 33, 1997): a cone of two nappes, v and -v, on which the sum of the
fold angles is positive and negative.  Where the form is regular closed states follow each of its directions.

Work f . v of torques is positive on all of one nappe, and negative on all of the other, exactly where the inverse form
is positive at f; else it is positive on a part of each.  From a small push at random the steepest descent leaves along
a local maximum of f . v over unit v of the cone: with q the form on the velocities, stationary are v ~ (1 + s q)^-1 f
with v' q v = 0, a polynomial in s.  Stops of the flat state cut the cone: each face, on which some of them hold, is a
cone of the same kind with fewer creases, and a way is a maximum if the stops push back where it is most there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise

import numpy as np

from origami_nlp.actuation.driving import DIGITS, MOST_SETS, DrivenSet
from origami_nlp.kkt import loop_modes, tangent_cone
from origami_nlp.numerics import RANK, SAME_DIRECTION, coarse
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import Closure


@dataclass(frozen=True, eq=False)
class FlatMotion:
    """Flat velocities that closed states follow: a subspace, or one nappe of a cone in it.

    Attributes
    ----------
    basis
        Orthonormal, [n, k]; of a cone the directions in which its form is diagonal, the one of positive sign first.
    form
        Of a cone, [k], the first entry positive and the others negative; empty for a subspace.
    side
        Of a cone: 1 where the sum of the fold angles is positive, -1 where it is negative.
    stops
        Of a cone that they cut: -1, 0 or 1 of each crease, the side to which it cannot fold, [n]; empty where none is.
    """

    basis: np.ndarray
    form: np.ndarray
    side: int = 0
    stops: np.ndarray = field(default_factory=lambda: np.zeros(0))


def subspace(basis: np.ndarray) -> FlatMotion:
    """Return all motions of a subspace with an orthonormal basis [n, k]."""
    return FlatMotion(basis, np.zeros(0))


def cones(pattern: Pattern, check: Callable[[], None]) -> tuple[list[FlatMotion], str]:
    """Find the motions of the flat state where one vertex has more than four creases.

    Parameters
    ----------
    pattern
        Flat.
    check
        Called every now and then: may raise to end it.

    Returns
    -------
    motions : list of FlatMotion
        To second order at each vertex.
    reason
        Why they are not known; "" otherwise.
    """
    if pattern.holes or pattern.cell:
        return [], "cones of motions are not cut with holes or lattices"
    loops = Closure(pattern).loops(pattern.reference)
    curved = [k for k, loop in enumerate(loops) if loop_modes(loop) is None]
    if len(curved) != 1:
        return [], f"{len(curved)} vertices have cones of motions, whose intersection is not known"
    loop = loops[curved[0]]
    u, values, _ = np.linalg.svd(loop.jacobian)
    form = np.einsum("k,kij->ij", u[:, -1], loop.hessians)
    if values[-2] <= RANK:
        return [], "all creases at a vertex are in one line"
    around = tangent_cone(loops, pattern.creases, check)
    found = []
    for basis in (*(line[:, None] for line in around.lines), *around.families):
        mine = basis[loop.variables]
        size, axes = np.linalg.eigh(mine.T @ form @ mine)
        if (np.abs(size) > RANK).sum() < len(size):
            return [], "some motions leave the form of a vertex of several degrees of freedom zero"
        signs = int((size > 0).sum()), int((size < 0).sum())
        if 0 in signs:
            continue  # of one sign: no motion but none
        if 1 not in signs or signs == (1, 1):
            return [], f"a cone of motions has the signs {signs}, not two nappes of one cone"
        size, axes = (size[::-1], axes[:, ::-1]) if signs[0] == 1 else (-size, axes)
        whole = basis @ axes
        whole[:, 0] *= 1.0 if whole[:, 0].sum() > 0 else -1.0
        found += [FlatMotion(whole, size, side) for side in (1, -1)]
    return found, ""


def inverse_form(motion: FlatMotion) -> np.ndarray:
    """Return the form [n, n] that is positive at torques which work on all of one nappe of a cone, or on none."""
    return (motion.basis / motion.form) @ motion.basis.T


def ways(motion: FlatMotion, force: np.ndarray) -> tuple[list[np.ndarray], bool]:
    """Find the directions along which the steepest descent leaves the flat state on one nappe of a cone.

    Parameters
    ----------
    motion
        The nappe.
    force
        Torques, springs included, [n].

    Returns
    -------
    directions : list of numpy.ndarray
        Unit flat velocities, [n], at which the work is a local maximum and positive, that with most first.
    alone : bool
        Whether they are strict local maxima; otherwise some only stand for those about them.
    """
    if motion.stops.any():
        return _ways_cut(motion, force)
    q, g = motion.form / motion.form[0], motion.basis.T @ force
    size = float(np.linalg.norm(force))
    if np.linalg.norm(g) <= SAME_DIRECTION * size:
        return [], True
    g = g / np.linalg.norm(g)
    groups = _groups(q)
    g = np.where(
        [np.linalg.norm(g[group]) > SAME_DIRECTION for group in groups for _ in group], g, 0.0
    )
    found, alone = [], True
    for s, y in _stationary(q, g, groups):
        y = y / np.linalg.norm(y)
        across = np.linalg.svd(np.array([y, q * y]))[2][2:]
        bend = min(np.linalg.eigvalsh((across * (1 + s * q)) @ across.T), default=1.0)
        if bend < -SAME_DIRECTION or y @ g <= SAME_DIRECTION or y[0] * motion.side <= 0:
            continue
        alone = alone and bool(bend > SAME_DIRECTION)
        found.append(y)
    found.sort(key=lambda y: tuple((-coarse(np.r_[y @ g, motion.basis @ y])).tolist()))
    return [motion.basis @ y for y in found], alone


def cut(motion: FlatMotion, stops: np.ndarray) -> FlatMotion | None:
    """Return a nappe of a cone without what stops of the flat state [n] keep out; None where that is all of it."""
    if not stops.any():
        return motion
    motion = replace(motion, stops=stops)
    # torques that work on all of the nappe: if some of it is left, there is a way of most work
    near = np.cos(np.arange(len(stops)))
    near = motion.basis @ (motion.basis.T @ near) / np.linalg.norm(near)
    least = float(np.abs(motion.form[1:]).min() / motion.form[0]) ** 0.5
    return (
        motion
        if ways(motion, motion.side * motion.basis[:, 0] + 0.1 * min(least, 1.0) * near)[0]
        else None
    )


def _ways_cut(motion: FlatMotion, force: np.ndarray) -> tuple[list[np.ndarray], bool]:
    """As `ways`, on a nappe that stops cut: on each face those of its cone at which held stops push back."""
    stopped, found, alone = np.flatnonzero(motion.stops), list[np.ndarray](), True
    least, held_side = (
        SAME_DIRECTION * float(np.linalg.norm(force)),
        motion.stops[:, None] * motion.basis,
    )
    for size in range(len(stopped) + 1):
        for held in map(list, combinations(stopped.tolist(), size)):
            face, touching = _face(motion, held)
            on_face, single = ways(face, force) if face else ([], True)
            for way in (*on_face, *touching):
                room = -(motion.stops * way)[stopped]
                if (room < -SAME_DIRECTION).any() or way @ force <= least:
                    continue
                y = motion.basis.T @ way
                normals = [y, motion.form / motion.form[0] * y, *held_side[held]]
                push = np.linalg.lstsq(np.array(normals).T, motion.basis.T @ force, rcond=None)[0][
                    2:
                ]
                if (push < -least).any() and not touching:
                    continue
                free = ~np.isin(stopped, held)
                strict = bool((push > least).all() and (room[free] > SAME_DIRECTION).all())
                alone = alone and single and strict and not touching
                found.append(way)
    found.sort(key=lambda v: tuple((-coarse(np.r_[v @ force, v])).tolist()))
    return found, alone


def _face(motion: FlatMotion, held: list[int]) -> tuple[FlatMotion | None, list[np.ndarray]]:
    """Return the part of a nappe on which these creases do not move, or its rays where that only touches the cone."""
    if not held:
        return replace(motion, stops=np.zeros(0)), []
    _, values, vt = np.linalg.svd(motion.basis[held])
    free = vt[int((values > SAME_DIRECTION).sum()) :].T
    size, axes = np.linalg.eigh((free.T * motion.form) @ free)
    axes = free @ axes[:, ::-1]
    axes *= motion.side * np.where(
        axes[0] < 0, -1.0, 1.0
    )  # on the nappe itself, not the one opposite
    if not len(size) or size[-1] < -RANK or (size[-1] > RANK and len(size) == 1):
        return None, []
    if size[-1] <= RANK:
        return None, [motion.basis @ axis for axis in axes.T[np.abs(size[::-1]) <= RANK]]
    axes[:, 0] *= motion.side
    return FlatMotion(motion.basis @ axes, size[::-1], motion.side), []


def _groups(q: np.ndarray) -> list[list[int]]:
    """Return which entries of a form, in order, are equal."""
    cuts = [0, *(np.flatnonzero(np.abs(np.diff(q)) > SAME_DIRECTION) + 1).tolist(), len(q)]
    return [list(range(a, b)) for a, b in pairwise(cuts)]


def _stationary(
    q: np.ndarray, g: np.ndarray, groups: list[list[int]]
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield s and y with (1 + s q) y = g and y' q y = 0; of a sphere of them two opposite ones."""
    met = [group for group in groups if g[group].any()]
    bottoms = [np.array([q[group].mean(), 1.0]) for group in met]  # 1 + s q, highest power first
    total = np.zeros(1)
    for k, group in enumerate(met):
        term = np.array([q[group].mean() * float(g[group] @ g[group])])
        for j, bottom in enumerate(bottoms):
            if j != k:
                term = np.polymul(np.polymul(term, bottom), bottom)
        total = np.polyadd(total, term)
    for root in np.roots(total):
        s = float(root.real)
        if abs(root.imag) <= SAME_DIRECTION * (1 + abs(root)):
            yield s, g / np.where(g, 1 + s * q, 1.0)
    for group in (group for group in groups if not g[group].any()):
        s = -1.0 / q[group].mean()
        y = np.divide(g, 1 + s * q, out=np.zeros_like(g), where=g != 0)
        left = -float(q @ y**2) / q[group].mean()
        if left > 0:
            for sign in (1.0, -1.0):
                out = y.copy()
                out[group[0]] = sign * np.sqrt(left)
                yield s, out


def driven_nappe(
    branch: int, motion: FlatMotion, others: np.ndarray, most: int = MOST_SETS
) -> DrivenSet | None:
    """Find few creases on which torques start one nappe of a cone alone, and along one direction.

    Parameters
    ----------
    branch
        Its number (1-based).
    motion
        The nappe.
    others
        Flat velocities of all other branches but the nappe opposite, [n, r].
    most
        Sets of creases that are gone through.

    Returns
    -------
    DrivenSet or None
        The first set, by size and then by the inverse form, whose torques do; `fewest` where no smaller set can start a
        nappe alone.  None where none was found.
    """
    inverse = inverse_form(motion)
    axis = motion.side * motion.basis[:, 0]
    n, alone = len(axis), 0
    for size in range(1, n + 1):
        some = []
        for creases in combinations(range(n), size):
            most -= 1
            if most < 0:
                return None
            part = np.eye(n)[:, creases]
            _, values, vt = np.linalg.svd(others.T @ part)
            free = part @ vt[int((values > SAME_DIRECTION).sum()) :].T
            if not free.shape[1]:
                continue
            values, vectors = np.linalg.eigh(free.T @ inverse @ free)
            if values[-1] * motion.form[0] <= SAME_DIRECTION:
                continue
            torques = free @ vectors[:, -1]
            torques = torques * np.sign(axis @ torques)
            torques = torques / np.abs(torques).max()
            if (np.abs(torques[list(creases)]) > SAME_DIRECTION).all():
                some.append((float(torques @ inverse @ torques), creases, torques))
        alone = alone or size * bool(some)
        some.sort(key=lambda one: (-round(one[0] * motion.form[0], DIGITS // 2), one[1]))
        for _, creases, torques in some:
            torques = np.round(torques, DIGITS)
            found, strict = ways(motion, torques)
            if strict and len(found) == 1:
                work = float(found[0] @ torques)
                which = tuple(c + 1 for c in creases)
                fewest = size == alone and not motion.stops.any()
                sizes = tuple(torques[list(creases)].tolist())
                return DrivenSet(branch, which, sizes, work, fewest)
    return None
