"""The link of a state: what the contact-admissible set X looks like on a small sphere around it.

X is a set of at most two dimensions, so its link is a one-dimensional set: arcs, full circles and points.  Where
closure is regular the states near p are a graph over the tangent plane Z (closure's null space),

    x(theta) = p + r Z (cos theta, sin theta) + normal part of closure,

one circle.  At the flat state closure loses one rank: on the kernel [n, 3] states leave along the cone d . Q d = 0
(`State.second_order`), whose directions of unit length are two circles where Q has mixed signs and none where it is
definite.  Each circle is sampled, and ends of arcs are
bisected; a handle meets it in a single direction, which who knows the handle gives.

Lower link = link in {U < U(p)}; a state contributes 1 - chi(lower link) to the Euler characteristic of X.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from origami_nlp.chart import admissible
from origami_nlp.kkt import State, project
from origami_nlp.numerics import INDEPENDENT
from origami_nlp.pattern import Scene
from origami_nlp.problem import Contact, Parameters

RADII = (1e-3, 2e-4)
"""Radii [rad] of the small spheres, in the tangent plane of the model's variables."""
SAMPLES, BISECTIONS = 240, 20
"""Directions sampled on each circle, and halvings at ends of arcs."""


Placing = Callable[[np.ndarray], np.ndarray]
"""Angles [K] on one circle of directions -> closed states [K, n]."""
Way = tuple[np.ndarray, tuple[Contact, ...]]
"""Along a handle: a direction [n], and the contacts that stay closed."""


class Circle(NamedTuple):
    """One circle of directions: states x [S, n] in cyclic order, and which of them belong to X."""

    x: np.ndarray
    inside: np.ndarray


@dataclass(frozen=True)
class Link:
    """The link of a state at one radius.

    center: [n].  radius: [rad].  circles: none where closure isolates the state, one where it is regular, two at
    the tip of a double cone.  thin: states [h, n] on the handles that meet there.
    """

    center: np.ndarray
    radius: float
    circles: tuple[Circle, ...]
    thin: np.ndarray

    @property
    def pieces(self) -> int:
        """Connected pieces of the link (a state with two or more is a cut point of its neighbourhood)."""
        arcs = (max(count_arcs(c.inside), int(c.inside.all())) for c in self.circles)
        return sum(arcs) + len(self.thin)

    def lower(self, hinges: Parameters) -> tuple[int, bool, bool]:
        """Return chi of the lower link, whether the lower link is empty, and whether it is the whole link."""
        # not as a difference: U(x) - U(p) goes as r^2, r = 2e-4
        thin = hinges.energy_change(self.center, self.thin) < 0
        low = [c.inside & (hinges.energy_change(self.center, c.x) < 0) for c in self.circles]
        chi = int(thin.sum()) + sum(map(count_arcs, low))
        any_low = bool(thin.any()) or any(map(np.any, low))
        same = (np.array_equal(x, c.inside) for x, c in zip(low, self.circles, strict=True))
        return chi, not any_low, any_low and bool(thin.all()) and all(same)


def count_arcs(mask: np.ndarray) -> int:
    """Number of runs of True in a cyclic sequence; 0 where all are True (a circle has chi = 0)."""
    return int((mask & ~np.roll(mask, 1)).sum())


def link_of(scene: Scene, state: State, radius: float, handles: Sequence[Way] = ()) -> Link:
    """Sample the link of an admissible state of a scene at one radius.

    Raises
    ------
    ValueError
        Where closure loses more than one rank, or its quadratic form is degenerate: the cone is unknown.
    """
    problem = state.problem

    def circle(place: Placing) -> Circle:
        # an irrational shift keeps samples off the symmetric directions in which contacts stay closed
        theta = (np.arange(SAMPLES) + 0.382) * (2 * np.pi / SAMPLES)
        inside = admissible(scene, problem.expand(place(theta)))
        after = np.append(theta[1:], theta[0] + 2 * np.pi)
        ends = inside != np.roll(inside, -1)
        # arcs of X end between samples: the last ones inside are bisected
        low, high = (np.where(inside, a, b)[ends] for a, b in ((theta, after), (after, theta)))
        for _ in range(BISECTIONS * bool(len(low))):
            middle = 0.5 * (low + high)
            good = admissible(scene, problem.expand(place(middle)))
            low, high = np.where(good, middle, low), np.where(good, high, middle)
        theta = np.append(theta, low)
        inside = np.append(inside, np.ones(len(low), dtype=bool))
        order = np.argsort(theta % (2 * np.pi))
        return Circle(place(theta[order]), inside[order])

    thin = [
        project(problem, state.x + radius * way / np.linalg.norm(way), rows)[0]
        for way, rows in handles
    ]
    circles = tuple(map(circle, _placings(state, radius)))
    return Link(state.x, radius, circles, np.array(thin).reshape(-1, problem.size))


def _placings(state: State, radius: float) -> list[Placing]:
    """Return one function theta [K] -> states [K, n] for each circle of directions."""
    problem, forms = state.problem, state.second_order
    kernel = state.kernel / problem.root[:, None]
    if not forms:
        if kernel.shape[1] != 2:
            raise ValueError(f"the state has {kernel.shape[1]} degrees of freedom, not 2")

        def circle(theta: np.ndarray) -> np.ndarray:
            d = np.stack([np.cos(theta), np.sin(theta)], axis=1) @ kernel.T
            return project(problem, state.x + radius * d)[0]

        return [circle]
    if len(forms) > 1:
        raise ValueError(f"closure loses {len(forms)} ranks")
    form, axes = np.linalg.eigh(forms[0])
    if np.abs(form).min() <= INDEPENDENT or len(form) != 3:
        raise ValueError("the quadratic form of closure is degenerate")
    # three eigenvalues: two of one sign, and one of the other if the form is a cone
    alone = int(np.argmin(np.sign(np.median(form)) * form))
    two = [i for i in range(3) if i != alone]
    if form[alone] * form[two[0]] > 0:
        return []  # definite: closure isolates the state
    axes = kernel @ axes
    # lambda_0 + lambda_1 (s_1 cos)^2 + lambda_2 (s_2 sin)^2 = 0 with s_i^2 = |lambda_0 / lambda_i|
    stretched = axes[:, two] * np.sqrt(np.abs(form[alone]) / np.abs(form[two]))

    def cone(side: float, theta: np.ndarray) -> np.ndarray:
        d = side * axes[:, alone] + np.stack([np.cos(theta), np.sin(theta)], axis=1) @ stretched.T
        d = radius * d / np.linalg.norm(d, axis=1, keepdims=True)
        return project(problem, state.x + d)[0]

    return [partial(cone, 1.0), partial(cone, -1.0)]
