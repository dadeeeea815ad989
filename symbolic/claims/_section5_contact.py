"""Section 5, rest state, ranges and contact elevations; part of the claims of `section5`."""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claim import Claim, Verdict
from ..claims._section4_angles import (
    BOTH_SIDES,
    ON_RATIONAL_CONE,
    VALLEY,
    VALLEY_CORRECTED,
    arc_pair,
    both_roots,
)
from ..cone import (
    ALPHA_PAIR,
    K_OF_DEGREE,
    K,
    azimuth,
    exact,
    identical,
    lift,
    mirror,
    separating_point,
    turn,
)
from ..decide import Correction, as_convention, by_cases, refuted
from ..statement import DEGREE, Table, formula, row
from ..symbols import alpha, upsilon

N = sp.Symbol("N", positive=True)
H = sp.Symbol("h", positive=True)
"""tan(|v|/2)."""


def _rest_pairs(odd: Any, even: Any, side: int) -> list[tuple[Any, Any]] | None:
    """Both sides of closure and of 'at elevation v_0' for one sign of v_0, |v_0| <= pi/2.

    None when the odd angle is not twice an arccos that `arc_pair` can read; |cos v_0 + sin alpha| is
    read without the modulus, which does nothing there.
    """
    pair = arc_pair(odd.subs(sp.Abs(_SUM), _SUM) / 2, side)
    if pair is None:
        return None
    c, s = pair
    half = (exact(sp.cos(even / 2), side), exact(sp.sin(even / 2), side))
    ca, sa = ALPHA_PAIR
    scalar = (c * half[0] - s * half[1] * ca) * ca - s * half[1] * sa * sa
    at_elevation = lift(turn(azimuth(1), half, mirror(1)), (c, s))
    return [(scalar, ca), (at_elevation, mirror(1))]


_SUM = sp.cos(upsilon) + sp.sin(alpha)
REST = ({1: 2 * VALLEY[1], -1: 2 * VALLEY[1]}, -2 * upsilon)
REST_CORRECTED = ({s: 2 * VALLEY_CORRECTED[s] for s in (1, -1)}, -2 * sp.Abs(upsilon))
"""Rest angles (odd per sign of v_0, even) with upsilon for v_0: as printed, and corrected."""


def _check_rest(statement: tuple[dict[int, Any], Any]) -> Verdict:
    """The rest state must be a waterbomb state (closed, odd valleys, even mountains) for both signs.

    The printed odd angle is 2|rho| of the shallow root: the valley root for v_0 > 0, minus the
    mountain root for v_0 < 0.
    """
    odd, even = statement
    sense = {1: ">", -1: "<"}
    broken = []
    for side in (1, -1):
        pairs = _rest_pairs(odd[side], even, side)
        if pairs is None:
            return Verdict("unproved", ON_RATIONAL_CONE, f"cannot read the odd angle {odd[side]}")
        closure, elevation = pairs
        point = {alpha: sp.pi / 3, upsilon: side * sp.pi / 12}
        at = [sp.N(sp.sympify(e).subs(point), 30) for e in (odd[side], even)]
        if not identical(*closure):
            where = separating_point(*closure, side)
            broken.append(f"v_0 {sense[side]} 0: the loop does not close ({where})")
        elif not identical(*elevation):
            broken.append(f"v_0 {sense[side]} 0: a closed state, but not at elevation v_0")
        if not at[0] > 0 > at[1]:
            shown = [sp.N(x, 6) for x in at]
            broken.append(
                f"v_0 = {side * sp.pi / 12}, N = 6: rest angles {shown[0]}, {shown[1]} are not valley "
                "and mountain"
            )
    if not broken:
        return Verdict(
            "proved",
            ON_RATIONAL_CONE,
            "phi0_odd = 2 rho_v(v_0) and phi0_even = -2|v_0| close the loop for both signs of v_0.",
        )
    return refuted(
        "; ".join(broken) + ".",
        "exact counterexample",
        Correction(
            r"\phi^0_{\text{odd}}=2\rho_v(\upsilon_0),\quad \phi^0_{\text{even}}=-2|\upsilon_0|"
            r"\quad(\rho_v\text{ with its second case for }\upsilon_0<0)",
            lambda: _check_rest(REST_CORRECTED).verdict == "proved",
            "the printed pair is the waterbomb only for v_0 >= 0; for v_0 < 0 the odd angle needs the "
            "other root of eq:partial-valley-N and the even one -2|v_0|.",
        )
        if statement == REST
        else None,
    )


def contact_elevations(kind: str) -> dict[int, Any]:
    """Elevation of each sign with |rho| = pi/2 for two neighbouring flaps of one kind.

    From cos rho = 0: c_v^2 = K^2 s_v^2 (shallow) or K^2 c_v^2 = s_v^2 (steep), that is
    tan(|v|/2) = 1/K or K with K = tan(pi/4 - alpha/2), so |v| = pi/2 + alpha or pi/2 - alpha.
    """
    half = {"shallow": sp.pi / 2 + alpha, "steep": sp.pi / 2 - alpha}
    return {
        side: side * half["shallow" if (kind == "valley") == (side > 0) else "steep"]
        for side in (1, -1)
    }


def contact_proved() -> bool:
    """Exact: cos rho vanishes at tan(|v|/2) = 1/K (shallow) and K (steep); 2 atan K = pi/2 - alpha."""
    shallow = (1 - K**2 * H**2).subs(H, 1 / K)
    steep = (K**2 - H**2).subs(H, K)
    turn = sp.Symbol("a", positive=True)
    k = sp.cos(turn) / (1 + sp.sin(turn))  # tan(pi/4 - a/2); 2 atan k = pi/2 - a
    slope = sp.together(sp.diff(2 * sp.atan(k), turn) + 1)
    numerator = sp.expand(sp.fraction(slope)[0]).subs(sp.cos(turn) ** 2, 1 - sp.sin(turn) ** 2)
    start = 2 * sp.atan(k.subs(turn, 0)) - sp.pi / 2
    return bool(shallow == 0 and steep == 0 and sp.expand(numerator) == 0 and start == 0)


def _check_range(statement: dict[int, tuple[Any, Any]]) -> Verdict:
    """Printed ranges (lowest, highest) of v_0 against the waterbomb's own contact elevations."""
    wrong, mirrored = [], []
    low = contact_elevations("valley")[-1]
    for degree, (first, last) in statement.items():
        own = (low.subs(alpha, 2 * sp.pi / degree), sp.pi / 2)
        if (first, last) != own:
            wrong.append(f"N = {degree}: printed [{first}, {last}], waterbomb [{own[0]}, {own[1]}]")
        mirrored.append((first, last) == (-own[1], -own[0]))
    verdict = by_cases(
        [("; ".join(wrong), not wrong), ("contact elevations", contact_proved())],
        "All-valley folding: odd creases reach pi at v = -(pi/2 - alpha) and meet on the axis at pi/2.",
        "exact contact elevations",
        None,
    )
    if not all(mirrored):
        return verdict
    return as_convention(
        verdict,
        "True if positive elevation raises crease 1, Q(e2, -v); with Q(e2, v) of eq:cone-deformation "
        "and with eq:partial-valley-N the valley flaps are steep for v < 0 and touch there.",
        Correction(
            r"\upsilon_0\in\bigl[-\tfrac{\pi}{2}(1-\tfrac4N),\ \tfrac{\pi}{2}\bigr]",
            lambda: contact_proved() and both_roots(),
            "the interval is the mirror image of the printed one: rho_v = pi/2 at "
            "v = -(pi/2)(1 - 4/N), and at v = pi/2 all odd creases lie on the axis.",
        ),
    )


def _check_contact(statement: Any) -> Verdict:
    """rho_v(v) = pi/2 at the printed v > 0, by the exact value of cos rho_v there."""
    angle = sp.sympify(statement)
    values = contact_elevations("valley")
    as_alpha = sp.expand(angle.subs(N, 2 * sp.pi / alpha))
    if sp.expand(values[1] - as_alpha) == 0 and contact_proved():
        return Verdict("proved", "exact contact elevation", "cos rho_v = 0 there.")
    verdict = refuted(
        f"For v > 0 rho_v = pi/2 at v = pi/2 + alpha = (pi/2)(1 + 4/N); at the printed elevation "
        f"tan(rho_v/2) = {_shallow_at(angle)} < 1 for N = 6.",
        "exact counterexample",
        None,
    )
    if sp.expand(values[-1] + as_alpha) != 0:
        return verdict
    return as_convention(
        verdict,
        "True for the other sign of v: rho_v = pi/2 at v = -(pi/2)(1 - 4/N), the second case of "
        "eq:partial-valley-N; at +(pi/2)(1 - 4/N) it is rho_m that reaches -pi/2.  Same reversed "
        "sign of the elevation as in the printed ranges.",
        Correction(
            r"\rho_v=\tfrac{\pi}{2}\ \text{at}\ \upsilon=-\tfrac{\pi}{2}(1-\tfrac4N),\qquad "
            r"\rho_m=-\tfrac{\pi}{2}\ \text{at}\ \upsilon=+\tfrac{\pi}{2}(1-\tfrac4N)",
            contact_proved,
            "two neighbouring steep flaps touch at |v| = (pi/2)(1 - 4/N).",
        ),
    )


def _shallow_at(angle: Any) -> Any:
    """tan(rho_v/2) of the shallow root at an elevation, N = 6."""
    return sp.radsimp(K_OF_DEGREE[6] * sp.tan(angle.subs(N, 6) / 2))


def _check_contact_numbers(statement: dict[int, Any]) -> Verdict:
    """Printed contact elevations against pi/2 - 2 pi/N (size only)."""
    cases = [
        (f"N = {d}: {v} against {sp.pi / 2 - 2 * sp.pi / d}", v == sp.pi / 2 - 2 * sp.pi / d)
        for d, v in statement.items()
    ]
    return by_cases(
        [*cases, ("contact at pi/2 - alpha", contact_proved())],
        "tan(|v|/2) = tan(pi/4 - alpha/2) makes a steep flap's |rho| = pi/2, |phi_odd| = pi.",
        "exact contact elevation",
    )


_QUARTER = sp.pi / 2

CONTACT_CLAIMS: dict[str, Claim] = {
    c.id: c
    for c in (
        Claim(
            "s5.rest-state",
            "sec. 5, stress-free configuration",
            "Rest angles of the waterbomb at elevation v_0, both signs",
            REST,
            r"\phi^0_{\text{odd}}=2\arccos\frac{|\cos\upsilon_0+\sin\alpha|}{1+\cos\upsilon_0\sin\alpha},"
            r"\quad\phi^0_{\text{even}}=-2\upsilon_0",
            _check_rest,
            damaged=(
                (REST[0], REST_CORRECTED[1]),
                (REST_CORRECTED[0], REST[1]),
                (REST_CORRECTED[0], -REST_CORRECTED[1]),
                ({1: 2 * VALLEY_CORRECTED[-1], -1: 2 * VALLEY_CORRECTED[1]}, REST_CORRECTED[1]),
            ),
            corrected=REST_CORRECTED,
            form=row(BOTH_SIDES, formula(upsilon)),
        ),
        Claim(
            "s5.range-6-8",
            "sec. 5, ranges of v_0 for N = 6 and 8",
            "Self-contact bounds of the rest elevation",
            {6: (-_QUARTER, sp.pi / 6), 8: (-_QUARTER, sp.pi / 4)},
            r"\upsilon_0\in[-\pi/2,\pi/6]\ (N=6),\quad[-\pi/2,\pi/4]\ (N=8)",
            _check_range,
            damaged=(
                {6: (-_QUARTER, sp.pi / 4), 8: (-_QUARTER, sp.pi / 6)},
                {6: (-_QUARTER, _QUARTER)},
            ),
            corrected={6: (-sp.pi / 6, _QUARTER), 8: (-sp.pi / 4, _QUARTER)},
            form=Table(DEGREE, row(formula(), formula())),
            root="sense of the elevation",
        ),
        Claim(
            "s5.contact-numbers",
            "sec. 5, contact for N = 6, 8, 10, 12",
            "Facet contact at pi/6, pi/4, 3 pi/10, pi/3 (size of the elevation)",
            {6: sp.pi / 6, 8: sp.pi / 4, 10: 3 * sp.pi / 10, 12: sp.pi / 3},
            r"|\upsilon|=\pi/6,\ \pi/4,\ 3\pi/10,\ \pi/3",
            _check_contact_numbers,
            damaged=({10: sp.pi / 3, 12: 3 * sp.pi / 10}, {6: sp.pi / 3}),
            form=Table(DEGREE, formula()),
        ),
        Claim(
            "s5.contact",
            "sec. 5, general contact elevation from eq:partial-valley-N",
            "rho_v = pi/2 at the contact elevation",
            _QUARTER * (1 - 4 / N),
            r"\rho_v=\pi/2\ \text{at}\ \upsilon=\tfrac{\pi}{2}(1-\tfrac4N)",
            _check_contact,
            damaged=(_QUARTER * (1 - 2 / N), _QUARTER * (1 + 2 / N)),
            corrected=_QUARTER * (1 + 4 / N),
            root="sense of the elevation",
        ),
    )
}
"""By id; `section5.CLAIMS` puts them in the order of the paper."""
