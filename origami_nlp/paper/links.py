"""The link of a state: what the contact-admissible set X looks like on a small sphere around it.

X is a set of at most two dimensions, so its link is a one-dimensional set: arcs, full circles and points.  Where
closure is regular the states near p are a graph over the tangent plane Z (closure's null space),

    x(theta) = p + r Z (cos theta, sin theta) + normal part of closure,

one circle.  At the flat state closure loses one rank: on the kernel [n, 3] states leave along the cone d . Q d = 0
(`State.second_order`), whose directions of unit length are two circles where Q has mixed signs and none where it is
definite.  Each circle is sampled; directions in which a closed contact
stays closed are roots of its opening on the circle, found by bisection, and looked at one by one with the
order of layers, because a handle meets the circle in such a direction only.

Lower link = link in {U < U(p)}; a state contributes 1 - chi(lower link) to the Euler characteristic of X.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from origami_nlp.chart import admissible
from origami_nlp.kkt import State, project
from origami_nlp.numerics import FOLLOWED, INDEPENDENT, RANK, ROUNDED, SETTLED, bracketed_roots
from origami_nlp.pattern import Scene
from origami_nlp.problem import Contact, Parameters, Problem

RADII = (1e-3, 2e-4)
"""Radii [rad] of the small spheres, in the tangent plane of the model's variables."""
SAMPLES, BISECTIONS = 240, 20
"""Directions sampled on each circle, besides those in which contacts stay closed, and halvings at ends of arcs."""


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

    center: np.ndarray
    radius: float
    circles: tuple[Circle, ...]

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
    """Return every contact that is closed at a state, whichever way facets lie."""
    found = state.contacts
    rows = [*found.base, *(row for options in found.branches for o in options for row in o)]
    return tuple(dict.fromkeys([*rows, *(again for again, _ in found.implied)]))


def openings_of(problem: Problem, x: np.ndarray, rows: tuple[Contact, ...]) -> np.ndarray:
    """Return how far contacts are open at states [K, n], shape [K, r]."""
    values: np.ndarray = problem.constraints(x, rows)[0][:, problem.equation_count :]
    return values


def link_of(scene: Scene, state: State, radius: float, samples: int = SAMPLES) -> Link:
    """Sample the link of an admissible state of a scene at one radius.

    Raises
    ------
    ValueError
        Where closure loses more than one rank, or its quadratic form is degenerate: the cone is unknown.
    """
    # a handle is held by contacts of which none is one of a choice
    problem, rows = state.problem, state.contacts.base
    circles = []
    for place in _placings(state, radius):
        # an irrational shift keeps samples off the symmetric directions in which contacts stay closed
        theta = (np.arange(samples) + 0.382) * (2 * np.pi / samples)
        roots = _roots(problem, place, theta, rows, radius)
        if len(roots):
            ends = np.sort(np.concatenate([theta, roots]))
            middle = 0.5 * (ends + np.roll(ends, -1))
            middle[-1] = 0.5 * (ends[-1] + ends[0] + 2 * np.pi)
            # between two roots in one cell no sample lies: add one
            crowded = np.isin(ends, roots) & np.isin(np.roll(ends, -1), roots)
            theta = np.concatenate([theta, middle[crowded]])
        inside = admissible(scene, problem.expand(place(theta)))
        theta = np.concatenate([theta, _ends(scene, problem, place, theta, inside)])
        at = place(theta)
        inside = np.concatenate([inside, np.ones(len(theta) - len(inside), dtype=bool)])
        special, good = _on_contacts(scene, problem, place, roots, rows, radius)
        order = np.argsort(np.concatenate([theta, roots]) % (2 * np.pi))
        circles.append(
            Circle(np.concatenate([at, special])[order], np.concatenate([inside, good])[order])
        )
    return Link(state.x, radius, tuple(circles))


def _ends(
    scene: Scene, problem: Problem, place: Placing, theta: np.ndarray, inside: np.ndarray
) -> np.ndarray:
    """Return the angles at which the arcs of X end, bisected between samples: the last ones inside."""
    order = np.argsort(theta)
    theta, inside = theta[order], inside[order]
    after = np.append(theta[1:], theta[0] + 2 * np.pi)
    ends = inside != np.roll(inside, -1)
    low = np.where(inside, theta, after)[ends]
    high = np.where(inside, after, theta)[ends]
    for _ in range(BISECTIONS * bool(len(low))):
        middle = 0.5 * (low + high)
        good = admissible(scene, problem.expand(place(middle)))
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    return low


def _on_contacts(
    scene: Scene,
    problem: Problem,
    place: Placing,
    roots: np.ndarray,
    rows: tuple[Contact, ...],
    radius: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the states at which contacts stay closed, and whether they belong to X (layers ordered)."""
    at = place(roots) if len(roots) else np.zeros((0, problem.size))
    good = np.zeros(len(at), dtype=bool)
    values = openings_of(problem, at, rows)
    for k in range(len(at)):
        held = tuple(
            row for row, v in zip(rows, values[k], strict=True) if abs(v) <= 2 * SETTLED * radius
        )
        snapped, residual = project(problem, at[k], held, steps=6)
        if residual <= FOLLOWED and admissible(scene, problem.expand(snapped[None]))[0]:
            at[k], good[k] = snapped, not problem.refuses(snapped)
    return at, good


def _roots(
    problem: Problem,
    place: Placing,
    theta: np.ndarray,
    rows: tuple[Contact, ...],
    radius: float,
) -> np.ndarray:
    """Return the angles at which a row changes sign on the circle, sorted and distinct."""
    if not rows:
        return np.zeros(0)
    values = openings_of(problem, place(theta), rows)
    cell, which = np.nonzero((values > 0) != (np.roll(values, -1, axis=0) > 0))
    if not len(cell):
        return np.zeros(0)

    def opening(at: np.ndarray) -> np.ndarray:
        return openings_of(problem, place(at), rows)[np.arange(len(at)), which]

    low = theta[cell]
    found = np.sort(bracketed_roots(opening, low, low + 2 * np.pi / len(theta)) % (2 * np.pi))
    # contacts that say the same to first order change sign within the radius of each other
    return found[np.concatenate([[True], np.diff(found) > radius])]


def _placings(state: State, radius: float) -> list[Placing]:
    """Return one function theta [K] -> states [K, n] for each circle of directions."""
    problem, forms = state.problem, state.second_order
    kernel = state.kernel / problem.root[:, None]
    if not forms:
        if kernel.shape[1] != 2:
            raise ValueError(f"the state has {kernel.shape[1]} degrees of freedom, not 2")
        return [lambda theta: _over_plane(problem, state.x, radius, kernel, theta)]
    if len(forms) > 1:
        raise ValueError(f"closure loses {len(forms)} ranks")
    form, axes = np.linalg.eigh(forms[0])
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
        return project(problem, state.x + d)[0]

    return [lambda theta: cone(theta, 1.0), lambda theta: cone(theta, -1.0)]


def _over_plane(
    problem: Problem, x: np.ndarray, radius: float, z: np.ndarray, theta: np.ndarray
) -> np.ndarray:
    """Return the closed states over a circle in the tangent plane z [n, 2]."""
    y = x + radius * np.stack([np.cos(theta), np.sin(theta)], axis=1) @ z.T
    fixed = np.broadcast_to(z.T, (len(y), 2, problem.size))
    for _ in range(6):
        g, jac = problem.constraints(y)
        if np.abs(g).max(initial=0.0) <= ROUNDED:
            break
        # Newton with the coordinates in the plane held: x(theta) over the circle, not the nearest closed state
        whole = np.concatenate([jac, fixed], axis=1)
        right = np.concatenate([-g, np.zeros((len(y), 2))], axis=1)
        y = y + np.einsum("kij,kj->ki", np.linalg.pinv(whole, rcond=RANK), right)
    return y
