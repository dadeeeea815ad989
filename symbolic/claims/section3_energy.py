"""Section 3: energy, symmetric criticality, contact, derivatives along a boundary, Morse."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..decide import Correction, by_cases, by_identity, refuted
from ..groups import crease_images
from ..logic import SPACES, energy_orders
from ..rotations import E1, E2, about, planar, product, reflect, scale
from ..statement import Maps, Several, Text, That, formula, one_of, row
from ..states import ExactState, degree6, degree8
from ..symbols import generic_crease, generic_fold

_HALF, _THIRD = sp.Rational(1, 2), sp.Rational(1, 3)
PATTERN_6 = "abcdcb"
PATTERN_8 = "abcbabcb"
PATTERNS = row(Text("[a-z]{6}", "6 letters"), Text("[a-z]{8}", "8 letters"))
"""Form of two patterns: creases with the same letter have equal springs."""


def regular_states() -> tuple[tuple[str, int, ExactState], ...]:
    """The exact regular states the linear-algebra claims are checked on: (name, n of D_n, state)."""
    return (
        ("degree 6, D_1", 1, degree6(_HALF, _THIRD, sp.Rational(1, 4))),
        ("degree 8, D_2", 2, degree8()),
    )


def _functional(pattern: str) -> sp.Matrix:
    """A row of torques k_i (phi_i - phi_i^0), one symbol per letter of the pattern."""
    return sp.Matrix([[sp.Symbol(f"tau_{letter}") for letter in pattern]])


def crease_average(n: int, degree: int) -> sp.Matrix:
    """Average of the permutation matrices of D_n on the creases."""
    images = crease_images(n, degree)
    average = sp.zeros(degree)
    for p in images.values():
        for i, j in enumerate(p):
            average[j, i] += sp.Rational(1, len(images))
    return average


def criticality(statement: tuple[str, str]) -> list[tuple[str, bool]]:
    """Exact cases: torques of the given patterns that vanish on symmetric tangents vanish on ker C."""
    cases: list[tuple[str, bool]] = []
    for (name, n, state), pattern in zip(regular_states(), statement, strict=True):
        c, average = state.crease_matrix(), crease_average(n, len(state.folds))
        kernel, torque = state.tangents(), _functional(pattern)
        fixed = sp.Matrix.hstack(*(average * kernel).columnspace())
        generic = sp.Matrix(sp.symbols(f"v_1:{len(state.folds) + 1}"))
        letters = sorted(torque.free_symbols, key=str)
        on_fixed = sp.Matrix([[e.coeff(x) for x in letters] for e in torque * fixed])
        on_kernel = sp.Matrix([[e.coeff(x) for x in letters] for e in torque * kernel])
        cases.append((f"{name}: rank C = 3", c.rank() == 3))
        cases.append((f"{name}: averages of tangents are tangent", c * fixed == 0 * c * fixed))
        same = (torque * generic - torque * average * generic)[0]
        cases.append((f"{name}: torques {pattern} see averages only", sp.expand(same) == 0))
        cases.append(
            (
                f"{name}: torques {pattern}, stationary for symmetric motions, act on others",
                on_fixed.col_join(on_kernel).rank() == on_fixed.rank(),
            )
        )
    return cases


def _check_criticality(statement: tuple[str, str]) -> Verdict:
    """Torques with the given pattern that vanish on symmetric tangents must vanish on ker C."""
    return by_cases(
        criticality(statement),
        "C P_g = g C for the creases' permutation P_g, so ker C is invariant; a torque with the "
        "symmetry of the creases takes the same value on v and on its average over the group, "
        "which is a symmetric tangent (and at a regular state all of those are velocities of "
        "symmetric motions).  The value on averages is an identity in v; tangency and ranks are "
        "verified exactly at rational states of both vertices.",
        "equivariance and exact linear algebra",
    )


def _check_invariance(statement: tuple[int, ...]) -> Verdict:
    """Closure with the creases exchanged is conjugate to the inverse closure (degree 4).

    statement: the crease whose fold angle creases 1..4 take over.
    """
    b = generic_crease("2")
    folds = [generic_fold(str(i)) for i in range(1, 5)]
    creases = [E1, planar(b.pair), scale(-1, E1), planar((b.c, -b.s))]
    q = [about(c, f.pair) for c, f in zip(creases, folds, strict=True)]
    forward = product(q)
    image = product(about(c, folds[i - 1].pair) for c, i in zip(creases, statement, strict=True))
    inverse = forward.inverse
    x, y, z = reflect(E2, inverse.vector)
    mirrored = type(forward)(inverse.w, -x, -y, -z)
    expected = q[0] * mirrored * q[0].inverse
    gaps = [
        g - h for g, h in zip((image.w, *image.vector), (expected.w, *expected.vector), strict=True)
    ]
    return by_identity(
        gaps,
        [b, *folds],
        "F(P phi) = Q_1 (sigma F(phi)^-1 sigma) Q_1^-1 for the mirrored fold angles, checked for a "
        "vertex of degree 4 with a crease in general position (the same product telescopes for "
        "every N): F = I is invariant; the energy is a sum over creases with equal k and phi^0 on "
        "mirrored creases, so it only permutes its terms.",
    )


def pinned_example() -> tuple[ExactState, sp.Matrix, sp.Matrix, sp.Matrix]:
    """A strict minimum of a D_1 landscape, creases 2 and 6 closed: state, torque, lambda, contact.

    tan(alpha/2) = 2/3, phi_2 = phi_6 = pi (facet 2 lies on facet 1), tan(phi_3/4) = -1/5 (facet 3
    leaves facet 1 upwards); torque C^T lambda - mu (e_2 + e_6), mu = 1/1000, unit stiffness.
    """
    state = degree6(sp.Rational(2, 3), sp.Integer(1), -sp.Rational(1, 5))
    c = state.crease_matrix()
    mu = sp.Rational(1, 1000)
    lam = 3 * mu * (c[:, 1] + c[:, 5])
    contact = sp.Matrix([0, 1, 0, 0, 0, 1])
    torque = c.T * lam - mu * contact
    return state, torque, lam, contact


_REGULAR, _PINNED = "regular interior", "pinned"


def _check_unconstrained(statement: tuple[str, ...]) -> Verdict:
    """Whether stable symmetric states of these kinds are stationary on the compatible space."""
    if _PINNED not in statement:
        return _check_criticality((PATTERN_6, PATTERN_8))
    state, torque, lam, _ = pinned_example()
    c, kernel = state.crease_matrix(), state.tangents()
    slope = [v for v in (torque.T * kernel) if v != 0]
    symmetric = all(torque[i] == torque[j] for i, j in ((1, 5), (2, 4)))
    angles = [sp.atan2(fold[1], fold[0]).evalf(30) for fold in state.folds]
    inside = bool(torque[1] >= 0) and all(  # rest angle phi* - g; pi - g_2 <= pi exactly
        abs(a) + abs(g) < sp.pi
        for i, (a, g) in enumerate(zip(angles, torque, strict=True))
        if i not in (1, 5)
    )
    # |d2 r| <= 1 per entry, so the Lagrangian Hessian is at least 1 - 6 |lambda| > 0
    convex = bool(36 * lam.dot(lam) < 1)
    example = bool(slope) and symmetric and inside and convex and c.rank() == 3
    if not example:
        return Verdict("unproved", "exact example", "the pinned example does not apply")
    return refuted(
        "A state pinned at contact is stable and not critical: degree 6, tan(alpha/2) = 2/3, "
        "phi_2 = phi_6 = pi, tan(phi_3/4) = -1/5, unit stiffness, rest angles phi* - g with g = C^T "
        "lambda - mu (e_2 + e_6), mu = 1/1000, is a strict minimum (multipliers mu > 0, Lagrangian "
        "Hessian >= 1 - 6|lambda| > 0), symmetric rest angles inside [-pi, pi], yet dU = "
        f"{sp.N(slope[0], 6)} along a compatible direction.",
        "exact example",
        Correction(
            r"\text{regular interior minima of the slice are critical points of the full space;}"
            r"\ \text{pinned ones satisfy } \nabla U=\mathbf C^T\lambda-\mu\nabla(\text{contact})",
            lambda: _check_criticality((PATTERN_6, PATTERN_8)).verdict == "proved",
            "true for regular interior states (as section 3 says earlier), by symmetric "
            "criticality; with contact the multipliers enter.",
        )
        if _REGULAR in statement
        else None,
    )


def _check_contact_slope(statement: Any) -> Verdict:
    """DU along a compatible direction at the pinned example must be statement * mu * opening."""
    state, torque, _, contact = pinned_example()
    kernel = state.tangents()
    mu = sp.Rational(1, 1000)
    opening = -contact  # the gap pi - phi_2 of both creases
    gaps = list(torque.T * kernel - statement * mu * opening.T * kernel)
    some = any(v != 0 for v in opening.T * kernel)
    return by_cases(
        [(f"direction {i}", g == 0) for i, g in enumerate(gaps)] + [("contact can open", some)],
        "With g = C^T lambda + mu grad(gap), C v = 0 leaves dU = mu d(gap): first-order growth "
        "for every opening motion when mu > 0.  Checked on an exact pinned state.",
        "exact linear algebra",
    )


def _check_first_derivative(statement: Any) -> Verdict:
    """Chain rule for three creases with arbitrary paths."""
    s, k, rest, path = _path()
    energy = sum(ki / 2 * (p - r) ** 2 for ki, p, r in zip(k, path, rest, strict=True))
    gap = sp.expand(sp.diff(energy, s) - statement(s, k, rest, path))
    return by_cases([("dU/ds", gap == 0)], "Chain rule; the sum is over creases.", "exact calculus")


def _check_second_derivative(statement: Any) -> Verdict:
    """Second derivative along the path for three creases."""
    s, k, rest, path = _path()
    energy = sum(ki / 2 * (p - r) ** 2 for ki, p, r in zip(k, path, rest, strict=True))
    gap = sp.expand(sp.diff(energy, s, 2) - statement(s, k, rest, path))
    return by_cases(
        [("d2U/ds2", gap == 0)],
        "phi' . K phi' + grad U . phi'' by differentiating twice; K = diag(k).",
        "exact calculus",
    )


def _along_path() -> Maps:
    """Form of a function of arc length, stiffnesses, rest angles and paths."""
    s, k, rest, path = _path()
    derivatives = [sp.diff(p, s, order) for p in path for order in (1, 2)]
    return Maps((s, k, rest, path), formula(s, *k, *rest, *path, *derivatives))


def _path() -> tuple[Any, list[Any], list[Any], list[Any]]:
    s = sp.Symbol("s")
    k = list(sp.symbols("k_1:4"))
    rest = list(sp.symbols("r_1:4"))
    return s, k, rest, [sp.Function(f"varphi_{i}")(s) for i in range(1, 4)]


def _slope(s: Any, k: Any, rest: Any, path: Any) -> Any:
    return sum(a * (p - r) * sp.diff(p, s) for a, p, r in zip(k, path, rest, strict=True))


def _curvature(s: Any, k: Any, rest: Any, path: Any) -> Any:
    return sum(
        a * sp.diff(p, s) ** 2 + a * (p - r) * sp.diff(p, s, 2)
        for a, p, r in zip(k, path, rest, strict=True)
    )


def _curvature_without_force(s: Any, k: Any, rest: Any, path: Any) -> Any:
    return sum(a * sp.diff(p, s) ** 2 for a, p in zip(k, path, strict=True))


_SPRING = sp.symbols("k phi phi^0", real=True)


def _check_torque(statement: Any) -> Verdict:
    """DU/dphi_i of the printed energy is the linear torque."""
    k, phi, rest = _SPRING
    gap = sp.expand(sp.diff(statement(k, phi, rest), phi) - k * (phi - rest))
    curvature = sp.diff(statement(k, phi, rest), phi, 2)
    return by_cases(
        [("torque k (phi - phi^0)", gap == 0), ("stiffness k", sp.expand(curvature - k) == 0)],
        "dU/dphi_i = k_i (phi_i - phi_i^0): a linear torsional spring in every crease.",
        "exact calculus",
    )


def _check_relaxed(statement: tuple[str, str]) -> Verdict:
    """Every finite energy landscape: stable in `statement[0]` space implies stable in the other."""
    holds = (statement[0], statement[1]) in energy_orders()
    return by_cases(
        [(f"stable in the {statement[0]} space implies stable in the {statement[1]} one", holds)],
        "The admissible states near a candidate are a subset of the compatible ones, and a minimum "
        "over a set is a minimum over every subset that contains it.  All landscapes on three "
        "neighbours were enumerated.",
        "quantifier argument, enumerated",
    )


CLAIMS: list[Claim] = [
    Claim(
        "s3.energy",
        "sec. 3, eq:energy",
        "Energy of linear torsional springs",
        lambda k, phi, rest: k / 2 * (phi - rest) ** 2,
        r"U=\sum_i\tfrac{k_i}{2}(\phi_i-\phi_i^0)^2",
        _check_torque,
        damaged=(
            lambda k, phi, rest: k * (phi - rest) ** 2,
            lambda k, phi, rest: k / 2 * (phi + rest) ** 2,
        ),
        form=Maps(_SPRING, formula(*_SPRING)),
    ),
    Claim(
        "s3.invariance",
        "sec. 3, full-space equilibrium",
        "Energy and loop closure are invariant under the symmetry",
        (1, 4, 3, 2),
        r"\mathbf F_N(P\phi)=\mathbf I\iff\mathbf F_N(\phi)=\mathbf I,\ U(P\phi)=U(\phi)",
        _check_invariance,
        damaged=((2, 3, 4, 1), (1, 2, 4, 3), (3, 2, 1, 4)),
        form=That(
            row(*[one_of(1, 2, 3, 4)] * 4), lambda p: len(set(p)) == 4, "a permutation of 1..4"
        ),
    ),
    Claim(
        "s3.symmetric-criticality",
        "sec. 3, full-space equilibrium",
        "Regular interior symmetric stationary points are stationary in the full space",
        (PATTERN_6, PATTERN_8),
        r"\nabla U\cdot v=0\ \forall v\in\ker\mathbf C^{G}\Rightarrow\nabla U\cdot v=0\ \forall "
        r"v\in\ker\mathbf C",
        _check_criticality,
        damaged=(("abcdeb", PATTERN_8), (PATTERN_6, "abcdabcb")),
        form=PATTERNS,
    ),
    Claim(
        "s3.critical-unconstrained",
        "sec. 3.1, 'necessarily critical points'",
        "Stable states of the slice are critical points in the unconstrained space",
        (_REGULAR, _PINNED),
        r"\text{stable in the slice (regular interior, or pinned by contact)}\Rightarrow\nabla U\perp"
        r"\ker\mathbf C",
        _check_unconstrained,
        damaged=((_PINNED,),),
        corrected=(_REGULAR,),
        form=Several(one_of(_REGULAR, _PINNED)),
    ),
    Claim(
        "s3.contact-slope",
        "sec. 3.1, metastability",
        "A positive multiplier makes opening the contact costly to first order",
        sp.Integer(1),
        r"\nabla U=\mathbf C^T\lambda+\mu\nabla g,\ \mu>0\Rightarrow dU=\mu\,dg>0",
        _check_contact_slope,
        damaged=(sp.Integer(-1), sp.Integer(2)),
    ),
    Claim(
        "s3.relaxed",
        "sec. 3 and app. A, self-contact omitted",
        "Stable with penetration allowed implies stable with contact",
        ("relaxed", "physical"),
        r"\text{min over compatible}\Rightarrow\text{min over contact-admissible}",
        _check_relaxed,
        damaged=(("physical", "relaxed"), ("symmetric", "physical")),
        form=row(*[one_of(*SPACES)] * 2),
    ),
    Claim(
        "s3.boundary-slope",
        "sec. 3.1, tangent energy derivative",
        "First derivative of the energy along a curve",
        _slope,
        r"\frac{d\hat U}{ds}=\sum_i k_i(\varphi_i-\phi_i^0)\frac{d\varphi_i}{ds}",
        _check_first_derivative,
        damaged=(_curvature_without_force,),
        form=_along_path(),
    ),
    Claim(
        "s3.boundary-curvature",
        "sec. 3.1, effective tangential stiffness",
        "Second derivative of the energy along a curve",
        _curvature,
        r"\frac{d^2\hat U}{ds^2}=\varphi'\cdot\mathbf K\varphi'+\nabla U\cdot\varphi''",
        _check_second_derivative,
        damaged=(
            _curvature_without_force,
            lambda *a: 2 * _curvature_without_force(*a) - _curvature(*a),
        ),
        form=_along_path(),
    ),
]
