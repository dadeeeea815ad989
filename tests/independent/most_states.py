"""How many stable states a vertex of degree four has at least, and the lemma of the flat-foldable ones: by balls.

Closed states come from spherical triangles: the arc between creases 2 and 4 is a side of one triangle with crease 1
and of another with crease 3.  Folds and energies are enclosed by python-flint's balls.  Along a branch, an arc that
is closed at both ends, energies that go down, up, down, up ... at places in order have a strict minimum for every
"down".  Nothing of the package is used, and no closed form in one parameter.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from flint import arb, arb_series, ctx

PI = arb.pi


def ball(value: float | Fraction | int) -> arb:
    """Return a number as it stands, decimals as fractions."""
    fraction = Fraction(str(value)) if isinstance(value, float) else Fraction(value)
    return arb(fraction.numerator) / arb(fraction.denominator)


def _angle(y: arb, x: arb) -> arb:
    return arb.atan2(y, x)


def folds(sectors: Sequence[float], branch: int, fold: float) -> list[arb]:
    """Enclose the folds [rad] of creases 1 to 4 given that of crease 1 [deg]; branch: sign of fold 3 over fold 1."""
    a1, a2, a3, a4 = (ball(a) * PI() / 180 for a in sectors)
    inner = PI() - ball(fold) * PI() / 180  # angle of the link at crease 1, beyond pi for mountains
    arc = a4.cos() * a1.cos() + a4.sin() * a1.sin() * inner.cos()
    opposite = (arc - a2.cos() * a3.cos()) / (a2.sin() * a3.sin())
    sine = (1 - opposite * opposite).sqrt()
    sign = branch * (1 if fold > 0 else -1)
    # angle at crease 3 within (0, pi) for a valley, (pi, 2 pi) for a mountain
    other = _angle(sine * sign, opposite)
    at = []
    for near, far, beyond, away in ((a1, a4, a2, a3), (a4, a1, a3, a2)):
        first = _angle(
            far.sin() * inner.sin(), far.cos() * near.sin() - far.sin() * near.cos() * inner.cos()
        )
        second = _angle(
            away.sin() * other.sin(),
            away.cos() * beyond.sin() - away.sin() * beyond.cos() * other.cos(),
        )
        at.append(PI() - first - second)
    turned = [_within(x) for x in (PI() - other, *at)]
    return [ball(fold) * PI() / 180, turned[1], turned[0], turned[2]]


def _within(x: arb) -> arb:
    """Return an angle between -pi and pi."""
    turns = round(float(x.mid()) / (2 * float(PI().mid())))
    return x - 2 * turns * PI()


def energy(
    sectors: Sequence[float],
    stiffness: Sequence[float],
    rest: Sequence[float],
    branch: int,
    fold: float,
) -> arb:
    """Enclose the energy [J] of a closed state."""
    phi = folds(sectors, branch, fold)
    terms = (
        ball(k) * (x - ball(r) * PI() / 180) ** 2
        for k, x, r in zip(stiffness, phi, rest, strict=True)
    )
    return sum(terms, arb(0)) / 2


def least_minima(
    sectors: Sequence[float],
    stiffness: Sequence[float],
    rest: Sequence[float],
    places: Sequence[Sequence[float]],
) -> int:
    """Return how many strict minima the energies at these folds of crease 1 [deg] prove.

    places: of the branches with folds 1 and 3 of one sign, and of unlike signs; each in order, on one side of
    the other by steps along which folds grow.
    """
    found = 0
    for branch, along in zip((1, -1), places, strict=True):
        values = [energy(sectors, stiffness, rest, branch, fold) for fold in sorted(along)]
        falls, falling = 0, True
        for before, after in pairwise(values):
            if not (before < after or after < before):
                raise ArithmeticError("two energies overlap")
            down = bool(after < before)
            falls += down and not falling
            falling = down
        found += 1 + falls
    return found


def lemma_holds(mu: tuple[Fraction, Fraction], parts: int, slope: int = 0, depth: int = 12) -> bool:
    """Return whether H grows with p (dH/dc < slope) wherever psi''' > 0 and H >= 0, for these mu and 0 < p < pi.

    H = 3 psi' psi''^2/psi''' - psi'^2 with psi' = 1/(A + B c) is differentiated by power series in c = cos p.
    """
    before, ctx.cap = ctx.cap, 2
    try:
        return _lemma(mu, parts, slope, depth)
    finally:
        ctx.cap = before


def _lemma(mu: tuple[Fraction, Fraction], parts: int, slope: int, depth: int) -> bool:
    low, high = mu
    boxes = [
        (
            low + (high - low) * i / parts,
            low + (high - low) * (i + 1) / parts,
            Fraction(j, 8),
            Fraction(j + 1, 8),
            0,
        )
        for i in range(parts)
        for j in range(-8, 8)
    ]
    while boxes:
        a, b, c, d, level = boxes.pop()
        if _decided(_hull(a, b), _hull(c, d), slope):
            continue
        if level == depth:
            return False
        if (b - a) * 4 > d - c:
            m = (a + b) / 2
            boxes += [(a, m, c, d, level + 1), (m, b, c, d, level + 1)]
        else:
            m = (c + d) / 2
            boxes += [(a, b, c, m, level + 1), (a, b, m, d, level + 1)]
    return True


def _hull(a: Fraction, b: Fraction) -> arb:
    return ball(a).union(ball(b))


def _decided(mu: arb, c: arb, slope: int) -> bool:
    small = (1 / mu - mu) / 2
    x = arb_series([c, 1])
    whole = (1 + x) / (2 * mu) + mu * (1 - x) / 2  # A + B cos p
    if not whole[0] > 0:
        return False
    first = 1 / whole
    second_squared = small**2 * (1 - x * x) * first**4
    # psi''' = B (cos p (A + B cos p) + 2 B sin^2 p) psi'^3
    third = small * (x * whole + 2 * small * (1 - x * x)) * first**3
    if third[0] <= 0:
        return True
    top, square = 3 * first * second_squared, first**2
    if third[0] > 0:
        value = top / third - square
        if value[0] < 0 or value[1] < slope:
            return True
    # next to D = psi''' = 0: the slope of H = N/D - psi'^2 times D^2
    rate = top[1] * third[0] - top[0] * third[1] - square[1] * third[0] ** 2
    return bool(rate < slope * third[0] ** 2)
