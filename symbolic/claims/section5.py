"""Section 5: branches of the cone, rest state, ranges, contact, and what can be counted exactly."""

from __future__ import annotations

from itertools import product
from typing import Any

import sympy as sp

from symbolic.claim import Claim, Verdict
from symbolic.claims._section4_angles import both_roots
from symbolic.claims._section5_contact import CONTACT_CLAIMS
from symbolic.cone import (
    ALPHA_PAIR,
    K,
)
from symbolic.decide import Correction, by_cases, refuted

N = sp.Symbol("N", positive=True)
H = sp.Symbol("h", positive=True)
"""tan(|v|/2)."""

LEFT_OUT: tuple[tuple[str, str], ...] = (
    (
        "sec. 5, figs. cone-3, cone-4, cone-56: where the bands and regions lie, 'a large portion', "
        "'nearly irrespective', 'primarily vertical', 'finer structure', 'less stable'",
        "words about a coloured picture, without a threshold that could be checked",
    ),
    (
        "sec. 5, 'No branch was found with more than one stable state'",
        "reports what the authors' optimiser found; true of any incomplete search",
    ),
    (
        "sec. 5, range of counts 0.0625-0.6875 (N = 6), 0.015625-0.65625 (N = 10)",
        "depends on the optimiser, its starts and its threshold; numerical maps are compared in the "
        "studies, here only the limits r_k -> infinity are decided",
    ),
    (
        "sec. 5, 'M_2 V up is stable for nearly every parameter set with r_k < 0.7 and v_0 > pi/8'",
        "'nearly every' has no measure",
    ),
    (
        "sec. 4, 'right-side of each odd crease', fig. N-setup, fig. 8-fold-symm-breaking-examples",
        "needs the figure; the formula of the construction is claim s4.breaking",
    ),
    (
        "sec. 4, d-cone and flexoelectricity remarks; sec. 5, Gibbs phase rule",
        "statements about other work, not about this model",
    ),
)
"""Statements of sections 4 and 5 that are not claims, and why."""


def slopes(word: tuple[int, ...], side: int) -> tuple[Any, ...]:
    """d phi_i / d|v| at the flat state along the branch (word, sign of v)."""
    shallow, steep = K, 1 / K  # |rho|/|v| at the flat state
    partial = []
    for flap in word:
        sign = 1 if flap else -1
        partial.append(sign * (shallow if sign * side > 0 else steep))
    odd = [sp.expand(partial[i - 1] + partial[i]) for i in range(len(word))]
    even = [sp.Integer(-2 if flap else 2) for flap in word]
    return (*odd, *even)


def _check_branches(statement: Any) -> Verdict:
    """Distinct rays at the flat state over all words and both signs of v, N = 6..16."""
    cases = []
    for degree in range(6, 17, 2):
        rays = {slopes(w, s) for w in product((0, 1), repeat=degree // 2) for s in (1, -1)}
        opposite = {tuple(sp.expand(-x) for x in ray) for ray in rays}
        claimed = sp.sympify(statement).subs(N, degree)
        cases.append(
            (f"N = {degree}: {len(rays)} branches against {claimed}", len(rays) == claimed)
        )
        cases.append((f"N = {degree}: rays come in opposite pairs", rays == opposite))
    return by_cases(
        cases,
        "Even slopes spell the word and the odd ones (K or 1/K, K != 1) the sign of v: 2^(N/2) words "
        "times two half-branches leave the flat state in distinct directions.  They pair up, (word, "
        "v > 0) with (complement, v < 0), into 2^(N/2) smooth curves through it.",
        "exact enumeration of tangents",
    )


def _check_branch_numbers(statement: dict[int, int]) -> Verdict:
    """Printed numbers of branches for N = 6, 8, 10, 12."""
    cases = []
    for degree, printed in statement.items():
        rays = {slopes(w, s) for w in product((0, 1), repeat=degree // 2) for s in (1, -1)}
        cases.append((f"N = {degree}: {len(rays)} against {printed}", len(rays) == printed))
    return by_cases(
        cases, "16, 32, 64, 128 distinct half-branches.", "exact enumeration of tangents"
    )


def _check_monotone(statement: Any) -> Verdict:
    """|phi| increases in |v| on (0, v_max): sign of every derivative with respect to h = tan(|v|/2).

    Up to positive factors the derivatives of tan(|phi|/4) or tan(|phi|/2) are K, 1/K and, for a
    crease between two kinds of flap, d/dh of tan(alpha) sin v = 2 tan(alpha) (1 - h^2)/(1 + h^2)^2.
    """
    limit = sp.tan(sp.sympify(statement) / 2)
    sine = 2 * H / (1 + H**2)
    slope = sp.factor(sp.diff(sine, H) * (1 + H**2) ** 2 / 2)  # 1 - h^2
    inside = sp.solveset(slope < 0, H, sp.Interval.open(0, limit))
    shallow = sp.diff(K * H, H)
    steep = sp.diff(H / K, H)
    mixed = sp.cancel(  # tan of half the sum of the partial angles against tan(alpha) sin v
        (H / K - K * H) / (1 + H**2) - sp.cancel(ALPHA_PAIR[1] / ALPHA_PAIR[0]) * sine
    )
    bad = None if inside == sp.S.EmptySet else f"mixed creases decrease on h in {inside}"
    return by_cases(
        [
            (
                "shallow and steep partial angles increase",
                bool(shallow.is_positive and steep.is_positive),
            ),
            ("mixed crease: tan(phi/2) = -tan(alpha) sin v", mixed == 0),
            (bad or "mixed creases increase", bad is None),
        ],
        "|phi_even| = 2|v|; like neighbours 4 atan(K h) or 4 atan(h/K); unlike ones "
        "2 atan(tan(alpha) sin|v|), increasing up to |v| = pi/2.",
        "signs of derivatives in tan(|v|/2)",
    )


def _check_flat_only(statement: dict[int, Any]) -> Verdict:
    """v_0 = 0: every branch only climbs, so the flat state is the one stable state of all branches."""
    climbing = _check_monotone(sp.pi / 2).verdict == "proved"
    cases = [("energy increases along every branch", climbing)]
    for degree, fraction in statement.items():
        branches = 2 ** (degree // 2 + 1)
        cases.append(
            (f"N = {degree}: 1/{branches} against {fraction}", sp.Rational(1, branches) == fraction)
        )
    return by_cases(
        cases,
        "All rest angles vanish at v_0 = 0, U = sum k phi^2/2 and every |phi| increases with |v|, so U "
        "has no minimum off the flat state, whatever r_k: one state over 2^(N/2+1) branches.",
        "monotonicity, proved",
    )


def _check_distinct(statement: tuple[tuple[int, ...], tuple[int, ...]]) -> Verdict:
    """Two words must have different fold angles as cyclic sequences, in every orientation."""
    first, second = statement
    rows = [slopes(w, 1) for w in (first, second)]
    half = len(first)
    multisets = [sorted(map(str, r[:half])) for r in rows]
    return by_cases(
        [(f"odd slopes {multisets[0]} and {multisets[1]} agree", multisets[0] != multisets[1])],
        "Same number of V and M, but M2V2 has odd creases 2 rho_v and 2 rho_m, MVMV only rho_v + rho_m: "
        "the fold angles differ already to first order.",
        "exact tangents at the flat state",
    )


def _check_fractions(statement: tuple[tuple[Any, int, int], ...]) -> Verdict:
    """Printed decimals against the fractions printed with them (to the digits shown)."""
    cases = []
    for decimal, top, bottom in statement:
        text = str(decimal)
        digits = len(text.split(".")[1])
        gap = abs(sp.Rational(text) - sp.Rational(top, bottom))
        cases.append((f"{text} = {top}/{bottom}", gap <= sp.Rational(1, 2 * 10**digits)))
    return by_cases(cases, "All decimals equal their fractions to the digits shown.", "exact")


def stiff_even_minima(flaps: int) -> int:
    """Branches with a minimum off the flat state of given relative depth as r_k -> infinity.

    There U/k_even -> B = sum over even creases of (phi - phi0)^2/2, with a valley flaps of n:
    a (2|v| - 2|v_0|)^2/2 + (n - a)(2|v| + 2|v_0|)^2/2, a parabola with its vertex at
    |v| = |v_0| (2a - n)/n.  So exactly the words with 2a > n keep a minimum (for both signs of v);
    2a < n has B' > 0 throughout, and for 2a = n the depth tends to zero.
    """
    a, n, v, rest = sp.symbols("a n v v_0", positive=True)
    energy = a * (2 * v - 2 * rest) ** 2 / 2 + (n - a) * (2 * v + 2 * rest) ** 2 / 2
    vertex = sp.solve(sp.diff(energy, v), v)[0]
    if sp.cancel(vertex - rest * (2 * a - n) / n) != 0:
        raise AssertionError("vertex of the limit energy")
    return 2 * sum(sp.binomial(flaps, k) for k in range(flaps + 1) if 2 * k > flaps)


def _check_plateau(statement: tuple[int, int]) -> Verdict:
    """Number of stable states (threshold on depth) for r_k above every bound, v_0 != 0."""
    degree, printed = statement
    count = stiff_even_minima(degree // 2)
    total = 2 ** (degree // 2 + 1)
    if count == printed:
        return Verdict(
            "proved",
            "limit of the energy, exact count",
            f"As r_k -> infinity exactly the {count} branches with more valley than mountain flaps "
            f"(of {total}) keep a minimum of finite relative depth.",
        )
    return refuted(
        f"N = {degree}: as r_k -> infinity U/k_even tends to a parabola in |v| on every branch; "
        f"{count} of {total} branches have its vertex off the flat state, not {printed}.",
        "limit of the energy, exact count",
        Correction(
            r"\#=2\sum_{a>N/4}\binom{N/2}{a}\quad(r_k\to\infty):\quad "
            rf"{count}/{total}\ \text{{for }}N={degree}",
            lambda: stiff_even_minima(degree // 2) == count and both_roots(),
            f"{count}/{total} = {sp.Rational(count, total)}, for every v_0 != 0 before contact.",
        ),
    )


CLAIMS: list[Claim] = [
    Claim(
        "s5.branches",
        "sec. 5, opening",
        "Number of folding branches",
        2 ** (N / 2 + 1),
        r"2^{N/2+1}\ \text{folding branches}",
        _check_branches,
        damaged=(2 ** (N / 2), 2 ** (N / 2 + 2)),
    ),
    Claim(
        "s5.branch-numbers",
        "sec. 5, N = 6, 8, 10, 12",
        "16, 32, 64 and 128 folding branches",
        {6: 16, 8: 32, 10: 64, 12: 128},
        r"2^3\cdot2=16,\ 2^4\cdot2=32,\ 2^6=64,\ 2^7=128",
        _check_branch_numbers,
        damaged=({6: 8, 8: 32, 10: 64, 12: 128}, {6: 16, 8: 32, 10: 32, 12: 64}),
    ),
    CONTACT_CLAIMS["s5.rest-state"],
    CONTACT_CLAIMS["s5.range-6-8"],
    CONTACT_CLAIMS["s5.contact-numbers"],
    CONTACT_CLAIMS["s5.contact"],
    Claim(
        "s5.monotone",
        "sec. 5, |phi| increases with |upsilon|",
        "Every |phi| increases with |upsilon| on every branch, |upsilon| < pi/2",
        sp.pi / 2,
        r"\frac{\mathrm{d}|\phi_i|}{\mathrm{d}|\upsilon|}>0\ \text{for}\ 0<|\upsilon|<\pi/2",
        _check_monotone,
        damaged=(2 * sp.pi / 3, 3 * sp.pi / 4),
    ),
    Claim(
        "s5.flat-rest",
        "sec. 5, v_0 = 0",
        "One stable state at v_0 = 0 regardless of r_k",
        {
            6: sp.Rational("0.0625"),
            8: sp.Rational("0.03125"),
            10: sp.Rational("0.015625"),
            12: sp.Rational("0.0078125"),
        },
        r"\upsilon_0=0:\ 1/16,\ 1/32,\ 1/64,\ 1/128",
        _check_flat_only,
        damaged=({6: sp.Rational(1, 8)}, {8: sp.Rational(1, 16)}),
    ),
    Claim(
        "s5.m2v2",
        "sec. 5, fig. cone-4-firing",
        "M_2 V_2 and M V M V are distinct branches",
        ((0, 0, 1, 1), (0, 1, 0, 1)),
        r"M_2V_2\ne MVMV",
        _check_distinct,
        damaged=(((0, 0, 1, 1), (0, 1, 1, 0)), ((0, 1, 0, 1), (1, 0, 1, 0))),
    ),
    Claim(
        "s5.fractions",
        "sec. 5, normalised counts",
        "Decimals and fractions agree",
        (
            ("0.0625", 1, 16),
            ("0.25", 4, 16),
            ("0.4375", 7, 16),
            ("0.3125", 5, 16),
            ("0.6875", 11, 16),
            ("0.125", 2, 16),
            ("0.03125", 1, 32),
            ("0.375", 12, 32),
            ("0.3125", 10, 32),
            ("0.015625", 1, 64),
            ("0.65625", 42, 64),
            ("0.265625", 17, 64),
            ("0.0078125", 1, 128),
            ("0.5", 64, 128),
            ("0.336", 43, 128),
            ("0.453", 58, 128),
            ("0.4375", 56, 128),
        ),
        r"0.0625=1/16,\ \dots,\ 0.4375=56/128",
        _check_fractions,
        damaged=((("0.6875", 10, 16),), (("0.336", 44, 128),)),
    ),
    *(
        Claim(
            f"s5.plateau-{degree}",
            f"sec. 5, N = {degree}, large r_k",
            f"Number of stable states above a threshold of r_k, N = {degree}",
            (degree, printed),
            rf"\#={printed}/{2 ** (degree // 2 + 1)}\ (r_k\ \text{{above a threshold}},\ "
            r"\upsilon_0\ne0)",
            _check_plateau,
            damaged=((degree, printed + 1), (degree, printed // 2)),
        )
        for degree, printed in ((8, 10), (10, 42), (12, 56))
    ),
]
