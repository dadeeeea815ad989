"""Appendix A: linearised closure, tangent space, retraction, difference formulas, counting."""

from __future__ import annotations

from itertools import product as cartesian
from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims.section3_energy import PATTERN_6, regular_states
from ..decide import Correction, as_convention, by_cases, by_identity, refuted
from ..groups import symmetric_dimension
from ..logic import SPACES, counting_order
from ..rotations import Quaternion, about, planar, product
from ..statement import WHOLE, Ratio, Table, Text, one_of, row
from ..states import flat
from ..symbols import generic_crease, generic_fold

_CREASES = [generic_crease(str(i)) for i in range(1, 4)]
_FOLDS = [generic_fold(str(i)) for i in range(1, 4)]
_ALL = [*_CREASES, *_FOLDS]
_AXES = [planar(b.pair) for b in _CREASES]
_Q = [about(a, f.pair) for a, f in zip(_AXES, _FOLDS, strict=True)]


def _deformed(offset: int, i: int) -> tuple[Any, Any, Any]:
    """F_{i+offset} b_i for i = 1..3 (F_0 = 1)."""
    return product(_Q[: max(i + offset, 0)]).rotate(_AXES[i - 1])


def _check_crease_directions(statement: int) -> Verdict:
    """C_i = F_{i+statement} b_i must be carried by both facets that meet there."""
    gaps = []
    for i in range(1, 4):
        left, right = (
            product(_Q[: i - 1]).rotate(_AXES[i - 1]),
            product(_Q[:i]).rotate(_AXES[i - 1]),
        )
        given = _deformed(statement, i)
        gaps += [a - b for a, b in zip(left, given, strict=True)]
        gaps += [a - b for a, b in zip(right, given, strict=True)]
    return by_identity(
        gaps,
        _ALL,
        "F_{i-1} b_i = F_i b_i because Q(b_i, .) fixes b_i: the crease as both of its "
        "facets carry it.",
    )


def _check_linear_closure(statement: tuple[int, Any]) -> Verdict:
    """DF F^T = [sum of F_{i+offset} b_i dphi_i]_x times factor, three creases in general position.

    In quaternions: dq q^-1 = (1/2) (0, C dphi).
    """
    offset, factor = statement
    q = product(_Q)
    gaps = []
    for i in range(1, 4):
        axis = Quaternion(0, *_AXES[i - 1])
        derivative = product(_Q[: i - 1]) * axis * product(_Q[i - 1 :])  # 2 dq/dphi_i
        left = derivative * q.inverse
        right = _deformed(offset, i)
        gaps += [left.w, *(a - factor * b for a, b in zip(left.vector, right, strict=True))]
    return by_identity(
        gaps,
        _ALL,
        "dQ(b, phi)/dphi = (b/2) Q(b, phi) as quaternions, so dq q^-1 = (0, C dphi)/2, that is "
        "dF F^T = [C dphi]_x with c_i = F_{i-1} b_i.  Checked for three creases in general "
        "position; each further crease multiplies both sides from the right.",
    )


def _check_tangent(statement: tuple[int, int, int]) -> Verdict:
    """Ranks and kernels of C at exact states: (N - dim) at degree 6 and 8, rank when flat."""
    first, second, flat_rank = statement
    cases = []
    for want, (name, _, state) in zip((first, second), regular_states(), strict=True):
        c = state.crease_matrix()
        kernel = state.tangents()
        cases.append((f"{name}: F_N = I", state.closure() == sp.eye(3)))
        cases.append((f"{name}: rank C = 3", c.rank() == 3))
        cases.append((f"{name}: dimension {kernel.shape[1]}", kernel.shape[1] == want))
        cases.append((f"{name}: C Z = 0", c * kernel == sp.zeros(3, kernel.shape[1])))
        cases.append((f"{name}: flat rank", flat(state).crease_matrix().rank() == flat_rank))
    return by_cases(
        cases,
        "dim ker C = N - rank C = N - 3 where the deformed creases span space; exact at rational "
        "closed states of degree 6 and 8.  In the flat state all creases lie in one plane, rank 2: "
        "singular, as excluded.",
        "exact linear algebra",
    )


def _check_retraction(statement: str) -> Verdict:
    """Solvability of r(phi* + Z q + Y eta) = 0 for eta: C Y must be invertible."""
    cases = []
    for name, _, state in regular_states():
        c = state.crease_matrix()
        basis = {"row space": c.T, "kernel": state.tangents()[:, :3]}[statement]
        cases.append((f"{name}: det(C Y) != 0", (c * basis).det() != 0))
    x = sp.Symbol("x")
    # ax log of the quaternion (cos x/2, sin x/2 n) is x n: derivative 1 at closure
    log = 2 * sp.atan2(sp.sin(x / 2), sp.cos(x / 2))
    cases.append(("derivative of ax log at the identity", sp.diff(log, x).subs(x, 0) == 1))
    return by_cases(
        cases,
        "dr/deta = C Y at closure (ax log has derivative 1 there), and with Y spanning the row "
        "space det(C C^T) is the sum of squared 3 x 3 minors (Cauchy-Binet), nonzero exactly at "
        "rank 3: the implicit function theorem gives a unique smooth eta(q) with eta = O(|q|^2).",
        "implicit function theorem, exact determinants",
    )


_Stencil = dict[tuple[int, int], Any]
_WEIGHTS = Table(row(WHOLE, WHOLE), Ratio())
G: _Stencil = {(1, 0): sp.Rational(1, 2), (-1, 0): -sp.Rational(1, 2)}
H_AA: _Stencil = {(1, 0): 1, (0, 0): -2, (-1, 0): 1}
H_AB: _Stencil = {
    (1, 1): sp.Rational(1, 4),
    (1, -1): -sp.Rational(1, 4),
    (-1, 1): -sp.Rational(1, 4),
    (-1, -1): sp.Rational(1, 4),
}


def _check_stencil(derivative: tuple[int, int]) -> Any:
    """A check of one difference formula against the derivative of order `derivative`."""
    order = sum(derivative)

    def check(statement: _Stencil) -> Verdict:
        h = sp.Symbol("h")
        cases = []
        for m, n in cartesian(range(5), repeat=2):
            if m + n > order + 1:  # exact one degree further: the error is O(h^2)
                continue
            value = sum(w * (a * h) ** m * (b * h) ** n for (a, b), w in statement.items())
            value = sp.expand(value / h**order)
            exact = sp.factorial(m) * sp.factorial(n) if (m, n) == derivative else 0
            cases.append((f"monomial q_a^{m} q_b^{n} gives {value}", sp.expand(value - exact) == 0))
        return by_cases(
            cases,
            f"Exact on all monomials of degree <= {order + 1}, so the error is O(h^2).",
            "Taylor monomials",
        )

    return check


def _check_dimensions(statement: tuple[int, int]) -> Verdict:
    """Symmetry-breaking dimensions: full minus symmetric, by characters and at exact states."""
    cases = []
    for want, (name, n, state) in zip(statement, regular_states(), strict=True):
        degree = len(state.folds)
        counted = degree - 3 - symmetric_dimension(n, degree)
        orbits = {6: ((1, 5), (2, 4)), 8: ((0, 4), (2, 6), (1, 3), (1, 5), (1, 7))}[degree]
        a = sp.zeros(len(orbits), degree)
        for k, (i, j) in enumerate(orbits):
            a[k, i], a[k, j] = 1, -1
        exact = (a * state.tangents()).rank()  # = dim - dim ker(A Z)
        cases.append(
            (f"{name}: characters give {counted}, rank(A Z) = {exact}", counted == exact == want)
        )
    return by_cases(
        cases,
        "3 - 2 = 1 and 5 - 2 = 3: orbits of creases minus fixed vectors of R^3 give the symmetric "
        "part; rank(A Z) agrees at exact states.",
        "character count and exact rank",
    )


def _check_counting(statement: tuple[str, str, str]) -> Verdict:
    """Order of the three counts for the candidates of every landscape."""
    return by_cases(
        [(" <= ".join(f"N_{s}" for s in statement), counting_order(statement))],
        "Every candidate minimal with penetration allowed is minimal with contact, and every one "
        "minimal in the contact-admissible space is minimal in its symmetric subset; so for the "
        "candidates considered the counts are nested.  (They bound the candidates only: asymmetric "
        "stable states are counted by none of the three.)",
        "quantifier argument, enumerated",
    )


PRINTED_TOLERANCE = sp.Rational(5, 1000)
"""epsilon_g of appendix A."""


def _check_criterion(statement: Any) -> Verdict:
    """Gradient tolerance `statement` (relative to pi sum k), eigenvalue tolerance 1e-6."""
    r, lam, lip = sp.symbols("r lambda L", positive=True)
    # g = 0: U(q) - U(0) >= lambda r^2/2 - L r^3/6, positive for 0 < r < 3 lambda/L
    growth = sp.expand(lam * r**2 / 2 - lip * r**3 / 6 - r**2 * (3 * lam - lip * r) / 6) == 0
    tolerance = sp.Rational(statement)
    if tolerance == 0:
        return by_cases(
            [("second-order growth", growth)],
            "g = 0 and lambda_min > 0 give growth r^2 (3 lambda - L r)/6.",
            "Taylor with remainder",
        )
    _, _, state = regular_states()[0]
    c, z = state.crease_matrix(), state.tangents()[:, 0]
    bound = tolerance * sp.Rational(314, 100) * 6  # below epsilon pi sum k, unit stiffness
    delta = sp.Rational(1, 2) * bound / sum(abs(x) for x in z)
    torque = delta * z  # rest angles phi* - delta z
    accepted = bool(torque.dot(torque) <= bound**2)
    no_multiplier = (c * torque).is_zero_matrix is True  # so the reduced Hessian is Z^T K Z = 1
    slope = torque.dot(z)
    if not (accepted and no_multiplier and slope != 0):
        return Verdict("unproved", "exact example", "the example does not apply")
    verdict = refuted(
        "Degree 6, unit stiffness, rest angles phi* - delta z with C z = 0: the restricted Hessian "
        f"is the identity and |g|/(pi sum k) is within {statement}, so phi* is classified as a "
        f"strict minimum, but dU/ds = {sp.N(slope / sp.sqrt(z.dot(z)), 6)} along the compatible "
        "direction z: it is not stationary.",
        "exact example",
        None,
    )
    if tolerance != PRINTED_TOLERANCE:
        return verdict
    return as_convention(
        verdict,
        "As what it is, a numerical test with its tolerances stated, the sentence cannot be false; "
        "the paper does not call it a theorem.  Only 'is a strict minimum', read as an implication, "
        "needs g = 0.",
        Correction(
            r"\mathbf g=\mathbf 0\ \text{and}\ \lambda_{\min}(\mathbf H)>0\ \Rightarrow\ "
            r"\text{strict local minimum}",
            lambda: growth,
            "with g = 0 the growth r^2 (3 lambda - L r)/6 is positive for small r; with g only "
            "small, a minimum lies near, at a distance of order |g|/lambda_min, and must be found.",
        ),
    )


def _check_breaking_block(statement: str) -> Verdict:
    """Coupling of K between even and odd tangents; creases with the same letter are equally stiff."""
    name, _, state = regular_states()[0]
    stiffness = sp.diag(*(sp.Symbol(f"k_{letter}") for letter in statement))
    kernel = state.tangents()
    mirror = [0, 5, 4, 3, 2, 1]
    swapped = sp.Matrix([[kernel[mirror[i], j] for j in range(kernel.shape[1])] for i in range(6)])
    even, odd = kernel + swapped, kernel - swapped
    block = (even.T * stiffness * odd).applyfunc(sp.expand)
    return by_cases(
        [(f"{name}: even and odd tangents couple", block.is_zero_matrix is True)],
        "K commutes with the crease permutation, so even and odd tangents do not couple: the "
        "symmetry-breaking block can be read alone (the curvature term of closure inherits the "
        "same invariance).",
        "exact linear algebra",
    )


CLAIMS: list[Claim] = [
    Claim(
        "a.crease-directions",
        "app. A, c_i = F_{i-1} b_i",
        "Deformed crease directions",
        -1,
        r"\hat c_i=\mathbf F_{i-1}\hat b_i",
        _check_crease_directions,
        damaged=(-2, 1),
    ),
    Claim(
        "a.linear-closure",
        "app. A, eq:linearized-fullspace-closure",
        "First variation of loop closure",
        (-1, sp.Integer(1)),
        r"\delta\mathbf F_N\mathbf F_N^T=[\mathbf C\,\delta\varphi]_\times",
        _check_linear_closure,
        damaged=((-2, sp.Integer(1)), (-1, sp.Integer(-1))),
    ),
    Claim(
        "a.tangent",
        "app. A, eq:fullspace-tangent",
        "Tangent space of dimension N - 3",
        (3, 5, 2),
        r"\mathbf C\,\delta\varphi=0,\ \operatorname{rank}\mathbf C=3\Rightarrow\dim"
        r"=N-3",
        _check_tangent,
        damaged=((2, 5, 2), (3, 5, 3)),
    ),
    Claim(
        "a.retraction",
        "app. A, eq:fullspace-retraction",
        "Normal correction defines a local retraction",
        "row space",
        r"\mathbf r(\varphi^\star+\mathbf Zq+\mathbf Y\eta(q))=0",
        _check_retraction,
        damaged=("kernel",),
        form=one_of("row space", "kernel"),
    ),
    Claim(
        "a.gradient-difference",
        "app. A, g_a",
        "Centred difference for the gradient",
        G,
        r"g_a\simeq\frac{\tilde U(he_a)-\tilde U(-he_a)}{2h}",
        _check_stencil((1, 0)),
        damaged=({(1, 0): 1, (-1, 0): -1}, {(1, 0): 1, (0, 0): -1}),
        form=_WEIGHTS,
    ),
    Claim(
        "a.hessian-diagonal",
        "app. A, H_aa",
        "Centred second difference",
        H_AA,
        r"H_{aa}\simeq\frac{\tilde U(he_a)-2\tilde U(0)+\tilde U(-he_a)}{h^2}",
        _check_stencil((2, 0)),
        damaged=({(1, 0): 1, (0, 0): -1, (-1, 0): 1},),
        form=_WEIGHTS,
    ),
    Claim(
        "a.hessian-mixed",
        "app. A, H_ab (eq:fullspace-hessian)",
        "Mixed second difference",
        H_AB,
        r"H_{ab}\simeq\frac{\tilde U_{++}-\tilde U_{+-}-\tilde U_{-+}+\tilde U_{--}}{4h^2}",
        _check_stencil((1, 1)),
        damaged=({k: 2 * v for k, v in H_AB.items()}, {**H_AB, (-1, 1): sp.Rational(1, 4)}),
        form=_WEIGHTS,
    ),
    Claim(
        "a.criterion",
        "app. A, classification inequality",
        "A small relative gradient with a positive Hessian makes a strict minimum",
        PRINTED_TOLERANCE,
        r"\frac{\|\mathbf g\|}{\pi\sum k_i}\le\varepsilon_g,\ \lambda_{\min}(\mathbf H)>"
        r"\varepsilon_\lambda\ \Rightarrow\ \text{strict local minimum}",
        _check_criterion,
        damaged=(sp.Rational(1, 10),),
        corrected=sp.Integer(0),
        form=Ratio(least=0),
    ),
    Claim(
        "a.breaking-dimensions",
        "app. A, symmetry-breaking subspaces",
        "Symmetry-breaking subspaces have dimensions one and three",
        (1, 3),
        r"\dim=3-2=1\ (N=6),\quad 5-2=3\ (N=8)",
        _check_dimensions,
        damaged=((2, 3), (1, 2)),
    ),
    Claim(
        "a.breaking-block",
        "app. A, H_br",
        "The symmetry-breaking block stands alone",
        PATTERN_6,
        r"\mathbf Q_{\rm sym}^T\mathbf H\,\mathbf Q_{\rm br}=0",
        _check_breaking_block,
        damaged=("abcdeb", "abcdcf"),
        form=Text("[a-z]{6}", "6 letters"),
        origin="own derivation",
    ),
    Claim(
        "a.counting",
        "app. A, eq:fullspace-stability-bounds",
        "Counting inequality",
        ("relaxed", "physical", "symmetric"),
        r"N_{\rm relaxed}\le N_{\rm physical}\le N_{\rm sym}",
        _check_counting,
        damaged=(("physical", "relaxed", "symmetric"), ("relaxed", "symmetric", "physical")),
        form=row(*[one_of(*SPACES)] * 3),
    ),
]
