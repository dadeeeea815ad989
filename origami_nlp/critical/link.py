"""The link of a state: what the contact-admissible set X looks like on a small sphere around it.

X is a set of at most two dimensions, so its link is a one-dimensional set: arcs, full circles and points.  Where
closure is regular the states near p are a graph over the tangent plane Z (closure's null space),

    x(theta) = p + r Z (cos theta, sin theta) + normal part of closure,

one circle.  At the flat state closure loses one rank: with u the left null vector and K the kernel [n, 3], states
leave along the cone d . Q d = 0, Q = K' (Hessian of u . closure) K, whose directions of unit length are two circles
where Q has mixed signs and none where it is definite.  Each circle is sampled; directions in which a closed contact
stays closed are roots of its opening on the circle, found by bisection, and looked at one by one with the
order of layers, because a handle meets the circle in such a direction only.

Lower link = link in {U < U(p)}; a state contributes 1 - chi(lower link) to the Euler characteristic of X.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import State, project
from origami_nlp.numerics import (
    FOLLOWED,
    INDEPENDENT,
    RANK,
    ROUNDED,
    SETTLED,
    bracketed_roots,
    null_space,
)
from origami_nlp.problem import Contact, Parameters, Problem

RADII = (1e-3, 2e-4)
"""Radii [rad] of the small spheres, in the tangent plane of the model's variables."""
SAMPLES = 480
"""Directions sampled on each circle, besides those in which contacts stay closed."""


Placing = Callable[[np.ndarray], np.ndarray]
"""Angles [K] on one circle of directions -> closed states [K, n]."""


@dataclass(frozen=True)
class Circle:
    """One circle of directions: states x [S, n] in cyclic order, and which of them belong to X."""

    x: np.ndarray
    inside: np.ndarray


@dataclass(frozen=True)
class Link:
    """The link of a state at one radius.

    center: [n].  radius: [rad].  circles: none where closure isolates the state, one where it is regular, two at
    the tip of a double cone.
    """

    model: Problem
    center: np.ndarray
    radius: float
    circles: tuple[Circle, ...]

    @property
    def euler_characteristic(self) -> int:
        """Arcs and points of the link, a full circle counting 0."""
        return sum(count_arcs(c.inside) for c in self.circles)

    @property
    def pieces(self) -> int:
        """Connected pieces of the link (a state with two or more is a cut point of its neighbourhood)."""
        return sum(max(count_arcs(c.inside), int(c.inside.all())) for c in self.circles)

    @property
    def thin(self) -> int:
        """Pieces that are single directions: ends of one-dimensional sets."""
        return sum(_lone(c.inside) for c in self.circles)

    def lower(self, hinges: Parameters) -> tuple[int, bool, bool]:
        """Return chi of the lower link, whether the lower link is empty, and whether it is the whole link."""
        chi, empty, whole = 0, True, True
        for circle in self.circles:
            # not as a difference: U(x) - U(p) goes as r^2, r = 2e-4
            low = circle.inside & (hinges.energy_change(self.center, circle.x) < 0)
            chi += count_arcs(low)
            empty &= not low.any()
            whole &= bool((low == circle.inside).all())
        return chi, empty, whole and not empty


def count_arcs(mask: np.ndarray) -> int:
    """Number of runs of True in a cyclic sequence; 0 where all are True (a circle has chi = 0)."""
    return int((mask & ~np.roll(mask, 1)).sum())


def _lone(mask: np.ndarray) -> int:
    """Number of runs of length one."""
    return int((mask & ~np.roll(mask, 1) & ~np.roll(mask, -1)).sum())


def closed_rows(state: State) -> tuple[Contact, ...]:
    """Return every contact whose opening vanishes at a state, touching or not."""
    every = (*state.problem.limits, *state.problem.every_gap)
    openings = state.on(every).openings
    return tuple(c for c, v in zip(every, openings, strict=True) if abs(v) <= state.tolerance)


def link_of(state: State, radius: float, samples: int = SAMPLES) -> Link:
    """Sample the link of an admissible state at one radius.

    Raises
    ------
    ValueError
        Where closure loses more than one rank, or its quadratic form is degenerate: the cone is unknown.
    """
    model, rows = state.problem, closed_rows(state)
    circles = []
    for place in _placings(state, radius):
        # an irrational shift keeps samples off the symmetric directions in which contacts stay closed
        theta = (np.arange(samples) + 0.382) * (2 * np.pi / samples)
        roots = _roots(model, place, theta, rows)
        if len(roots):
            ends = np.sort(np.concatenate([theta, roots]))
            middle = 0.5 * (ends + np.roll(ends, -1))
            middle[-1] = 0.5 * (ends[-1] + ends[0] + 2 * np.pi)
            # between two roots in one cell no sample lies: add one
            crowded = np.isin(ends, roots) & np.isin(np.roll(ends, -1), roots)
            theta = np.concatenate([theta, middle[crowded]])
        at = place(theta)
        inside = model.admissible(at)
        special, good = _on_contacts(model, place, roots, rows, radius)
        order = np.argsort(np.concatenate([theta, roots]) % (2 * np.pi))
        circles.append(
            Circle(np.concatenate([at, special])[order], np.concatenate([inside, good])[order])
        )
    return Link(model, state.x, radius, tuple(circles))


def _on_contacts(
    model: Problem, place: Placing, roots: np.ndarray, rows: tuple[Contact, ...], radius: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the states at which contacts stay closed, and whether they belong to X (layers ordered)."""
    at = place(roots) if len(roots) else np.zeros((0, model.size))
    good = np.zeros(len(at), dtype=bool)
    values, _ = model.local(at).openings(rows)
    for k in range(len(at)):
        held = tuple(
            row for row, v in zip(rows, values[k], strict=True) if abs(v) <= 2 * SETTLED * radius
        )
        snapped, residual = project(model, at[k : k + 1], held, steps=6)
        if residual[0] <= FOLLOWED and model.admissible(snapped)[0]:
            at[k], good[k] = snapped[0], (not model.refuses(snapped[0]))
    return at, good


def _roots(
    model: Problem, place: Placing, theta: np.ndarray, rows: tuple[Contact, ...]
) -> np.ndarray:
    """Return the angles at which a row changes sign on the circle, sorted and distinct."""
    if not rows:
        return np.zeros(0)
    values, _ = model.local(place(theta)).openings(rows)
    after = np.roll(values, -1, axis=0)
    cell, which = np.nonzero((values > 0) != (after > 0))
    if not len(cell):
        return np.zeros(0)

    def opening(at: np.ndarray) -> np.ndarray:
        return model.local(place(at)).openings(rows)[0][np.arange(len(at)), which]

    low = theta[cell]
    found = np.sort(bracketed_roots(opening, low, low + 2 * np.pi / len(theta)) % (2 * np.pi))
    return found[np.concatenate([[True], np.diff(found) > SETTLED])]


def _placings(state: State, radius: float) -> list[Placing]:
    """Return one function theta [K] -> states [K, n] for each circle of directions."""
    model, x, jac = state.problem, state.x, state.local.closure_jacobian
    u, sizes, _ = np.linalg.svd(jac)
    lost = int((sizes <= RANK).sum())
    if lost == 0:
        z = null_space(jac)
        if z.shape[1] != 2:
            raise ValueError(f"the state has {z.shape[1]} degrees of freedom, not 2")
        return [lambda theta: _over_plane(model, x, radius, z, theta)]
    if lost > 1:
        raise ValueError(f"closure loses {lost} ranks")
    left = u[:, -1]
    kernel = np.linalg.svd(jac)[2][len(sizes) - 1 :].T
    # sum u_k Hess c_k
    hessian = model.lagrangian_hessian(x, -left, (), 0.0)
    form, axes = np.linalg.eigh(kernel.T @ hessian @ kernel)
    if np.abs(form).min() <= INDEPENDENT or len(form) != 3:
        raise ValueError("the quadratic form of closure is degenerate")
    # three eigenvalues: two of one sign, and one of the other if the form is a cone
    sign = np.sign(np.median(np.sign(form)))
    alone = int(np.argmin(sign * form))
    if sign * form[alone] > 0:
        return []  # definite: closure isolates the state
    two = [i for i in range(3) if i != alone]
    axes = kernel @ axes
    # lambda_0 + lambda_1 (s_1 cos)^2 + lambda_2 (s_2 sin)^2 = 0 with s_i^2 = |lambda_0 / lambda_i|
    stretch = np.sqrt(np.abs(form[alone]) / np.abs(form[two]))

    def cone(theta: np.ndarray, side: float) -> np.ndarray:
        d = side * axes[:, alone] + np.outer(stretch[0] * np.cos(theta), axes[:, two[0]])
        d = d + np.outer(stretch[1] * np.sin(theta), axes[:, two[1]])
        d = radius * d / np.linalg.norm(d, axis=1, keepdims=True)
        return project(model, x + d)[0]

    return [lambda theta: cone(theta, 1.0), lambda theta: cone(theta, -1.0)]


def _over_plane(
    model: Problem, x: np.ndarray, radius: float, z: np.ndarray, theta: np.ndarray
) -> np.ndarray:
    """Return the closed states over a circle in the tangent plane z [n, 2]."""
    y = x + radius * np.stack([np.cos(theta), np.sin(theta)], axis=1) @ z.T
    fixed = np.broadcast_to(z.T, (len(y), 2, model.size))
    for _ in range(6):
        g, jac = model.closure(y)
        if np.abs(g).max(initial=0.0) <= ROUNDED:
            break
        right = np.concatenate([-g, np.zeros((len(y), 2))], axis=1)
        # Newton with the coordinates in the plane held: x(theta) over the circle, not the nearest closed state
        y = y + np.linalg.solve(np.concatenate([jac, fixed], axis=1), right[..., None])[..., 0]
    return y
