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

import numpy as np

from origami_nlp.chart import admissible
from origami_nlp.kkt import State, project
from origami_nlp.numerics import INDEPENDENT
from origami_nlp.pattern import Scene
from origami_nlp.problem import Contact, Parameters, Problem

RADII = (1e-3, 2e-4)
"""Radii [rad] of the small spheres, in the tangent plane of the model's variables."""
SAMPLES, BISECTIONS = 240, 20
"""Directions sampled on each circle, and halvings at ends of arcs."""


Placing = Callable[[np.ndarray], np.ndarray]
"""Angles [K] on one circle of directions -> closed states [K, n]."""
Way = tuple[np.ndarray, tuple[Contact, ...]]
"""Along a handle: a direction [n], and the contacts that stay closed."""


@dataclass(frozen=True)
class Circle:
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
        arcs = sum(max(count_arcs(c.inside), int(c.inside.all())) for c in self.circles)
        return arcs + len(self.thin)

    def lower(self, hinges: Parameters) -> tuple[int, bool, bool]:
        """Return chi of the lower link, whether the lower link is empty, and whether it is the whole link."""
        # not as a difference: U(x) - U(p) goes as r^2, r = 2e-4
        low = hinges.energy_change(self.center, self.thin) < 0
        chi, empty, whole = int(low.sum()), not low.any(), bool(low.all())
        for circle in self.circles:
            low = circle.inside & (hinges.energy_change(self.center, circle.x) < 0)
            chi += count_arcs(low)
            empty &= not low.any()
            whole &= bool((low == circle.inside).all())
        return chi, empty, whole and not empty


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
    circles = []
    for place in _placings(state, radius):
        # an irrational shift keeps samples off the symmetric directions in which contacts stay closed
        theta = (np.arange(SAMPLES) + 0.382) * (2 * np.pi / SAMPLES)
        inside = admissible(scene, problem.expand(place(theta)))
        theta = np.concatenate([theta, _ends(scene, problem, place, theta, inside)])
        inside = np.append(inside, np.ones(len(theta) - SAMPLES, dtype=bool))
        order = np.argsort(theta % (2 * np.pi))
        circles.append(Circle(place(theta[order]), inside[order]))
    thin = [
        project(problem, state.x + radius * way / np.linalg.norm(way), rows)[0]
        for way, rows in handles
    ]
    return Link(state.x, radius, tuple(circles), np.array(thin).reshape(-1, problem.size))


def _ends(
    scene: Scene, problem: Problem, place: Placing, theta: np.ndarray, inside: np.ndarray
) -> np.ndarray:
    """Return the angles at which the arcs of X end, bisected between samples: the last ones inside."""
    after = np.append(theta[1:], theta[0] + 2 * np.pi)
    ends = inside != np.roll(inside, -1)
    low = np.where(inside, theta, after)[ends]
    high = np.where(inside, after, theta)[ends]
    for _ in range(BISECTIONS * bool(len(low))):
        middle = 0.5 * (low + high)
        good = admissible(scene, problem.expand(place(middle)))
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    return low


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
