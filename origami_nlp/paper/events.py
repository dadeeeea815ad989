"""Sector angles at which contacts of symmetric states become dependent: where the topology of X can change.

Let the states x and the sector angle alpha of a family of vertices vary together.  The set {(x, alpha)} is cut by
contact walls into smooth strata, and the topology of its slices X(alpha) changes only where alpha, as a function on a
stratum, has a critical point (stratified Morse theory).  With closure g = 0 and active walls f_A = 0 such a point is a
KKT point of "alpha is extreme":

    g = 0,   f_A = 0,   (g_x; f_x)' lambda = 0,   (g_alpha; f_alpha) . lambda = 1.

The system is square.  It is solved from many random starts for every set A of up to three walls; nothing is reported
about where to look.  Events at which a whole curve is critical (two walls coincide) are found as points of that curve.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.chart import HalfChain, chain_of, fold_vertex, fold_wedge, pair_depths
from origami_nlp.numerics import CONTACT_TOL, DEPENDENT, EPS, RESOLVED, SETTLED, quaternion as quat
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import check_admissible

STARTS = 12
"""Random starts for each set of walls."""
MOST_WALLS = 3
SOLVED = DEPENDENT
"""Residual of an event: where its walls depend on each other nothing smaller is reached."""


@dataclass(frozen=True)
class Wall:
    """A contact as one equation: fold angle `variable` at side * pi, or (variable -1) creases that meet."""

    variable: int
    side: int
    name: str


@dataclass(frozen=True)
class Event:
    """A sector angle at which the active walls become dependent.

    alpha: sector angle, polished to rounding [rad].  walls: active walls.  fold_angles: a state of it, all N.
    multipliers: lambda of closure, then walls.  residual: of the polished equations (closure and walls).
    admissible: whether the state is, contact and symmetric layers included.
    """

    alpha: float
    walls: tuple[str, ...]
    fold_angles: tuple[float, ...]
    multipliers: tuple[float, ...]
    residual: float
    admissible: bool


def walls_of(chain: HalfChain) -> list[Wall]:
    """Every wall of a chain, each side of a fold limit by itself."""
    creases = [ray.crease for ray in chain.scene.group.rays]
    walls = []
    for v, crease in enumerate(creases):
        assert crease is not None
        walls += [Wall(v, s, f"phi_{crease + 1} = {'+' if s > 0 else '-'}pi") for s in (-1, 1)]
    last = len(creases)
    if chain.kind == "degree6":
        return [*walls, Wall(-1, last - 1, chain.walls[-1])]
    return [*walls, Wall(-1, 0, chain.walls[0]), Wall(-1, last - 1, chain.walls[-1])]


def find_events(
    make: Callable[[float], Scene], low: float, high: float, seed: int = 0, starts: int = STARTS
) -> list[Event]:
    """Find sector angles in [low, high] at which walls become dependent at a state that does not cross itself.

    Parameters
    ----------
    make
        Scene at a sector angle; the sector angles must be affine functions of it.
    seed
        Of the random starts.

    Returns
    -------
    events
        One for each sector angle and set of active walls, sorted by sector angle.
    """
    from scipy.optimize import root

    rng = np.random.default_rng(seed)
    middle = 0.5 * (low + high)
    chain = chain_of(make(middle))
    walls = walls_of(chain)
    k = chain.size
    found: list[Event] = []
    sets = (itertools.combinations(walls, count) for count in range(1, MOST_WALLS + 1))
    for chosen in itertools.chain.from_iterable(sets):
        limits = [wall for wall in chosen if wall.variable >= 0]
        if len({wall.variable for wall in limits}) < len(limits):
            continue
        system = ContactKkt(make, middle, chain, chosen)
        for _ in range(starts):
            z = np.append(rng.uniform(-math.pi, math.pi, k), rng.uniform(low, high))
            for wall in limits:
                z[wall.variable] = wall.side * math.pi
            z = np.append(z, system.first_multipliers(z))
            answer = root(
                system.residual, z, jac=system.jacobian, method="lm", options={"maxiter": 60}
            )
            if np.abs(answer.fun).max() > RESOLVED or np.abs(answer.x).max() > 1e6:
                continue
            event = _polished(make, chosen, system, answer.x, low, high)
            if event is None:
                continue
            same = [e for e in found if e.walls == event.walls]
            same = [e for e in same if abs(e.alpha - event.alpha) <= RESOLVED]
            if not same or (event.admissible and not same[0].admissible):
                found = [e for e in found if e not in same] + [event]
    return sorted(found, key=lambda e: (e.alpha, e.walls))


class ContactKkt:
    """The KKT system of one set of walls at z = (x, alpha, lambda), compiled: `residual` and `jacobian`."""

    def __init__(
        self, make: Callable[[float], Scene], middle: float, chain: HalfChain, walls: Sequence[Wall]
    ) -> None:
        import casadi as ca

        self.k = chain.size
        x, alpha = ca.SX.sym("x", self.k), ca.SX.sym("alpha")
        equations = _equations(make, middle, chain, walls, x, alpha)
        lam = ca.SX.sym("lam", equations.numel())
        jx, ja = ca.jacobian(equations, x), ca.jacobian(equations, alpha)
        # KKT of the sector angle itself: alpha is stationary among states with these walls closed, grad alpha = J' lam
        f = ca.vertcat(equations, jx.T @ lam, ca.dot(ja, lam) - 1)
        z = ca.vertcat(x, alpha, lam)
        system = ca.Function("f", [z], [f, ca.jacobian(f, z)])
        gradients = ca.Function("g", [x, alpha], [ca.horzcat(jx, ja)])
        self.residual = lambda z: np.asarray(system(z)[0]).ravel()
        self.jacobian = lambda z: np.asarray(system(z)[1])
        self.gradients = lambda x, alpha: np.asarray(gradients(x, alpha))

    def first_multipliers(self, z: np.ndarray) -> np.ndarray:
        """Return the multipliers that fit best at the x and alpha of z."""
        target = np.append(np.zeros(self.k), 1.0)
        jacobian = self.gradients(z[: self.k], z[self.k])
        return np.linalg.lstsq(jacobian.T, target, rcond=CONTACT_TOL)[0]


def _equations(
    make: Callable[[float], Scene],
    middle: float,
    chain: HalfChain,
    walls: Sequence[Wall],
    x: Any,
    alpha: Any,
) -> Any:
    """Closure and walls as CasADi expressions of the wedge's fold angles and the sector angle."""
    import casadi as ca

    one, two = (np.array(chain_of(make(a)).sectors) for a in (middle, 0.5 * middle))
    # two scenes of the family give both coefficients
    slope = np.round((one - two) / (0.5 * middle), 9)  # sector angles are a + b alpha, b an integer
    start = one - slope * middle
    sectors = [start[i] + slope[i] * alpha for i in range(len(one))]
    order = chain.scene.group.order
    rays, normal, turn = fold_wedge(order, sectors, [x[r] for r in range(chain.size)], ca)
    # the last mirror makes the angle pi/n with the first (paper, eq. 2.5 and 2.8): H e2 = e2 for n = 1
    rows: list[Any] = [turn[1], turn[3]] if order == 1 else [normal[1] + math.cos(math.pi / order)]
    for wall in walls:
        if wall.variable >= 0:
            rows.append(x[wall.variable] - wall.side * math.pi)
        elif chain.kind == "degree6":
            rows.append(rays[-1][2])  # crease 4 on the line of crease 1
        elif wall.side == 0:
            rows.append(quat.dot(rays[0], normal))
        else:
            rows.append(rays[-1][1])
    return ca.vertcat(*rows)


def _polished(
    make: Callable[[float], Scene],
    walls: Sequence[Wall],
    system: ContactKkt,
    z: np.ndarray,
    low: float,
    high: float,
) -> Event | None:
    """Newton steps to rounding, and the state looked at; None where there is no such state.

    Where a whole curve is critical the Jacobian is singular: steps of least length stay on the curve's nearest point.
    """
    for _ in range(30):
        f = system.residual(z)
        if np.abs(f).max() <= 4 * EPS:
            break
        z = z - np.linalg.lstsq(system.jacobian(z), f, rcond=SETTLED)[0]
    residual = float(np.abs(system.residual(z)).max())
    x, alpha = z[: system.k], float(z[system.k])
    if residual > SOLVED or not np.abs(x).max() <= math.pi + RESOLVED or not low <= alpha <= high:
        return None
    scene = make(alpha)
    phi = np.clip(x, -math.pi, math.pi)[list(scene.group.orbit)]
    creases, q = fold_vertex(scene.vertex, phi)
    # closed as the lift q = +1, and no facets through each other
    if q[0] < 0 or np.linalg.norm(q[1:]) > RESOLVED or _deepest(creases) > SETTLED:
        return None
    good = check_admissible(scene, phi, tolerance=SETTLED).admissible
    names = tuple(wall.name for wall in walls)
    lam = tuple(z[system.k + 1 :].tolist())
    return Event(alpha, names, tuple(phi.tolist()), lam, residual, good)


def _deepest(creases: np.ndarray) -> float:
    """Depth of the deepest crossing of two non-adjacent facets."""
    n = len(creases)
    pairs = [(i, j) for i, j in itertools.combinations(range(n), 2) if 2 <= j - i <= n - 2]
    return float(pair_depths(creases, pairs).max())
