"""Section 3, full-space equilibrium of states pinned at a contact."""

from __future__ import annotations

from functools import cache
from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims.section3_energy import (
    PATTERN_6,
    PATTERN_8,
    crease_average,
    criticality,
    pinned_example,
)
from ..decide import Correction, by_cases
from ..groups import crease_images
from ..statement import Several, one_of, row
from ..tips import (
    descent,
    fold_angles,
    gap_gradient,
    separating_normal,
    slide,
    tip_directions,
    tip_example,
    tip_velocity,
    touching_facets,
)

Cases = list[tuple[str, bool]]

_GENUINE, _PERMUTED, _ALONE = "any genuine contact", "smooth gaps, all images", "one smooth gap"
_NONNEGATIVE, _ANY = "nonnegative", "any sign"
_GOOD = (_PERMUTED, _NONNEGATIVE)

_AVERAGING = (
    "a torque with the symmetry of the creases sees averages only, dU.v = dU.Av, and Av is a symmetric "
    "tangent; there dU = sum mu_j dg_j, and dg_j.Av is the mean of the slopes of all images of the "
    "gap along v: averaged multipliers, still >= 0, balance the springs in the full space.  Verified "
    "exactly at rational states of both vertices and at a pinned state (degree 6, creases 2 and 6 closed)."
)


def averaging_cases(gaps: str, multipliers: str) -> Cases:
    """Multipliers of the symmetric problem, averaged over the group, against the full problem.

    gaps: whether the full problem has every image of the gap of the symmetric one, or that gap only.
    """
    cases: Cases = []
    for n, degree in ((1, 6), (2, 8)):
        images = crease_images(n, degree)
        row = sp.Matrix([sp.symbols(f"r_1:{degree + 1}")])
        mean = sp.zeros(1, degree)
        for p in images.values():
            mean += sp.Matrix([[row[p[i]] for i in range(degree)]]) / len(images)
        same = sp.expand(row * crease_average(n, degree) - mean) == sp.zeros(1, degree)
        cases.append((f"degree {degree}: a gap on averages is the mean of its images", same))
    state, torque, _, _ = pinned_example()
    kernel, average = state.tangents(), crease_average(1, 6)
    symmetric = sp.Matrix.hstack(*(average * kernel).columnspace())
    gap = sp.Matrix([[0, -1, 0, 0, 0, 0]])  # pi - phi_2: the only gap of a D_1 state
    mu = 2 * sp.Rational(1, 1000) * (1 if multipliers == _NONNEGATIVE else -1)
    if multipliers != _NONNEGATIVE:
        torque = -torque
    balanced = torque.T * symmetric - mu * gap * symmetric
    cases.append(("symmetric balance", balanced == 0 * balanced))
    full = gap * average if gaps != _ALONE else gap
    left = torque.T * kernel - mu * full * kernel
    cases.append((f"degree 6, creases 2 and 6 closed, {gaps}: full balance", left == 0 * left))
    opening = [v for v in kernel.T * -average.T * sp.Matrix([0, 1, 0, 0, 0, 1]) if v != 0]
    cases.append(("the contact can open", bool(opening)))
    cases.append((f"multipliers of {multipliers}: {mu}, opening the contact costs energy", mu > 0))
    return cases


def sliding_cases() -> Cases:
    """Every D_2 state with creases 3 and 7 tip to tip, C, x, y > 0: a first-order feasible descent."""
    big_c, s, x, y, z, mu = sp.symbols("C S x y z mu", positive=True)
    c_1, c_2 = (big_c, sp.Integer(0), s), (x, y, z)
    directions = tip_directions(c_1, c_2)
    matrix, normal = sp.Matrix.hstack(*directions), separating_normal(c_2)
    contact_descent, aside = slide(c_1)
    d = descent(c_1, c_2)
    gradient, _ = gap_gradient(directions)
    average = crease_average(2, 8)
    opening = sp.expand(normal.dot(tip_velocity(directions, d)))
    sides = [sp.expand(normal.dot(c)) for c in directions]
    energy = sp.expand(mu * (gradient.T * average * d)[0])  # dU.d = dU.Ad, and there dU = mu dg
    closes = sp.expand(matrix * sp.Matrix.hstack(contact_descent, aside, d)) == sp.zeros(3, 3)
    return [
        ("C d = 0", closes),
        ("rank C = 3", sp.expand(matrix[:, :3].det() - big_c * y) == 0),
        ("the average of d presses the tips together", average * d == contact_descent),
        ("creases 2, 4 and 6, 8 on either side", all(sides[i] > 0 > sides[i + 4] for i in (1, 3))),
        ("the tips lie on the plane and leave it on their own sides", opening.is_positive is True),
        ("the energy falls", energy.is_negative is True),
    ]


@cache
def tip_minimum_cases() -> Cases:
    """The exact state: embedded but for the tips, and a strict symmetric minimum with mu = 1.

    Unit stiffness, rest angles phi* - grad g.  L = U - g is stationary at phi* and its Hessian is at
    least 1 - |hess g|, so U >= U* + (1 - |hess g|) |phi - phi*|^2/2 wherever g >= 0.
    """
    state, c_1, c_2 = tip_example()
    directions = tip_directions(c_1, c_2)
    gradient, bound = gap_gradient(directions)
    average = crease_average(2, 8)
    angles = fold_angles(state)
    rest_inside = all(abs(a) + abs(g) < 3 for a, g in zip(angles, gradient, strict=True))
    contact_descent, _ = slide(c_1)
    rises = (gradient.T * -contact_descent)[0] > 0
    facets = {(i, j) for i in (1, 2) for j in (5, 6)}
    return [
        ("only facets 2, 3 and 6, 7 touch", touching_facets(directions) == facets),
        ("wedges face each other across the mirror", all(directions[i][1] > 0 for i in (1, 3))),
        ("no crease closed", all(c != -1 for c, _ in state.folds)),
        ("rest angles symmetric", average * gradient == gradient),
        ("rest angles inside (-pi, pi)", rest_inside),
        ("smooth contact in the symmetric space", bool(rises)),
        ("Lagrangian convex", bool(bound < 1)),
    ]


def _slope() -> Any:
    """DU . d at the exact tip state."""
    _, c_1, c_2 = tip_example()
    return (gap_gradient(tip_directions(c_1, c_2))[0].T * descent(c_1, c_2))[0]


def _tips() -> bool:
    """Whether the exact tip state is a first-order equilibrium as far as its descent d can tell."""
    return bool(_slope() >= 0)


def _tips_case() -> tuple[str, bool]:
    """The counterexample with its numbers, as a case that holds when it is none."""
    return (
        "creases 3 and 7 of the degree-8 vertex meet tip to tip: tan(alpha/2) = 1/3, c_1 = (35, 0, 12)"
        "/37, c_2 = (16, 12, 15)/25, c_3 = c_7 = e3, unit stiffness, rest angles phi* + (35/148, 4/25, "
        "0, 4/25, ...).  Contact c_3.e2 >= 0 with multiplier 1, a strict D_2 minimum (U >= U* + 5/16 "
        "|phi - phi*|^2).  But d = (1, k, -12/37, -k, 1, k, -12/37, -k), k = 1750/333, has C d = 0, "
        "slides the tips past each other (the plane with normal (12, 32, 0) opens between them; all other "
        f"facets are apart) and dU.d = {_slope()}",
        _tips(),
    )


def _broken_steps() -> list[str]:
    """Steps of the counterexample that do not hold (none, or the claim stays undecided)."""
    return [name for name, holds in (*tip_minimum_cases(), *sliding_cases()) if not holds]


def _decide(cases: Cases, sketch: str, correction: Correction | None, tips: bool) -> Verdict:
    """Decide by cases; undecided when the counterexample at tips is used and a step of it fails."""
    broken = _broken_steps() if tips else []
    if broken:
        return Verdict("unproved", "exact example", f"the tip state does not apply: {broken}")
    exact, linear = "exact rational counterexample", "equivariance and exact linear algebra"
    failing = any(not holds for _, holds in cases)
    return by_cases(cases, sketch, exact if failing else linear, correction)


def _statement_cases(statement: tuple[str, str]) -> Cases:
    gaps, multipliers = statement
    cases = [*criticality((PATTERN_6, PATTERN_8)), *averaging_cases(gaps, multipliers)]
    return [*cases, _tips_case()] if gaps == _GENUINE else cases


def _pinned_correction() -> Correction:
    return Correction(
        r"\nabla U\cdot v=\sum_j\mu_j\nabla g_j\cdot v\ \forall v\in\ker\mathbf C^{G},\ \mu_j\ge 0"
        r"\ \Rightarrow\ \nabla U=\mathbf C^T\lambda+\sum_{h\in G}\sum_j\tfrac{\mu_j}{|G|}\nabla(g_j"
        r"\circ h)\ \text{ if the contacts are the smooth }g_j\circ h\ge 0,\ h\in G;\qquad"
        r"\hat c_3=\hat c_7\ (N=8,\ \mathcal D_2),\ \mu>0\ \Rightarrow\ \text{no equilibrium}",
        lambda: all(ok for _, ok in (*_statement_cases(_GOOD), *sliding_cases())),
        _AVERAGING
        + "  At tips the admissible set is a union of two pieces instead, and for all C, x, y, mu > 0 "
        "(c_1 = (C, 0, S), c_2 = (x, y, z)) d = (1, k, -S, -k, ...), k = 2 x C/y^2, gives dU.d = -mu C/2: "
        "no such state is an equilibrium, whatever the springs (such are the pinned minima of "
        "alpha_1 = pi/12 and pi/6, r_k = 100).  With 'multipliers' of the full space the sentence is the "
        "definition of first-order equilibrium and says nothing about symmetry.",
    )


def _check_pinned(statement: tuple[str, str]) -> Verdict:
    """First-order conditions of pinned states: averaging where gaps are smooth, sliding at tips."""
    printed = statement == (_GENUINE, _NONNEGATIVE)
    return _decide(
        _statement_cases(statement),
        _AVERAGING[0].upper() + _AVERAGING[1:],
        _pinned_correction() if printed else None,
        statement[0] == _GENUINE,
    )


_KINDS = ("regular interior", "smooth gaps", "tips")


def _check_remaining(statement: tuple[str, ...]) -> Verdict:
    """Kinds of regular symmetric minima that are first-order equilibria of the full space."""
    cases: Cases = []
    for kind in statement:
        if kind == "regular interior":
            cases += criticality((PATTERN_6, PATTERN_8))
        elif kind == "smooth gaps":
            cases += averaging_cases(_PERMUTED, _NONNEGATIVE)
        else:
            text = "the tip-to-tip minimum of s3.pinned-criticality is regular and on no chart boundary, "
            cases.append((f"{text}yet dU.d = {_slope()} along an admissible d", _tips()))
    correction = Correction(
        r"\text{regular interior, or balanced by multipliers}\ge 0\text{ of smooth gaps with all "
        r"their images}\Rightarrow\text{first-order equilibrium;}\quad\text{tip to tip: none}",
        lambda: _check_remaining(_KINDS[:2]).verdict == "proved" and not _broken_steps(),
        "for regular interior states and smooth contacts only stability remains to be asked; tip to "
        "tip (s3.pinned-criticality) equilibrium itself fails.",
    )
    return _decide(
        cases,
        "Regular interior states by symmetric criticality, smooth contacts by averaging multipliers.",
        correction if statement == _KINDS else None,
        "tips" in statement,
    )


CLAIMS: list[Claim] = [
    Claim(
        "s3.pinned-criticality",
        "sec. 3, full-space equilibrium",
        "A state pinned at a symmetry-invariant contact is a first-order equilibrium of the full space",
        (_GENUINE, _NONNEGATIVE),
        r"\nabla U\cdot v=\sum_j\mu_j\nabla g_j\cdot v\ \forall v\in\ker\mathbf C^{G},\ \mu_j\ge 0"
        r"\Rightarrow\nabla U\cdot v\ge 0\ \forall v\text{ contact-admissible}",
        _check_pinned,
        damaged=((_PERMUTED, _ANY), (_ALONE, _NONNEGATIVE), (_GENUINE, _ANY)),
        corrected=_GOOD,
        form=row(one_of(_GENUINE, _PERMUTED, _ALONE), one_of(_NONNEGATIVE, _ANY)),
        root="tip to tip",
    ),
    Claim(
        "s3.remaining-question",
        "sec. 3, full-space equilibrium, 'the remaining question'",
        "Chart boundaries aside, symmetric minima are equilibria and only stability is left open",
        _KINDS,
        r"\text{symmetric minimum, not on a chart boundary}\Rightarrow\text{first-order equilibrium}",
        _check_remaining,
        damaged=(("tips",), ("regular interior", "tips")),
        corrected=_KINDS[:2],
        form=Several(one_of(*_KINDS)),
        root="tip to tip",
    ),
]
