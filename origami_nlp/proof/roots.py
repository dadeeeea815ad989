"""Critical points in small boxes: existence, uniqueness, signs and index, many at once.

On a stratum with free variables f a critical point solves F = [k (x - rest) - A' lam ; g] = 0 in (x_f, lam), g the
closure of the package's closed forms, A its Jacobian: square, with Jacobian J = [[K - lam . g'', -A'], [A, 0]].
Krawczyk: for any Y, if |Y F(z0)| + sup |I - Y J(Z)| rho < rho on Z = z0 +- rho, Z holds exactly one zero.  Derivatives
of g of order p are at most beta_i beta_j ... (entries of a unit quaternion: beta = 1/2 a fold angle; of a rotated unit
vector: 1; half of that on a mirror), so that on Z, with s = sum_j beta_j rho_j,

    |J(Z) - J(z0)| <= [[ beta_i beta_j (sum |d lam| + s sum |lam|), beta_i s ], [ beta_j s, 0 ]].

With rho = t (1, ..., 1, mu, ..., mu) both conditions are a quadratic in t: the smallest t that fits is the accuracy of the
root, the largest the box in which it is the only one.

Index.  The number of negative eigenvalues of [[H, A'], [A, 0]] less the number of equations, where A has full rank.
With X the computed eigenvectors, X' J X = D + R is known with error bounds; where all Gershgorin discs miss zero, the
signs of D count (Sylvester, X being regular as X' X is near 1).

Rounding: N folds in doubles are off by at most `FOLD` u each, azimuths of creases by what the sectors before them may be
off; `System.fold` bounds what both do to g, A and g''.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.programme import Kinematics, Model
from origami_nlp.proof.affine import TINY, UNIT
from origami_nlp.proof.boxes import Boxes
from origami_nlp.proof.chains import SECTORS

STEPS = 30
"""Newton's steps from the middle of a box."""
FAR = 0.05
"""A root further from its box than this [rad] is none of it."""
FOLD = 40
"""Rounding units of a fold in doubles: sines to 8, creases to 8, a 4 x 4 product and a rotated vector."""
SHARES = (1.0, 0.3, 0.1, 0.03)
"""Sides of the uniqueness box in multipliers that are tried, over what these move with x; the widest box is taken."""


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


class System:
    """The KKT system of a model, over states of any stratum.

    Parameters
    ----------
    model
        Within fold limits.
    """

    def __init__(self, model: Model) -> None:
        self.kinematics = Kinematics(model)
        self.n, self.m = model.size, model.equation_count
        self.k, self.rest = model.parameters.stiffness, model.parameters.rest
        rays = [r for r, has in enumerate(model.structure.has_crease) if has]
        dihedral = model.structure.kind == "D"
        last = len(model.structure.has_crease) - 1
        on_mirror = np.isin(rays, (0, last)) & dihedral
        vector = dihedral and model.structure.order > 1
        self.beta = np.where(on_mirror, 0.5, 1.0) * (1.0 if vector else 0.5)
        creases = len(rays)
        # creases are off by their azimuths: a sector's doubt for each sector before them
        self.fold = UNIT * (FOLD * (creases + 4) + 2 * SECTORS * creases**2)

    def constraints(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what vanishes, g [R, m], and its Jacobian A [R, m, n]."""
        return self.kinematics.closure(self.kinematics.fold(x))

    def curvature(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """Return lam . g'', [R, n, n]."""
        return self.kinematics.closure_hessian(self.kinematics.fold(x), lam)

    def at(
        self, x: np.ndarray, lam: np.ndarray, pins: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return F [R, n + m], J [R, n + m, n + m], rows of pinned variables those of 1, and the sheet [R]."""
        n, m = self.n, self.m
        g, a = self.constraints(x)
        h = -self.curvature(x, lam)
        i = np.arange(n)
        h[:, i, i] += self.k
        force = self.k * (x - self.rest) - np.einsum("rm,rmn->rn", lam, a)
        free = pins == 0
        jacobian = np.zeros((len(x), n + m, n + m))
        jacobian[:, :n, :n] = h
        jacobian[:, :n, n:] = -a.transpose(0, 2, 1)
        jacobian[:, n:, :n] = a
        pinned_rows = np.concatenate([~free, np.zeros((len(x), m), dtype=bool)], axis=1)
        jacobian[pinned_rows] = 0.0
        jacobian.transpose(0, 2, 1)[pinned_rows] = 0.0
        diagonal = np.arange(n + m)
        jacobian[:, diagonal, diagonal] += pinned_rows
        sheet = self.kinematics.fold(x).sheet
        return np.concatenate([np.where(free, force, 0.0), g], axis=1), jacobian, sheet

    def force(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """Return k (x - rest) - A' lam of all variables, [R, n]."""
        a = self.constraints(x)[1]
        return self.k * (x - self.rest) - np.einsum("rm,rmn->rn", lam, a)

    def start(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the multipliers [R, m] that balance the free variables best."""
        a = self.constraints(x)[1] * (pins == 0)[:, None]
        torque = np.where(pins == 0, self.k * (x - self.rest), 0.0)
        return (np.linalg.pinv(a.transpose(0, 2, 1), rcond=1e-9) @ torque[:, :, None])[:, :, 0]


def newton(
    system: System, x: np.ndarray, pins: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Run Newton's method from states: x, multipliers, and which converged beside where they started."""
    start, lam = x, system.start(x, pins)
    n = system.n
    last = np.full(len(x), np.inf)
    alive = np.ones(len(x), dtype=bool)
    for _ in range(STEPS):
        f, jacobian, _ = system.at(x, lam, pins)
        step = _solved(jacobian, f)
        size = np.abs(step[:, :n]).max(axis=1, initial=0.0)
        alive &= np.isfinite(step).all(axis=1) & (size < 1.0)
        step = np.where(alive[:, None], step, 0.0)
        x, lam = x - step[:, :n], lam - step[:, n:]
        alive &= np.abs(x - start).max(axis=1) < FAR
        settled = (size < 1e-13) | ((size > 0.5 * last) & (size < 1e-9))
        last = size
        if (settled | ~alive).all():
            break
    sheet = system.kinematics.fold(x).sheet
    return x, lam, alive & (last < 1e-8) & (sheet > 0)


def _solved(jacobian: np.ndarray, f: np.ndarray) -> np.ndarray:
    """Solve, NaN where singular."""
    try:
        return np.linalg.solve(jacobian, f[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        good = np.abs(np.linalg.det(jacobian)) > 0
        out = np.full(f.shape, np.nan)
        out[good] = np.linalg.solve(jacobian[good], f[good][:, :, None])[:, :, 0]
        return out


def certify(
    system: System, x: np.ndarray, lam: np.ndarray, pins: np.ndarray
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
    n, m, beta = system.n, system.m, system.beta
    f, jacobian, _ = system.at(x, lam, pins)
    free = pins == 0
    good = free.sum(axis=1) >= m
    safe = np.where(
        good[:, None, None] & np.isfinite(jacobian).all(axis=(1, 2))[:, None, None],
        jacobian,
        np.eye(n + m),
    )
    y = _inverse(safe)
    size = np.abs(lam).sum(axis=1)
    # what rounding and doubt leave in F and J
    fuzz = system.fold * np.concatenate(
        [system.k * 2 * np.pi + beta * size[:, None] * 4 + 0 * x, np.ones((len(x), m))], axis=1
    )
    off = _bound(beta, free, system.fold * (1 + size), system.fold * (1 + 0 * size), n, m)
    reach = np.abs(y)
    wrong = reach @ (np.abs(f) + fuzz)[:, :, None]
    rest = np.abs(np.eye(n + m) - y @ jacobian) + reach @ off
    rest += 4 * (n + m + 4) * UNIT * (reach @ np.abs(jacobian))
    rows = np.concatenate([free, np.ones((len(x), m), bool)], axis=1)
    s = np.where(free, beta, 0.0).sum(axis=1)
    ratio = _lean(system, x, lam, free)
    smallest, largest, lean = np.full(len(x), np.inf), np.zeros(len(x)), ratio
    for share in SHARES:
        mu = share * ratio
        rho = np.concatenate([np.where(free, 1.0, 0.0), mu[:, None] + np.zeros((1, m))], axis=1)
        change = _bound(beta, free, m * mu + s * size, s, n, m)
        # wrong + rest rho t + (reach change rho) t^2 < rho t, row by row; rows of pinned variables are exact
        a = (reach @ change @ rho[:, :, None])[:, :, 0]
        b = rho - (rest @ rho[:, :, None])[:, :, 0]
        low, high = _between(a, b, wrong[:, :, 0], rows)
        better = (low < high) & (high > largest)
        smallest, largest = np.where(better, low, smallest), np.where(better, high, largest)
        lean = np.where(better, mu, lean)
    good &= smallest < largest
    which = np.flatnonzero(good)
    index = _index(system, x, lam, pins, jacobian, smallest, lean, which)
    signs = _signs(system, x, lam, pins, smallest, lean)
    unique = np.minimum(largest, 0.5)
    roots = Roots(x, lam, pins, smallest, unique, lean * unique, index, signs)
    return roots[which], which


def _inverse(matrices: np.ndarray) -> np.ndarray:
    """Invert, zeros where singular."""
    good = np.abs(np.linalg.det(matrices)) > 0
    out = np.zeros_like(matrices)
    if good.any():
        out[good] = np.linalg.inv(matrices[good])
    return np.where(np.isfinite(out), out, 0.0)


def _bound(
    beta: np.ndarray, free: np.ndarray, corner: np.ndarray, side: np.ndarray, n: int, m: int
) -> np.ndarray:
    """Matrices [[beta_i beta_j corner, beta_i side], [beta_j side, 0]] on free variables."""
    b = np.where(free, beta, 0.0)
    out = np.zeros((len(b), n + m, n + m))
    out[:, :n, :n] = b[:, :, None] * b[:, None, :] * corner[:, None, None]
    out[:, :n, n:] = (b * side[:, None])[:, :, None]
    out[:, n:, :n] = (b * side[:, None])[:, None, :]
    return out


def _between(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, rows: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the t between which a t^2 - b t + c < 0 in every row, with room for rounding: smallest > largest if none."""
    a, c = 1.01 * a + TINY, 1.01 * c + TINY
    b = 0.99 * b
    root = np.sqrt(np.maximum(b * b - 4 * a * c, 0.0))
    fits = (b > 0) & (b * b > 4 * a * c)
    low = np.where(fits, 2 * c / np.where(fits, b + root, 1.0), np.inf)
    high = np.where(fits, (b + root) / (2 * a), 0.0)
    low, high = np.where(rows, low, 0.0), np.where(rows, high, np.inf)
    return 1.01 * low.max(axis=1), 0.99 * high.min(axis=1)


def _lean(system: System, x: np.ndarray, lam: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Ratio of the sides of the box in multipliers and in x: twice what multipliers move where x moves by 1 (`holds`)."""
    p, move, _ = _levers(system, x, lam, free)
    return 2.0 * (p @ move[:, :, None])[:, :, 0].max(axis=1)


def _levers(
    system: System, x: np.ndarray, lam: np.ndarray, free: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """|P| [R, m, n] with P A' = 1 on free variables, |k| + beta s |lam| [R, n], and beta s [R, n]."""
    a = system.constraints(x)[1] * free[:, None]
    p = np.abs(np.linalg.pinv(a.transpose(0, 2, 1), rcond=1e-12))
    b = np.where(free, system.beta, 0.0)
    turned = b * b.sum(axis=1)[:, None]
    size = np.abs(lam).sum(axis=1)
    return p, np.where(free, system.k, 0.0) + turned * size[:, None], turned


def holds(system: System, roots: Roots, boxes: Boxes) -> np.ndarray:
    """Number of the root whose uniqueness box holds all critical points in each of K small boxes; -1 if none, [K].

    The box lies within `unique`; and the multipliers of a critical point in it, r from the root, are within `spread`:
    with P A' = 1 at the root, lam' - lam = P (G' - G - (A' - A) lam' - F), so that |lam' - lam| <= |P| ((k + beta s |lam|)
    r + |F| + beta s r |lam' - lam|), and where the sum of |P| beta s r over all rows is at most 1/5, the last term adds
    three quarters at most.  Then A has full rank throughout, too: what is critical in the sense of Fritz John has
    multipliers.

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
    p, move, turned = _levers(system, roots.x, roots.lam, roots.pins == 0)
    f = np.abs(system.at(roots.x, roots.lam, roots.pins)[0][:, : system.n])
    f = f + system.fold * (7.0 * system.k + 4.0 * np.abs(roots.lam).sum(axis=1)[:, None])
    moves, noise = ((p @ v[:, :, None])[:, :, 0].max(axis=1) for v in (move, f))
    firm = 0.19 / np.maximum((p @ turned[:, :, None])[:, :, 0].sum(axis=1), 1e-300)
    for k in range(len(boxes)):
        same = (roots.pins == boxes.pins[:, k]).all(axis=1)
        distance = np.maximum(
            np.abs(boxes.lower[:, k] - roots.x), np.abs(boxes.upper[:, k] - roots.x)
        )
        r = np.where(boxes.pins[:, k] == 0, distance, 0.0).max(axis=1)
        inside = (r <= roots.unique * (1 - 1e-9)) & (r <= firm)
        inside &= 1.8 * (moves * r + noise) <= roots.spread
        fits = np.flatnonzero(same & inside)
        if len(fits):
            out[k] = fits[0]
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
        kept[i] = i < known or not (same & (near < roots.unique[:i])).any()
    return roots[np.flatnonzero(kept)]


def least_slope(system: System, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
    """Return the smallest singular value of closure on the free variables at states [K, n], [K]; 0 for fewer of these."""
    if not len(x):
        return np.zeros(0)
    a = system.constraints(x)[1] * (pins == 0)[:, None]
    return np.linalg.svd(a, compute_uv=False)[:, -1]


def _index(
    system: System,
    x: np.ndarray,
    lam: np.ndarray,
    pins: np.ndarray,
    jacobian: np.ndarray,
    radius: np.ndarray,
    lean: np.ndarray,
    which: np.ndarray,
) -> np.ndarray:
    """Negative eigenvalues of the reduced Hessian, [K]; -1 where not certified or not among `which`."""
    n, m = system.n, system.m
    out = np.full(len(x), -1)
    if not len(which):
        return out
    r, free, size = radius[which], (pins == 0)[which], np.abs(lam[which]).sum(axis=1)
    j = jacobian[which].copy()
    j[:, :n, n:] *= -1.0  # symmetric: [[H, A'], [A, 0]]
    b = np.where(free, system.beta, 0.0)
    s = b.sum(axis=1)
    corner = m * lean[which] * r + s * r * size + system.fold * (1 + size)
    off = _bound(system.beta, free, corner, s * r + system.fold, n, m)
    # congruence by powers of two brings the springs to order 1
    scale = np.concatenate([2.0 ** np.round(-0.5 * np.log2(system.k)), np.ones(m)])
    scale = np.where(np.concatenate([free, np.ones((len(r), m), bool)], axis=1), scale, 1.0)
    j *= scale[:, :, None] * scale[:, None, :]
    off *= scale[:, :, None] * scale[:, None, :]
    _, vectors = np.linalg.eigh(j)
    v = np.abs(vectors)
    product = vectors.transpose(0, 2, 1) @ j @ vectors
    error = v.transpose(0, 2, 1) @ (off + 8 * (n + m + 4) * UNIT * np.abs(j)) @ v
    d = np.arange(n + m)
    diagonal = product[:, d, d].copy()
    product[:, d, d] = 0.0
    disc = np.abs(product).sum(axis=2) + error.sum(axis=2)
    near_one = np.abs(vectors.transpose(0, 2, 1) @ vectors - np.eye(n + m)).sum(axis=2).max(axis=1)
    clear = (np.abs(diagonal) > 1.01 * disc).all(axis=1) & (near_one < 0.1)
    out[which] = np.where(clear, (diagonal < 0).sum(axis=1) - m, -1)
    return out


def _signs(
    system: System,
    x: np.ndarray,
    lam: np.ndarray,
    pins: np.ndarray,
    radius: np.ndarray,
    lean: np.ndarray,
) -> np.ndarray:
    """Signs of the torque that is left at pinned variables, [K, n]."""
    force = pins * system.force(x, lam)
    size = np.abs(lam).sum(axis=1)[:, None]
    s = system.beta.sum()
    r = np.where(np.isfinite(radius), radius, 1.0)[:, None]
    off = system.beta * (system.m * lean[:, None] * r + s * r * size)
    off = off + system.fold * (2 * np.pi * system.k + 4 * system.beta * size)
    return np.where(pins != 0, np.where(force > off, 1, np.where(force < -off, -1, 0)), 0)
