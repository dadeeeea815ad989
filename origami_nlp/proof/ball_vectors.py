"""Vectors and matrices of balls and jets, along the first axes of their arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from origami_nlp.proof.balls import Ball, Jet


def determinant(a: Any, b: Any, c: Any) -> Any:
    """Return det(a, b, c) of vectors [3, ...], of balls or jets."""
    at: Any = jet_part if isinstance(a, Jet) else part
    (a0, a1, a2), (b0, b1, b2), (c0, c1, c2) = ([at(v, i) for i in range(3)] for v in (a, b, c))
    return a0 * (b1 * c2 + -(b2 * c1)) + a1 * (b2 * c0 + -(b0 * c2)) + a2 * (b0 * c1 + -(b1 * c0))


def corner(x: Ball, i: int) -> Ball:
    """Return corner i of corners [3, q, K]."""
    return part(x, np.s_[:, i])


def rolled(x: Ball, steps: int = 1) -> Ball:
    """Return the corner that follows each, or that so many steps on."""
    return Ball(np.roll(x.centre, -steps, axis=1), np.roll(x.radius, -steps, axis=1))


def part(x: Ball, index: Any) -> Ball:
    """Return what an index selects."""
    return Ball(x.centre[index], np.broadcast_to(x.radius, x.centre.shape)[index])


def jet_part(x: Jet, index: Any) -> Jet:
    """Return what an index selects of a function and its derivative."""
    return Jet(part(x.value, index), part(x.slope, index))


def product(a: Jet, b: Jet) -> Jet:
    """Return the product of matrices [3, 3, K] and [3, m, K]."""
    terms = [jet_part(a, np.s_[:, j, None]) * jet_part(b, np.s_[None, j]) for j in range(3)]
    return terms[0] + terms[1] + terms[2]


def stacked(balls: list[Ball]) -> Ball:
    """Return balls of one shape as one, along a new first axis."""
    return Ball(np.array([b.centre for b in balls]), np.array([b.radius for b in balls]))
