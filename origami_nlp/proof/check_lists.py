"""What listed states of a pattern say, for the check of a proof: which of those found again each of them is."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from flint import arb, ctx

from origami_nlp.proof.mesh_certificate import MeshCertificate
from origami_nlp.proof.sheet_certificate import CertifiedState, OpenInterval

BITS = 128
"""Of balls."""
TERMS = 3
"""Of power series: to second derivatives, whatever FLINT is set to keep."""
STATED = 1e-11
"""Beyond its radius, by how much a fold angle may be listed off [rad]."""
WIDEST = 1e-6
"""Radius within which a minimum is listed, at most [rad]: a wider one names no state."""


class Refused(Exception):
    """A claim that was not confirmed; its text says which."""


@contextmanager
def precision() -> Iterator[None]:
    """Compute with balls of so many bits and series of so many terms."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = BITS, TERMS
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


def refuse_wide(minima: Sequence[CertifiedState]) -> None:
    """Refuse a list in which a radius does not distinguish a minimum from others.

    Raises
    ------
    Refused
        With the first.
    """
    for number, one in enumerate(minima, start=1):
        if not 0 <= one.radius <= WIDEST:
            raise Refused(
                f"minimum {number} is listed to within {one.radius:.3g} rad: at most {WIDEST:g}"
            )


def is_listed(angle: Any, said: float, radius: float) -> bool:
    """Return whether a fold angle is what is listed: 0 exactly, at +-180 degrees exactly, or to within a radius."""
    if angle.is_zero() or abs(said) == math.pi or not said:
        return bool(angle.is_zero() and not said) or bool(said * angle > 0 and _is_half_turn(angle))
    # of a sheet that is known to within a deviation the fold is known to within what that makes of it
    near = arb(said, radius + STATED).overlaps(angle) and angle.rad() <= WIDEST
    return not _is_half_turn(angle) and bool(near)


def kinds_of(angles: Sequence[Any]) -> tuple[int, ...]:
    """Return of each fold angle, found or listed, whether it is 0, +-180 degrees (+-2) or another (1).

    Only states that agree in these can be one for `is_listed`: the others need not be compared.
    """
    half = [
        abs(a) == math.pi if isinstance(a, float) else not a.is_zero() and _is_half_turn(a)
        for a in angles
    ]
    return tuple(
        (2 if a > 0 else -2) if turned else int(a != 0)
        for a, turned in zip(angles, half, strict=True)
    )


def _is_half_turn(angle: Any) -> bool:
    return bool((abs(angle) - arb.pi()).contains(0))


def within(folds: Sequence[Any], one: OpenInterval) -> bool:
    """Return whether a state may be in what is left open."""
    return all(
        bool(low - STATED <= a) and bool(a <= high + STATED)
        for a, low, high in zip(folds, one.lower, one.upper, strict=True)
    )


class ListCheck:
    """A check that finds the minima of a mesh again.

    Attributes
    ----------
    said
        The certificate.
    open
        What the check leaves open, a line each.
    confirmed
        Minima of the list that were found, from 1.
    maxima
        Of the energy, inside curves.
    counts
        What was gone through.
    """

    def __init__(self, said: MeshCertificate) -> None:
        self.said = said
        self.open: list[str] = []
        self.confirmed: list[int] = []
        self.maxima = 0
        self.counts: dict[str, int] = {}

    def hold(self, found: list[list[Any]]) -> None:
        """Hold the minima that were found against those that are listed.

        Raises
        ------
        Refused
            If one is not listed, or one that is was not found.
        """
        alike: dict[tuple[int, ...], list[tuple[int, CertifiedState]]] = {}
        for number, one in enumerate(self.said.minima, start=1):
            alike.setdefault(kinds_of(one.fold_angles), []).append((number, one))
        for folds in found:
            some = alike.get(kinds_of(folds), [])
            near = [
                k
                for k, (_, m) in enumerate(some)
                if all(is_listed(a, x, m.radius) for a, x in zip(folds, m.fold_angles, strict=True))
            ]
            if near:
                self.confirmed.append(some.pop(near[0])[0])
            elif not any(within(folds, one) for one in self.said.undecided):
                angles = ", ".join(f"{math.degrees(float(f.mid())):.6g}" for f in folds)
                raise Refused(f"a minimum is not listed: fold angles ({angles}) deg")
        left = sorted((x for some in alike.values() for x in some), key=lambda x: x[0])
        if left and not self.open:
            raise Refused(f"minimum {left[0][0]} does not follow from the sheet and its springs")
        self.open = list(dict.fromkeys(self.open)) + [
            one.reason for one in self.said.undecided if not self.open
        ]
        self.open += [f"minimum {number} of the list: not found again" for number, _ in left]
        self.confirmed.sort()
