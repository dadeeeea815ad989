"""Section 5: branches of the cone, rest state, ranges, contact, and what can be counted exactly."""

from __future__ import annotations

from itertools import product
from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims._section4_angles import both_roots
from ..claims._section5_contact import CONTACT_CLAIMS
from ..cone import (
    ALPHA_PAIR,
    K,
)
from ..decide import Correction, by_cases, refuted
from ..statement import DEGREE, WHOLE, Ratio, Several, Table, Text, one_of, row

N = sp.Symbol("N", positive=True)
H = sp.Symbol("h", positive=True)
"""tan(|v|/2)."""


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


THRESHOLD = sp.Rational(1, 1000)
"""Well depth over U_flat above which the paper counts a minimum (footnote of section 5)."""


def stiff_even_minima(flaps: int, threshold: Any = THRESHOLD) -> int | None:
    """Branches with a minimum deeper than `threshold` times U_flat for all large enough r_k.

    U/k_even -> B = sum over even creases of (phi - phi0)^2/2, with a valley flaps of n:
    a (2|v| - 2|v_0|)^2/2 + (n - a)(2|v| + 2|v_0|)^2/2, a parabola with its vertex at
    |v| = |v_0| (2a - n)/n and the relative depth ((2a - n)/n)^2 there.  2a < n has B' > 0 throughout.
    For 2a = n the depth tends to zero, so such a branch counts without a threshold only, and then for
    the one sign of v for which the odd creases pull away from the flat state (sum of d phi/d|v| > 0).
    None: a depth tends to the threshold itself, and no large r_k decides.
    """
    a, n, v, rest = sp.symbols("a n v v_0", positive=True)
    energy = a * (2 * v - 2 * rest) ** 2 / 2 + (n - a) * (2 * v + 2 * rest) ** 2 / 2
    vertex = sp.solve(sp.diff(energy, v), v)[0]
    flat = energy.subs(v, 0)
    depth = sp.cancel((flat - energy.subs(v, vertex)) / flat)
    if sp.cancel(vertex - rest * (2 * a - n) / n) != 0:
        raise AssertionError("vertex of the limit energy")
    count = 0
    for valleys in range(flaps + 1):
        deep = depth.subs({a: valleys, n: flaps})
        words = int(sp.binomial(flaps, valleys))
        if 2 * valleys > flaps and deep == threshold:
            return None
        if 2 * valleys > flaps and deep > threshold:
            count += 2 * words
        if 2 * valleys == flaps and threshold == 0:
            word = (1,) * valleys + (0,) * (flaps - valleys)
            pulls = [sum(slopes(word, side)[:flaps]) for side in (1, -1)]
            away = [p.subs(K, sp.Rational(1, 2)) > 0 for p in pulls]  # K - 1/K < 0 for 0 < K < 1
            count += words * sum(map(bool, away))
    return count


def _check_plateau(statement: tuple[int, int, Any]) -> Verdict:
    """Number of stable states for r_k above every bound, v_0 != 0.

    statement: (degree, number, threshold on the well depth over U_flat).
    """
    degree, printed, threshold = statement
    count = stiff_even_minima(degree // 2, threshold)
    total = 2 ** (degree // 2 + 1)
    method = "limit of the energy, exact count"
    if count is None:
        return Verdict("unproved", method, f"a depth tends to {threshold} itself")
    bare = stiff_even_minima(degree // 2, 0)
    deeper = f"deeper than {threshold} U_flat" if threshold else "of any depth"
    shown = (
        f"N = {degree}: as r_k -> infinity U/k_even tends to a parabola in |v| on every branch; "
        f"{count} of {total} branches keep a minimum {deeper} off the flat state"
    )
    aside = f" (without a threshold {bare})." if threshold else "."
    depths = {sp.Rational(2 * a - degree // 2, degree // 2) ** 2 for a in range(degree // 2 + 1)}
    counts = {stiff_even_minima(degree // 2, d * sp.Rational(99, 100)) for d in depths}
    if count == printed:
        remark = f"only with the threshold on the depth; without one {bare} of {total} count."
        return Verdict("proved", method, shown + ".", remark=remark if threshold else "")
    return refuted(
        f"{shown}, not {printed}{aside}"
        + ("" if printed in counts else f"  No threshold at all gives {printed}."),
        method,
        Correction(
            r"\#\{\Delta U>\varepsilon U_{\mathrm{flat}}\}=2\sum_{a>N/4}\binom{N/2}{a}\quad(r_k\to"
            rf"\infty,\ 0<\varepsilon<\bigl(\tfrac{{2a-n}}{{n}}\bigr)^2,\ n=\tfrac N2):\quad {count}/{total}"
            rf"\ \text{{for }}N={degree};\qquad \varepsilon=0:\ {bare}/{total}",
            lambda: stiff_even_minima(degree // 2, threshold) == count and both_roots(),
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
        form=Table(DEGREE, WHOLE),
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
        form=Table(DEGREE, Ratio()),
    ),
    Claim(
        "s5.m2v2",
        "sec. 5, fig. cone-4-firing",
        "M_2 V_2 and M V M V are distinct branches",
        ((0, 0, 1, 1), (0, 1, 0, 1)),
        r"M_2V_2\ne MVMV",
        _check_distinct,
        damaged=(((0, 0, 1, 1), (0, 1, 1, 0)), ((0, 1, 0, 1), (1, 0, 1, 0))),
        form=row(*[Several(one_of(0, 1))] * 2),
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
        form=Several(row(Text(r"\d+\.\d+", "a decimal in quotes"), WHOLE, Ratio(1, least=1))),
        origin="decimals",
    ),
    *(
        Claim(
            f"s5.plateau-{degree}",
            f"sec. 5, N = {degree}, large r_k",
            f"Number of branches with a minimum deeper than U_flat/1000, large r_k, N = {degree}",
            (degree, printed, THRESHOLD),
            r"\#\{\text{branches with }\Delta U>10^{-3}U_{\mathrm{flat}}\}="
            rf"{printed}/{2 ** (degree // 2 + 1)}\ (r_k\ \text{{above a threshold}},\ \upsilon_0\ne0)",
            _check_plateau,
            damaged=(
                (degree, printed + 1, THRESHOLD),
                (degree, printed // 2, THRESHOLD),
                (degree, printed, sp.Integer(0)),
            ),
            corrected=None if right is None else (degree, right, THRESHOLD),
            form=row(DEGREE, WHOLE, Ratio(least=0)),
            root="" if right is None else "plateaus at large stiffness ratio",
        )
        for degree, printed, right in ((8, 10, None), (10, 42, 32), (12, 56, 44))
    ),
]
