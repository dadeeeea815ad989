"""Critical points in small boxes, by the KKT system of a stratum: existence, uniqueness, signs and index.

F = [k (x - rest) - A' lam ; g] in (x, lam), g the closure of the vertex, A its Jacobian; J = [[K - lam . g'', -A'], [A,
0]].

Closure g are the rows of the piece (`pieces`) that are of first order, each about the state that it is asked at: B_0
and the frame of the first mirror stay those of that state.  A zero of these beside it closes.  A B_0 and B_0 / B are
unit quaternions with one vector part, so that their scalars are equal but for their sign, and both are positive within
the boxes of roots, where half chains turn by less than pi / 2; n_1 and N have two entries in common, and the third is
positive of both; one equation is all there is for D_n and C_n.  And at a closed state the slopes of g are those of
closure times a matrix that is regular as long as these scalars, or entries, are not zero: multipliers exist for both or
for neither.

Derivatives of order p in the directions i, j, ... are at most beta_i beta_j ... in size (`rows`): beta = 1/2 a fold
where g is of quaternions, 1 where of vectors, half of that on a mirror.

Rounding.  Axes and products are known to what `rows` says of chains of so many steps; near the flat state the vector
part of the product of folds is known to that share of it.

On a stratum with free variables f a critical point solves F = 0 in (x_f, lam), which is square.  Krawczyk: for any Y,
if |Y F(z0)| + sup |I - Y J(Z)| rho < rho on Z = z0 +- rho, Z holds exactly one zero.  There, with s = sum_j beta_j
rho_j,

    |J(Z) - J(z0)| <= [[ beta_i beta_j (sum |d lam| + s sum |lam|), beta_i s ], [ beta_j s, 0 ]].

With rho = t (1, ..., 1, mu, ..., mu) both conditions are a quadratic in t: the smallest t that fits is the accuracy of
the root, the largest the box in which it is the only one.

Index.  The number of negative eigenvalues of [[H, A'], [A, 0]] less the number of equations, where A has full rank.
With X the computed eigenvectors, X' J X = D + R is known with error bounds; where all Gershgorin discs miss zero, the
signs of D count (Sylvester, X being regular as X' X is near 1).

Rounding: `BoxKkt.noise` bounds what it leaves in g, A and g''.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import CURVED, DUPLICATE_TOL, FOLLOWED, INDEPENDENT
from origami_nlp.proof.boxes import WIDER, Boxes
from origami_nlp.proof.pieces import ReducedVertex, piece_of
from origami_nlp.proof.rows import CREASE, TINY, UNIT, Gap, Triples, pairs


@dataclass(frozen=True, eq=False)
class BoxDerivatives:
    """The system at R states, and what its derivatives are there.

    Attributes
    ----------
    force
        k (x - rest) - A' lam of all variables, [R, n].
    f, jacobian
        Shape [R, n + m] and [R, n + m, n + m]; rows and columns of pinned variables are those of 1.
    fuzz
        What rounding, and doubt of sectors, leave in `f` at most, of pinned variables in `force`, [R, n + m].
    a
        Jacobian of closure, of free variables (0 for others), [R, m, n].
    k, beta
        Stiffness and beta of free variables (0 for others), [R, n].
    size
        sum |lam|, [R].
    noise
        What rounding and doubt leave in entries of A and g'', of size 1.
    """

    force: np.ndarray
    f: np.ndarray
    jacobian: np.ndarray
    fuzz: np.ndarray
    a: np.ndarray
    k: np.ndarray
    beta: np.ndarray
    size: np.ndarray
    noise: float

    def change(self, mu: np.ndarray) -> np.ndarray:
        """Bound |J(Z) - J(z0)| / t on Z = z0 +- t (1, ..., mu, ...): [R, n + m, n + m]."""
        m = self.a.shape[1]
        s = self.beta.sum(axis=1)
        return self._bordered(m * mu + s * self.size, s, m)

    def doubt(self) -> np.ndarray:
        """Bound what rounding and doubt leave in J, [R, n + m, n + m]."""
        noise = 4 * self.noise * np.ones(len(self.f))
        return self._bordered(noise * (1 + self.size), noise, self.a.shape[1])

    def _bordered(self, corner: np.ndarray, side: np.ndarray, m: int) -> np.ndarray:
        """[[corner beta_i beta_j, side beta_i], [side beta_j, 0]], of m rows of closure."""
        b = self.beta
        n = b.shape[1]
        out = np.zeros((len(b), n + m, n + m))
        out[:, :n, :n] = corner[:, None, None] * b[:, :, None] * b[:, None, :]
        out[:, :n, n:] = side[:, None, None] * b[:, :, None]
        out[:, n:, :n] = side[:, None, None] * b[:, None, :]
        return out


class BoxKkt:
    """The KKT system of a vertex, over states of any stratum.

    Parameters
    ----------
    vertex
        Of a flat sheet.
    gaps
        Those that are closed.
    """

    def __init__(self, vertex: ReducedVertex, gaps: tuple[Gap, ...] = ()) -> None:
        self.piece = piece = piece_of(vertex)
        chain = piece.chain
        self.n, self.equations = vertex.size, piece.rank
        self.m = piece.rank + len(gaps)
        self.k, self.rest = vertex.problem.parameters.stiffness, piece.rest
        self.gaps = Triples(chain, [chain.closed(*g.rays, kind=g.kind) for g in gaps])
        self.sines = np.array(
            [math.sin(piece.sectors[g.rays[1]]) if g.rays[1:] else 1.0 for g in gaps]
        )
        weight = np.ones(self.n)
        weight[chain.variable[chain.folds > 0]] = chain.folds[chain.folds > 0]
        self.beta = weight * (1.0 if gaps or piece.by_vectors else 0.5)
        # three axes or rays of a chain, and the product of its folds
        self.noise = 3 * CREASE * chain.around + chain.loop_rounding
        if gaps:
            self.noise *= 4 / float(self.sines.min())

    def vanishing(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return g [R, m] at states [R, n], its Jacobian [R, m, n] and g'' [R, m, n, n]."""
        folded = self.piece.chain.fold(x.T, np.ones(x.T.shape))
        rows = [self.piece.equations(folded)]
        if len(self.sines):
            rows.append(self.gaps.at(folded))
        g, a, bends = (np.concatenate([r.parts[i] for r in rows]) for i in range(3))
        first, second, number = pairs(self.n)
        bends = bends * np.where(first == second, 2.0, 1.0)[:, None]
        g, a, bends = (np.moveaxis(v, -1, 0) for v in (g, a, bends))
        scale = np.concatenate([np.ones(self.equations), 1 / self.sines])
        return g * scale, a * scale[:, None], bends[:, :, number] * scale[:, None, None]

    def closes(self, x: np.ndarray) -> np.ndarray:
        """Return whether zeros of g at states [R, n] are closed, and not of the other lift, [R]."""
        return self.piece.closes(self.piece.chain.fold(x.T, np.ones(x.T.shape)))

    def at(self, x: np.ndarray, lam: np.ndarray, pins: np.ndarray) -> BoxDerivatives:
        """Return the system at states [R, n] with multipliers [R, m] on strata [R, n]."""
        n, m = self.n, self.m
        g, a, second = self.vanishing(x)
        h = -np.einsum("rm,rmij->rij", lam, second)
        i = np.arange(n)
        h[:, i, i] += self.k
        force = self.k * (x - self.rest) - np.einsum("rm,rmn->rn", lam, a)
        free = pins == 0
        jacobian = np.zeros((len(x), n + m, n + m))
        jacobian[:, :n, :n] = h
        jacobian[:, :n, n:] = -a.transpose(0, 2, 1)
        jacobian[:, n:, :n] = a
        pinned = np.concatenate([~free, np.zeros((len(x), m), dtype=bool)], axis=1)
        jacobian[pinned] = 0.0
        # rows and columns of pinned variables become those of 1: one shape of matrix for all strata
        jacobian.transpose(0, 2, 1)[pinned] = 0.0
        diagonal = np.arange(n + m)
        jacobian[:, diagonal, diagonal] += pinned
        return BoxDerivatives(
            force,
            np.concatenate([np.where(free, force, 0.0), g], axis=1),
            jacobian,
            self._fuzz(x, lam),
            a * free[:, None],
            np.where(free, self.k, 0.0),
            np.where(free, self.beta, 0.0),
            np.abs(lam).sum(axis=1),
            self.noise,
        )

    def _fuzz(self, x: np.ndarray, lam: np.ndarray) -> np.ndarray:
        """What rounding and doubt leave in F at most, [R, n + m]; less of closure near the flat state."""
        near = np.ones(len(x))
        if self.piece.near_flat and self.m == self.equations:
            near = np.minimum(1.0, np.abs(x).sum(axis=1))
        torque = 7.0 * self.k + 4.0 * self.beta * np.abs(lam).sum(axis=1)[:, None]
        return self.noise * np.concatenate([torque, near[:, None] + np.zeros((1, self.m))], axis=1)

    def start(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the multipliers [R, m] that balance the free variables best."""
        a = self.vanishing(x)[1] * (pins == 0)[:, None]
        torque = np.where(pins == 0, self.k * (x - self.rest), 0.0)
        return (np.linalg.pinv(a.transpose(0, 2, 1), rcond=INDEPENDENT) @ torque[:, :, None])[
            :, :, 0
        ]

    def least_slope(self, x: np.ndarray, pins: np.ndarray) -> np.ndarray:
        """Return the smallest singular value of closure on the free variables, [R]; 0 where these are too few."""
        if not len(x):
            return np.zeros(0)
        a = self.vanishing(x)[1] * (pins == 0)[:, None]
        return np.linalg.svd(a, compute_uv=False)[:, -1]


STEPS = 10
"""Newton's steps from the middle of a box: to a regular root it takes two or three; beside singular states it does not
end."""
FAR = 0.05
"""A root further from its box than this [rad] is none of it."""
SHARE = 0.3
"""Sides of the uniqueness box in multipliers, over what these move at most with x."""
TRIED = 0.3 * 2.0 ** (-0.25 * np.arange(192))
"""Sides of boxes round roots [rad]: in the widest half chains turn by less than pi / 2."""


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


def certify(system: BoxKkt, x: np.ndarray, lam: np.ndarray, pins: np.ndarray) -> Roots:
    """Certify zeros of the KKT system.

    Parameters
    ----------
    system
        Of the model.
    x, lam, pins
        Approximate zeros, shape [K, n], [K, m] and [K, n].

    Returns
    -------
    Roots
        Those that exist, and are the only ones near.
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
    lean = _lean(at)
    rho = np.concatenate([np.where(free, 1.0, 0.0), lean[:, None] + np.zeros((1, m))], axis=1)
    # wrong + rest rho t + (reach change rho) t^2 < rho t, row by row; rows of pinned variables are exact
    a = (reach @ at.change(lean) @ rho[:, :, None])[:, :, 0]
    b = rho - (rest @ rho[:, :, None])[:, :, 0]
    smallest, largest = _between(a, b, wrong, rows)
    which = np.flatnonzero(sound & (smallest < largest))
    index = _index(system, at, free, smallest, lean, which)
    signs = _signs(system, at, pins, smallest, lean)
    roots = Roots(x, lam, pins, smallest, largest, lean * largest, index, signs)
    return roots[which]


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
    """Return the smallest and the largest t tried with a t^2 - b t + c < 0, with room for rounding; inf, 0 if none."""
    a, b, c = (v[:, :, None] for v in (1.01 * a + TINY, 0.99 * b, 1.01 * c + TINY))
    fits = (((a * TRIED - b) * TRIED + c < 0) | ~rows[:, :, None]).all(axis=1)
    return np.where(fits, TRIED, np.inf).min(axis=1), np.where(fits, TRIED, 0.0).max(axis=1)


def _lean(at: BoxDerivatives) -> np.ndarray:
    """Ratio of the sides of a box in multipliers and in x: a share of twice what those move by (`holds`)."""
    p, move, _ = _levers(at)
    return 2.0 * SHARE * (p @ move[:, :, None])[:, :, 0].max(axis=1)


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


def different(roots: Roots) -> Roots:
    """Return the first of all that are the same: of one stratum, one within the uniqueness box of the other."""
    kept = np.zeros(len(roots), dtype=bool)
    for i in range(len(roots)):
        same = kept[:i] & (roots.pins[:i] == roots.pins[i]).all(axis=1)
        near = np.abs(roots.x[:i] - roots.x[i]).max(axis=1, initial=0.0) + roots.radius[i]
        # two certified zeros in one box of uniqueness are one
        kept[i] = not (same & (near < roots.unique[:i])).any()
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
