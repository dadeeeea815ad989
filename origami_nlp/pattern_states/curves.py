"""All curves of states that a search has found (one degree of freedom), each once, with its symmetric images."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import CLOSURE_TOL, SETTLED
from origami_nlp.pattern_problem import PaperSymmetry, PatternProblem, image
from origami_nlp.pattern_states.branch_points import dips
from origami_nlp.pattern_states.clearance import Clearance, Stretches
from origami_nlp.pattern_states.curve import follow_curve, follow_from_flat
from origami_nlp.pattern_states.interpolant import ON_CURVE, Interpolant, interpolate

FIRST = 8
"""Fold angles that are compared before all are."""
LONG = 0.08
"""Largest step along curves that polynomials fill in [rad]."""


@dataclass(frozen=True, eq=False, repr=False)
class TracedCurve(ShortRepr):
    """A curve of states with one degree of freedom.

    Attributes
    ----------
    curve
        As polynomials.
    stretches
        Where facets cross along it; None where contact is not asked for.
    branch_points
        States of it, not flat or folded flat, at which closure loses rank, [n] each.
    meets
        All states of it at which closure loses rank.
    """

    curve: Interpolant
    stretches: Stretches | None
    branch_points: tuple[np.ndarray, ...]
    meets: tuple[np.ndarray, ...] = ()

    @property
    def complete(self) -> bool:
        """Whether both ends are fold limits, or the curve is closed."""
        return all(end in ("limit", "closed") for end in self.curve.ends)

    def image(self, symmetry: PaperSymmetry) -> TracedCurve:
        """Return where a symmetry of the paper takes it."""
        seen = self.stretches
        if seen is not None:
            seen = replace(seen, states=image(symmetry, seen.states))
        branch_points, meets = (
            tuple(image(symmetry, x) for x in which) for which in (self.branch_points, self.meets)
        )
        return TracedCurve(self.curve.image(symmetry), seen, branch_points, meets)


class TracedCurves:
    """Curves that were found.

    Parameters
    ----------
    problem
        The problem.
    """

    def __init__(self, problem: PatternProblem) -> None:
        self.problem = problem
        self.found: list[TracedCurve] = []
        # of all steps of these: the curve that each is of, and its box
        self._of, self._low = list[np.ndarray](), np.zeros((problem.size, 0))
        self._high = self._low

    @cached_property
    def clearance(self) -> Clearance:
        """Gaps of all pairs of facets: of sheets whose curves are traced."""
        return Clearance(self.problem)

    def __contains__(self, phi: np.ndarray) -> bool:
        """Return whether a closed state is on one of the curves."""
        if len(self._of) < len(self.found):
            self._of += [np.full(len(t.curve.boxes), k) for k, t in enumerate(self.found)][
                len(self._of) :
            ]
            boxes = np.concatenate([traced.curve.boxes for traced in self.found])
            self._low, self._high = (np.ascontiguousarray(boxes[:, k].T) for k in (0, 1))
        # of all steps at once: most are far, as few angles say
        low, high, few = self._low[:FIRST], self._high[:FIRST], phi[:FIRST, None]
        near = np.flatnonzero(((low <= few) & (few <= high)).all(axis=0))
        low, high = self._low[:, near], self._high[:, near]
        near = near[((low <= phi[:, None]) & (phi[:, None] <= high)).all(axis=0)]
        which = np.unique(np.concatenate([*self._of, np.zeros(0, int)])[near])
        return any(self._on(self.found[k].curve, phi) for k in which.tolist())

    def trace(self, phi: np.ndarray, along: np.ndarray) -> list[TracedCurve]:
        """Trace the curve through a closed state that is on none yet.

        Parameters
        ----------
        phi
            The state, [n].
        along
            Direction of the curve there, [n].

        Returns
        -------
        list of TracedCurve
            The curve, and its images that are not known yet; none where fold limits leave the state alone.
        """
        curve = self._followed(phi, along)
        if not len(curve.control):  # fold limits are in the way, there and back
            return []
        seen = self.clearance.along(curve) if self.problem.contact else None
        meets = tuple(dips(self.problem, curve))
        meet = [x for x in meets if np.abs(np.sin(x)).max() > SETTLED]
        new = [TracedCurve(curve, seen, tuple(meet), meets)]
        self.found += new
        for symmetry in self.problem.labels.images:
            other = image(symmetry, phi)
            if self.problem.residual(other) <= CLOSURE_TOL and other not in self:
                copy = new[0].image(symmetry)
                new.append(copy)
                self.found.append(copy)
        return new

    def _followed(self, phi: np.ndarray, along: np.ndarray) -> Interpolant:
        """Return the curve through a closed state: of one through the flat state beside it half is followed."""
        half = follow_from_flat(self.problem, phi, LONG)
        if half is not None:
            curve = interpolate(self.problem, half)
            if curve.fits and self._on(curve, phi):
                return curve
        return interpolate(self.problem, follow_curve(self.problem, phi, along, LONG))

    def _on(self, curve: Interpolant, phi: np.ndarray) -> bool:
        """Return whether a closed state is on a curve: by its polynomials, as steps of Newton may go over to others."""
        distance = np.linalg.norm(curve.states - phi, axis=1)
        i = int(distance.argmin())
        if distance[i] > 2 * LONG * math.sqrt(self.problem.size):
            return False
        steps = [step for step in (i - 1, i) if 0 <= step < len(curve.control)]
        low, high = curve.boxes[steps].swapaxes(0, 1)
        inside = ((phi >= low) & (phi <= high)).all(axis=1)
        return any(
            near and curve.nearest(step, phi)[1] < ON_CURVE
            for step, near in zip(steps, inside, strict=True)
        )
