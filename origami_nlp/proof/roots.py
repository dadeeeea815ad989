"""Critical points in small boxes: existence, uniqueness, signs and index, many at once.

On a stratum with free variables f a critical point solves F = [k (x - rest) - A' lam ; g] = 0 in (x_f, lam), g the
closure of `system`, A its Jacobian: square, with Jacobian J = [[K - lam . g'', -A'], [A, 0]].
Krawczyk: for any Y, if |Y F(z0)| + sup |I - Y J(Z)| rho < rho on Z = z0 +- rho, Z holds exactly one zero.  Derivatives
of g of order p are at most beta_i beta_j ... (entries of a unit quaternion: beta = 1/2 a fold angle; of a rotated unit
vector: 1; half of that on a mirror), so that on Z, with s = sum_j beta_j rho_j,

    |J(Z) - J(z0)| <= [[ beta_i beta_j (sum |d lam| + s sum |lam|), beta_i s ], [ beta_j s, 0 ]].

With rho = t (1, ..., 1, mu, ..., mu) both conditions are a quadratic in t: the smallest t that fits is the accuracy of
the root, the largest the box in which it is the only one.

Index.  The number of negative eigenvalues of [[H, A'], [A, 0]] less the number of equations, where A has full rank.
With X the computed eigenvectors, X' J X = D + R is known with error bounds; where all Gershgorin discs miss zero, the
signs of D count (Sylvester, X being regular as X' X is near 1).

Rounding: `BoxKkt.noise` bounds what it leaves in g, A and g''.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import CURVED, DUPLICATE_TOL, FOLLOWED, INDEPENDENT
from origami_nlp.proof.boxes import WIDER, Boxes
from origami_nlp.proof.rows import TINY, UNIT
from origami_nlp.proof.system import BoxDerivatives, BoxKkt

STEPS = 10
"""Newton's steps from the middle of a box: to a regular root it takes two or three; beside singular states it does not
end."""
FAR = 0.05
"""A root further from its box than this [rad] is none of it."""
SHARES = (1.0, 0.3, 0.1, 0.03)
"""Sides of the uniqueness box in multipliers that are tried, over what these move with x; the widest box is taken."""


WIDEST = 0.3
"""Uniqueness boxes are no wider [rad]: half chains turn by less than pi / 2 in them."""


@dataclass(frozen=True, eq=False)
class Roots:
    """R certified critical points, each on its stratum.

    Attributes
    ----------
    x
        Shape [R, n] [rad].
    lam
        Multipliers of closure, k (x - rest) = A' lam on free variables, [R, m], over the model's scale.
    pins
        Shape [R, n].
    radius, unique
        Of existence and of uniqueness, in the largest norm, [R] [rad].
    spread
        Of multipliers in the uniqueness box, [R].
    index
        Of the reduced Hessian, -1 where unclear, [R].
    signs
        Of s_i (G_i - A' lam), +1 leaves the limit, -1 pushes, 0 unclear or free, [R, n].
    """

    x: np.ndarray
    lam: np.ndarray
    pins: np.ndarray
    radius: np.ndarray
    unique: np.ndarray
    spread: np.ndarray
    index: np.ndarray
    signs: np.ndarray

    def __len__(self) -> int:
        return len(self.x)

    def __getitem__(self, which: np.ndarray) -> Roots:
        return Roots(*(getattr(self, name)[which] for name in self.__dataclass_fields__))


def newton(
    system: BoxKkt, x: np.ndarray, pins: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Run Newton's method from states: x, multipliers, and which converged beside where they started."""
    start, lam = x, system.start(x, pins)
    n = system.n
    last = np.full(len(x), np.inf)
    alive = np.ones(len(x), dtype=bool)
    for _ in range(STEPS):
        at = system.at(x, lam, pins)
        step = (_inverse(at.jacobian) @ at.f[:, :, None])[:, :, 0]
        size = np.abs(step[:, :n]).max(axis=1, initial=0.0)
        alive &= (np.abs(step) < 1e100).all(axis=1) & (
            size < 1.0
        )  # multipliers run off where rank is lost
        step = np.where(alive[:, None], step, 0.0)
        x, lam = x - step[:, :n], lam - step[:, n:]
        alive &= np.abs(x - start).max(axis=1) < FAR
        settled = (size < FOLLOWED) | ((size > 0.5 * last) & (size < INDEPENDENT))
        last = size
        if (settled | ~alive).all():
            break
    return x, lam, alive & (last < DUPLICATE_TOL) & system.closes(x)


def certify(
    system: BoxKkt, x: np.ndarray, lam: np.ndarray, pins: np.ndarray
) -> tuple[Roots, np.ndarray]:
    """Certify zeros of the KKT system.

    Parameters
    ----------
    system
        Of the model.
    x, lam, pins
        Approximate zeros, shape [K, n], [K, m] and [K, n].

    Returns
    -------
    roots : Roots
        Those that exist, and are the only ones near.
    which : numpy.ndarray
        Their numbers among the K.
    """
    n, m = system.n, system.m
    at = system.at(x, lam, pins)
    free = pins == 0
    sound = (free.sum(axis=1) >= m) & np.isfinite(at.jacobian).all(axis=(1, 2))
    # Krawczyk's preconditioner: any Y is sound, an approximate inverse succeeds
    y = _inverse(np.where(sound[:, None, None], at.jacobian, np.eye(n + m)))
    reach = np.abs(y)
    wrong = (reach @ (np.abs(at.f) + at.fuzz)[:, :, None])[:, :, 0]
    rest = np.abs(np.eye(n + m) - y @ at.jacobian) + reach @ at.doubt()
    rest += 4 * (n + m + 4) * UNIT * (reach @ np.abs(at.jacobian))
    rows = np.concatenate([free, np.ones((len(x), m), bool)], axis=1)
    ratio = _lean(at)
    smallest, largest, lean = np.full(len(x), np.inf), np.zeros(len(x)), ratio
    for share in SHARES:
        mu = share * ratio
        rho = np.concatenate([np.where(free, 1.0, 0.0), mu[:, None] + np.zeros((1, m))], axis=1)
        # wrong + rest rho t + (reach change rho) t^2 < rho t, row by row; rows of pinned variables are exact
        a = (reach @ at.change(mu) @ rho[:, :, None])[:, :, 0]
        b = rho - (rest @ rho[:, :, None])[:, :, 0]
        low, high = _between(a, b, wrong, rows)
        high = np.minimum(high, WIDEST)
        better = (low < high) & (high > largest)
        smallest, largest = np.where(better, low, smallest), np.where(better, high, largest)
        lean = np.where(better, mu, lean)
    which = np.flatnonzero(sound & (smallest < largest))
    index = _index(system, at, free, smallest, lean, which)
    signs = _signs(system, at, pins, smallest, lean)
    roots = Roots(x, lam, pins, smallest, largest, lean * largest, index, signs)
    return roots[which], which


def _inverse(matrices: np.ndarray) -> np.ndarray:
    """Invert, zeros where singular."""
    good = np.abs(np.linalg.det(matrices)) > 0
    out = np.zeros_like(matrices)
    if good.any():
        out[good] = np.linalg.inv(matrices[good])
    return np.where(np.isfinite(out), out, 0.0)


def _between(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return between which t all a t^2 - b t + c < 0, with room for rounding: smallest > largest if there are none."""
    a, c = 1.01 * a + TINY, 1.01 * c + TINY
    b = 0.99 * b
    root = np.sqrt(np.maximum(b * b - 4 * a * c, 0.0))
    fits = (b > 0) & (b * b > 4 * a * c)
    # both roots of a t^2 - b t + c without cancellation: the smaller one is of the size of rounding
    low = np.where(fits, 2 * c / np.where(fits, b + root, 1.0), np.inf)
    high = np.where(fits, (b + root) / (2 * a), 0.0)
    low, high = np.where(rows, low, 0.0), np.where(rows, high, np.inf)
    return 1.01 * low.max(axis=1), 0.99 * high.min(axis=1)


def _lean(at: BoxDerivatives) -> np.ndarray:
    """Ratio of the sides of a box in multipliers and in x: twice what the former move where x moves by 1 (`holds`)."""
    p, move, _ = _levers(at)
    return 2.0 * (p @ move[:, :, None])[:, :, 0].max(axis=1)


def _levers(at: BoxDerivatives) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """|P| [R, m, n], P A' = 1 on free variables; what k x - A' lam, and A', change by where x moves by 1, [R, n]."""
    p = np.abs(np.linalg.pinv(at.a.transpose(0, 2, 1), rcond=CURVED))
    turned = at.beta * at.beta.sum(axis=1)[:, None]
    return p, at.k + turned * at.size[:, None], turned


def holds(system: BoxKkt, roots: Roots, boxes: Boxes) -> np.ndarray:
    """Number of the root whose uniqueness box holds all critical points in each of K small boxes; -1 if none, [K].

    The box lies within `unique`; and the multipliers of a critical point in it, r from the root, are within `spread`:
    with P A' = 1 at the root, lam' - lam = P (G' - G - (A' - A) lam' - F), so that |lam' - lam| <= |P| ((k + beta s
    |lam|) r + |F| + beta s r |lam' - lam|), and where the sum of |P| beta s r over all rows is at most 1/5, the
    last term makes that at most (1 + (m - 1) / 5) / (4 / 5) <= 9/4 times as much, m <= 5.  Then A has full rank
    throughout, too: what is critical in the sense of Fritz John has multipliers.

    Parameters
    ----------
    system
        Of the model.
    roots
        Certified.
    boxes
        On any strata.

    Returns
    -------
    numpy.ndarray
    """
    out = np.full(len(boxes), -1)
    if not len(roots):
        return out
    at = system.at(roots.x, roots.lam, roots.pins)
    p, move, turned = _levers(at)
    noise = np.abs(at.f[:, : system.n]) + at.fuzz[:, : system.n]
    moves, noise = ((p @ v[:, :, None])[:, :, 0].max(axis=1) for v in (move, noise))
    firm = 0.19 / np.maximum((p @ turned[:, :, None])[:, :, 0].sum(axis=1), TINY)
    for i in range(len(roots) - 1, -1, -1):  # of several the first
        x = roots.x[i][:, None]
        same = (roots.pins[i][:, None] == boxes.pins).all(axis=0)
        distance = np.maximum(np.abs(boxes.lower - x), np.abs(boxes.upper - x))
        r = np.where(boxes.pins == 0, distance, 0.0).max(axis=0)
        inside = (r <= roots.unique[i] * (1 - WIDER)) & (r <= firm[i])
        inside &= 2.3 * (moves[i] * r + noise[i]) <= roots.spread[i]
        out[same & inside] = i
    return out


def joined_roots(parts: list[Roots]) -> Roots:
    """Return roots of several parts, in order."""
    names = Roots.__dataclass_fields__
    return Roots(*(np.concatenate([getattr(p, name) for p in parts]) for name in names))


def different(roots: Roots, known: int = 0) -> Roots:
    """Return one of all that are the same: of one stratum, one within the uniqueness box of the other.

    Parameters
    ----------
    roots
        Certified.
    known
        So many, the first ones, are different already.

    Returns
    -------
    Roots
        The first of each.
    """
    kept = np.zeros(len(roots), dtype=bool)
    for i in range(len(roots)):
        same = kept[:i] & (roots.pins[:i] == roots.pins[i]).all(axis=1)
        near = np.abs(roots.x[:i] - roots.x[i]).max(axis=1, initial=0.0) + roots.radius[i]
        # two certified zeros in one box of uniqueness are one
        kept[i] = i < known or not (same & (near < roots.unique[:i])).any()
    return roots[np.flatnonzero(kept)]


def _index(
    system: BoxKkt,
    at: BoxDerivatives,
    free: np.ndarray,
    radius: np.ndarray,
    lean: np.ndarray,
    which: np.ndarray,
) -> np.ndarray:
    """Negative eigenvalues of the reduced Hessian, [K]; -1 where not certified or not among `which`."""
    n, m = system.n, system.m
    out = np.full(len(radius), -1)
    if not len(which):
        return out
    r = np.where(np.isfinite(radius), radius, 1.0)
    # entries of the KKT matrix at the root itself, which lies within r of where J was computed
    off = (r[:, None, None] * at.change(lean) + at.doubt())[which]
    j = at.jacobian[which].copy()
    j[:, :n, n:] *= -1.0  # symmetric: [[H, A'], [A, 0]]
    # congruence by powers of two brings the springs to order 1
    scale = np.concatenate([2.0 ** np.round(-0.5 * np.log2(system.k)), np.ones(m)])
    rows = np.concatenate([free[which], np.ones((len(which), m), bool)], axis=1)
    scale = np.where(rows, scale, 1.0)
    j *= scale[:, :, None] * scale[:, None, :]
    off *= scale[:, :, None] * scale[:, None, :]
    _, vectors = np.linalg.eigh(j)
    v = np.abs(vectors)
    product = vectors.transpose(0, 2, 1) @ j @ vectors
    error = v.transpose(0, 2, 1) @ (off + 8 * (n + m + 4) * UNIT * np.abs(j)) @ v
    d = np.arange(n + m)
    diagonal = product[:, d, d].copy()
    product[:, d, d] = 0.0
    # once more a congruence, to a diagonal of +-1
    unit = np.sqrt(np.abs(diagonal)) + TINY
    disc = ((np.abs(product) + error) / (unit[:, :, None] * unit[:, None, :])).sum(axis=2)
    near_one = np.abs(vectors.transpose(0, 2, 1) @ vectors - np.eye(n + m)).sum(axis=2).max(axis=1)
    clear = (disc < 0.99).all(axis=1) & (near_one < 0.1)
    # inertia of the KKT matrix = inertia of Z' H Z + (m, m, 0) (Nocedal & Wright, theorem 16.3)
    out[which] = np.where(clear, (diagonal < 0).sum(axis=1) - m, -1)
    return out


def _signs(
    system: BoxKkt, at: BoxDerivatives, pins: np.ndarray, radius: np.ndarray, lean: np.ndarray
) -> np.ndarray:
    """Signs of the torque that is left at pinned variables, [K, n]."""
    r = np.where(np.isfinite(radius), radius, 1.0)[:, None]
    # G - A' lam changes by A' d lam and (A' - A) lam from the computed state to the root
    moved = system.m * lean[:, None] * r + system.beta.sum() * r * at.size[:, None]
    off = system.beta * moved + at.fuzz[:, : system.n]
    force = pins * at.force
    return np.where(pins != 0, np.where(force > off, 1, np.where(force < -off, -1, 0)), 0)
