"""All closed states of a flat vertex of degree 4 in closed form: three numbers say all of them.

Sector i lies between creases i and i + 1.  Sines of fold angles of opposite creases are in a fixed ratio,
sin(phi_3/2)^2 = q sin(phi_1/2)^2 and sin(phi_4/2)^2 = q' sin(phi_2/2)^2; let creases be numbered so that 1 and 2 are
those with the larger sines, q < 1 and q' < 1.  Then, with one parameter u and d > 0,

    cot(phi_1/2) = c_1 sinh u        cot(phi_2/2) =  s c_2 sinh(u + d)
    cot(phi_3/2) = c_3 cosh u        cot(phi_4/2) = -s c_4 cosh(u + d)

c_1^2 = 1 - q, c_3^2 = (1 - q)/q, c_2^2 = 1 - q', c_4^2 = (1 - q')/q', tanh(d)^2 = sin a_1 sin a_3/(sin a_2 sin a_4)
and s the sign of sin(a_2 + a_3); all of it once more with every sign turned.  From u = infinity (flat) to 0 (crease 1
at 180 degrees) it is a half of mode I, from -infinity to -d (crease 2 at 180 degrees) of mode II; between -d and 0 a
crease has gone past 180 degrees.  The claims are decided in `claims/degree4`, consequences in `claims/flat_foldable4`.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from .identities import circle
from .rotations import Pair

SECTORS = tuple(circle(sp.Symbol(f"a_{i}", real=True), f"a{i}") for i in (1, 2, 3))
"""Three sectors; the fourth is 2 pi less their sum."""


def _add(x: Pair, y: Pair) -> Pair:
    return (sp.expand(x[0] * y[0] - x[1] * y[1]), sp.expand(x[0] * y[1] + x[1] * y[0]))


_A1, _A2, _A3 = (c.pair for c in SECTORS)
_SUM = _add(_add(_A1, _A2), _A3)
PAIRS: tuple[Pair, ...] = (_A1, _A2, _A3, (_SUM[0], -_SUM[1]))
"""(cos, sin) of the four sectors."""
AZIMUTHS: tuple[Pair, ...] = ((sp.Integer(1), sp.Integer(0)), _A1, _add(_A1, _A2), _SUM)
"""(cos, sin) of the azimuth of each crease; crease 1 along e1."""


def sine(*sectors: int) -> Any:
    """Sine of the sum of these sectors (1-based, modulo 4)."""
    total: Pair = (sp.Integer(1), sp.Integer(0))
    for i in sectors:
        total = _add(total, PAIRS[(i - 1) % 4])
    return total[1]


Q = sine(1) * sine(4) / (sine(2) * sine(3))
Q_PRIME = sine(1) * sine(2) / (sine(3) * sine(4))
TANH2 = sine(1) * sine(3) / (sine(2) * sine(4))
"""q, q' and tanh(d)^2 of a vertex."""


def neighbours(i: int) -> tuple[Any, Any, Any, Any]:
    """Coefficients of X_{i+1}^2, X_i^2, X_i X_{i+1} and 1 in the relation of two neighbours, X = cot(phi/2)."""
    before, this, after = (sine(k) for k in (i - 1, i, i + 1))
    return (
        before * sine(i, i + 1),
        -after * sine(i + 1, i + 2),
        2 * before * after,
        -this * sine(i, i + 2),
    )


W, E, X = sp.symbols("w E x", positive=True)
HYPERBOLA = ((W - 1 / W) / 2, (W * E - 1 / (W * E)) / 2, (W + 1 / W) / 2, (W * E + 1 / (W * E)) / 2)
"""sinh u, sinh(u + d), cosh u, cosh(u + d) with w = exp(u), E = exp(d): what creases 1 to 4 go with."""


def half_tangent(crease: int, q: Any, e: Any, t: Any, mode: int = 1) -> Any:
    """tan(phi/2) of a crease (1 to 4) up to its sign, t in [-1, 1].

    Mode I: t = exp(-u), and crease 1 reaches 180 degrees at t = 1.  Mode II: t = exp(u + d), and crease 2 does.
    q: of the pair of the crease; e: E.
    """
    pair = crease % 2  # 1: creases 1 and 3
    scale = sp.sqrt(1 - q) if crease <= 2 else sp.sqrt((1 - q) / q)
    reach = 1 if (mode == 1) == bool(pair) else e
    sign = -1 if crease <= 2 else 1
    return 2 * t / (scale * (reach + sign * t**2 / reach))
