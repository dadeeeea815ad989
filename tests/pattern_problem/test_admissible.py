"""The package's embedding test against an independent one, and against counts of flat foldings."""

import itertools
import math

import numpy as np
import pytest

from origami_nlp import Vertex, check_admissible
from tests.independent.admissible import admissible
from tests.independent.arcs import crossing_margin, nearest_touch
from tests.independent.neighbours import Problem
from tests.independent.rotations import fold, project
from tests.independent.stationary import Stratum, retract

BAND = 1e-9
"""Issue: no disagreement outside this distance [rad] from touching."""


def sectors_of(rng, n, total=2 * math.pi):
    while True:
        a = rng.dirichlet(np.full(n, 2.0)) * total
        if a.max() < 3.1 and a.min() > 0.03:
            return a


def closed_states(rng, n, count, total=2 * math.pi):
    """Random closed states of a random vertex, lift q = -1 and fold angles above pi included."""
    a = sectors_of(rng, n, total)
    if total == 2 * math.pi:
        a = np.array(Vertex(tuple(a.tolist())).sector_angles)
    phi, residual = project(a, np.arange(n), rng.uniform(-3.2, 3.2, (count, n)))
    return a, phi[(residual <= 1e-13) & (np.abs(phi) < 3.5).all(axis=1)]


def compare(a, phi, tolerance=None):
    """Return own verdicts and the package's, shape [B]."""
    own = admissible(a, phi)
    vertex = Vertex(tuple(a.tolist()))
    options = {} if tolerance is None else {"tolerance": tolerance}
    return own, np.array([check_admissible(vertex, state, **options).admissible for state in phi])


def random_agreement(seed, states, batch):
    rng = np.random.default_rng(seed)
    done = admitted = 0
    while done < states:
        for n in range(4, 11):
            a, phi = closed_states(rng, n, batch)
            creases, _ = fold(a, phi)
            clear = np.abs(crossing_margin(creases)) > BAND
            clear &= nearest_touch(creases) > BAND
            clear &= (np.abs(np.abs(phi) - math.pi) > BAND).all(axis=1)
            own, package = compare(a, phi[clear])
            assert (own == package).all(), (a, phi[clear][own != package])
            done += int(clear.sum())
            admitted += int(own.sum())
    return done, admitted


def test_random_states_of_degree_4_to_10():
    done, admitted = random_agreement(0, 2000, 40)
    assert 0.05 * done < admitted < 0.95 * done  # both verdicts are met


def touching_states(rng, count):
    """Yield vertices with states where a random crease lies on the plane of a random facet."""
    for _ in range(count):
        n = int(rng.integers(5, 9))
        a = np.array(Vertex(tuple(sectors_of(rng, n).tolist())).sector_angles)
        p = Problem(a, np.arange(n), np.ones(n), np.zeros(n), "full")
        j = int(rng.integers(n))
        k = int((j + rng.integers(2, n)) % n)
        stratum = Stratum(gaps=((j, k),))
        x, residual = retract(p, stratum, rng.uniform(-2.5, 2.5, (12, n)))
        x = x[residual <= 1e-13]
        limit = np.abs(math.pi - np.abs(x)) <= 1e-12  # a neighbouring facet is touched at pi
        x = np.where(limit, np.sign(x) * math.pi, x)
        creases, _ = fold(a, x)
        yield p, x[nearest_touch(creases) <= 1e-12]


def touching_agreement(seed, count):
    rng = np.random.default_rng(seed)
    verdicts, beside = [], []
    for p, x in touching_states(rng, count):
        if not len(x):
            continue
        own, package = compare(p.sectors, x)
        assert (own == package).all(), (p.sectors, x[own != package])
        verdicts += own.tolist()
        # just beside: 3e-9 to 1e-6 off the touch, where a tolerance of 1e-9 has to tell
        step = rng.normal(size=x.shape) * 10 ** rng.uniform(-8.5, -6, (len(x), 1))
        y, residual = project(p.sectors, p.orbit, x + step)
        creases, _ = fold(p.sectors, y)
        clear = (residual <= 1e-14) & (nearest_touch(creases) > BAND)
        own, package = compare(p.sectors, y[clear], tolerance=BAND)
        assert (own == package).all(), (p.sectors, y[clear][own != package])
        beside += own.tolist()
    return verdicts, beside


@pytest.mark.slow
def test_touching_states_and_their_neighbours():
    verdicts, beside = touching_agreement(2, 24)
    for v in (verdicts, beside):
        assert 0 < sum(v) < len(v)


def assignments(a):
    """Valid mountain-valley assignments of a vertex folded flat: own verdict and the package's."""
    n = len(a)
    phi = math.pi * np.array(list(itertools.product((-1.0, 1.0), repeat=n)))
    return phi, *compare(np.array(a), phi)


@pytest.mark.parametrize("n", [4, 6, 8])
def test_equal_angles_fold_flat_in_as_many_ways_as_maekawa_allows(n):
    # all sectors equal: every assignment with M - V = +-2 folds, 2 C(N, N/2 - 1)
    _, own, package = assignments(np.full(n, 2 * math.pi / n))
    assert (own == package).all()
    assert own.sum() == 2 * math.comb(n, n // 2 - 1)


def crimps(sectors, signs):
    """Bern and Hayes: a strictly smallest sector has creases of opposite sign and can be crimped."""
    if len(sectors) == 2:
        return signs[0] == signs[1]
    n = len(sectors)
    i = min(range(n), key=lambda m: sectors[m])
    a = [sectors[(i + m) % n] for m in range(n)]
    s = [signs[(i + m) % n] for m in range(n)]
    # sector 0 lies between creases 0 and 1; its neighbours are sectors n - 1 and 1
    if s[0] == s[1]:
        return False
    return crimps([*a[2 : n - 1], a[n - 1] - a[0] + a[1]], s[2:])


@pytest.mark.parametrize("n", [4, 6, 8])
def test_generic_flat_foldings_are_those_that_crimp(n):
    rng = np.random.default_rng(n)
    for _ in range({4: 12, 6: 6, 8: 2}[n]):
        a = np.empty(n)
        a[::2] = _halves(rng, n // 2)
        a[1::2] = _halves(rng, n // 2)  # Kawasaki: alternate sectors sum to pi
        a = np.array(Vertex(tuple(a.tolist())).sector_angles)
        phi, own, package = assignments(a)
        crimped = np.array([crimps(a.tolist(), np.sign(s).tolist()) for s in phi])
        assert crimped.any()
        assert (own == crimped).all() and (package == crimped).all()


def _halves(rng, n):
    return 0.1 + rng.dirichlet(np.full(n, 3.0)) * (math.pi - 0.1 * n)


def flapped(rng):
    """A random polygon of perimeter < 2 pi with one or two flaps folded flat onto its facets."""
    spare = rng.uniform(0.2, 1.2)
    a, phi = closed_states(rng, int(rng.integers(3, 6)), 8, 2 * math.pi - spare)
    flaps = int(rng.integers(1, 3))
    lengths = spare / 2 * np.array([1.0] if flaps == 1 else rng.dirichlet([3.0, 3.0]))
    where = rng.integers(len(a))  # both flaps on one facet: their order matters
    if len(phi) == 0 or a[where] < 0.1:
        return None
    cuts = np.sort(rng.uniform(0.03, a[where] - 0.03, flaps))
    pieces, position = [], 0.0
    for cut, s in zip(cuts, lengths, strict=True):
        pieces += [cut - position, s]  # forward to the cut, back by s; the next piece starts there
        position = cut - s
    pieces.append(a[where] - position)
    sectors = np.concatenate([a[:where], pieces, a[where + 1 :]])
    if sectors.min() < 0.01 or sectors.max() > 3.1:
        return None
    signs = rng.choice([-math.pi, math.pi], (len(phi), 2 * flaps))
    half = rng.random(len(phi)) < 0.7
    signs[half, 1::2] = -signs[half, ::2]
    states = np.hstack([phi[:, : where + 1], signs, phi[:, where + 1 :]])
    return np.array(Vertex(tuple(sectors.tolist())).sector_angles), states


def flap_agreement(seed, count):
    rng, verdicts = np.random.default_rng(seed), []
    for _ in range(count):
        made = flapped(rng)
        if made is None:
            continue
        own, package = compare(*made)
        assert (own == package).all(), (made[0], made[1][own != package])
        verdicts += own.tolist()
    return verdicts


def test_flaps_folded_flat_on_a_facet():
    verdicts = flap_agreement(5, 80)
    assert 0.02 * len(verdicts) < sum(verdicts) < 0.98 * len(verdicts)
