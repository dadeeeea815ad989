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
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.chart import HalfChain, fold_wedge
from origami_nlp.numerics import CONTACT_TOL, DEPENDENT, EPS, RESOLVED, SETTLED, quaternion as quat
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import check_admissible

STARTS = 12
"""Random starts for each set of walls."""
MOST_WALLS = 3
MARGIN = 0.1
"""Sector angles keep this far from 0 and pi/2 [rad], where facets degenerate."""
MIDDLE = math.pi / 4
SOLVED = DEPENDENT
"""Residual of an event: where its walls depend on each other nothing smaller is reached."""

Family = Callable[[float], Scene]
"""The scene at a sector angle; its sector angles are affine functions of it."""


class Wall(NamedTuple):
    """A contact as one equation: fold angle `variable` at side * pi, or (variable -1) creases that meet."""

    variable: int
    side: int
    name: str


@dataclass(frozen=True)
class Event:
    """A sector angle at which the active walls become dependent, at a state that contact and layers admit.

    alpha: sector angle, polished to rounding [rad].  walls: active walls.  fold_angles: of the state, all N.
    residual: of the polished equations (closure and walls).
    """

    alpha: float
    walls: tuple[str, ...]
    fold_angles: tuple[float, ...]
    residual: float

    def is_like(self, other: Event) -> bool:
        """Return whether it is at the same sector angle, with the same walls."""
        return self.walls == other.walls and abs(self.alpha - other.alpha) <= RESOLVED


def walls_of(chain: HalfChain) -> list[Wall]:
    """Every wall of a chain, each side of a fold limit by itself."""
    names = [ray.crease + 1 for ray in chain.scene.group.rays if ray.crease is not None]
    limits = [
        Wall(v, s, f"phi_{crease} = {'+' if s > 0 else '-'}pi")
        for v, crease in enumerate(names)
        for s in (-1, 1)
    ]
    ends = (chain.size - 1,) if chain.kind == "degree6" else (0, chain.size - 1)
    return [*limits, *(Wall(-1, end, chain.walls[-(end > 0)]) for end in ends)]


def find_events(make: Family, seed: int = 0, starts: int = STARTS) -> list[Event]:
    """Find sector angles at which walls become dependent at an admissible state.

    Parameters
    ----------
    make
        The family.
    seed
        Of the random starts.

    Returns
    -------
    events
        One for each sector angle and set of active walls, sorted by sector angle.
    """
    from scipy.optimize import root

    rng = np.random.default_rng(seed)
    chain = HalfChain(make(MIDDLE))
    k, found = chain.size, list[Event]()
    for chosen in _sets(walls_of(chain)):
        limits = {wall.variable: wall.side * math.pi for wall in chosen if wall.variable >= 0}
        system = ContactKkt(make, chain, chosen)
        for _ in range(starts):
            z = np.append(
                rng.uniform(-math.pi, math.pi, k), rng.uniform(MARGIN, math.pi / 2 - MARGIN)
            )
            z[[*limits]] = [*limits.values()]
            z = np.append(z, system.first_multipliers(z))
            answer = root(
                system.residual, z, jac=system.jacobian, method="lm", options={"maxiter": 60}
            )
            if np.abs(answer.fun).max() > RESOLVED or np.abs(answer.x).max() > 1e6:
                continue
            event = _polished(make, chosen, system, answer.x)
            if event and not any(event.is_like(other) for other in found):
                found.append(event)
    return sorted(found, key=lambda e: (e.alpha, e.walls))


def _sets(walls: Sequence[Wall]) -> Iterator[tuple[Wall, ...]]:
    """All sets of up to `MOST_WALLS` walls, with one side of each fold limit."""
    for count in range(1, MOST_WALLS + 1):
        for chosen in itertools.combinations(walls, count):
            limits = [wall.variable for wall in chosen if wall.variable >= 0]
            if len(set(limits)) == len(limits):
                yield chosen


class ContactKkt:
    """The KKT system of one set of walls at z = (x, alpha, lambda), compiled: `residual` and `jacobian`."""

    def __init__(self, make: Family, chain: HalfChain, walls: Sequence[Wall]) -> None:
        import casadi as ca

        self.k = chain.size
        x, alpha = ca.SX.sym("x", self.k), ca.SX.sym("alpha")
        equations = _equations(make, chain, walls, x, alpha)
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


def _equations(make: Family, chain: HalfChain, walls: Sequence[Wall], x: Any, alpha: Any) -> Any:
    """Closure and walls as CasADi expressions of the wedge's fold angles and the sector angle."""
    import casadi as ca

    one, two = (np.array(HalfChain(make(a)).sectors) for a in (MIDDLE, 0.5 * MIDDLE))
    # two scenes of the family give both coefficients
    slope = np.round((one - two) / (0.5 * MIDDLE), 9)  # sector angles are a + b alpha, b an integer
    sectors = [a + b * alpha for a, b in zip((one - slope * MIDDLE).tolist(), slope, strict=True)]
    order = chain.scene.group.order
    rays, normal, turn = fold_wedge(order, sectors, [x[r] for r in range(chain.size)], ca)
    # the last mirror makes the angle pi/n with the first (paper, eq. 2.5 and 2.8): H e2 = e2 for n = 1
    rows: list[Any] = [turn[1], turn[3]] if order == 1 else [normal[1] + math.cos(math.pi / order)]
    for wall in walls:
        if wall.variable >= 0:
            rows.append(x[wall.variable] - wall.side * math.pi)
        elif chain.kind == "degree6":
            rows.append(rays[-1][2])  # crease 4 on the line of crease 1
        else:
            rows.append(rays[-1][1] if wall.side else quat.dot(rays[0], normal))
    return ca.vertcat(*rows)


def _polished(
    make: Family, walls: Sequence[Wall], system: ContactKkt, z: np.ndarray
) -> Event | None:
    """Newton steps to rounding, and the state looked at; None where it is not admissible.

    Where a whole curve is critical the Jacobian is singular: steps of least length stay on the curve's nearest point.
    """
    for _ in range(30):
        f = system.residual(z)
        if np.abs(f).max() <= 4 * EPS:
            break
        z = z - np.linalg.lstsq(system.jacobian(z), f, rcond=SETTLED)[0]
    residual = float(np.abs(system.residual(z)).max())
    x, alpha = z[: system.k], float(z[system.k])
    if (
        residual > SOLVED
        or np.abs(x).max() > math.pi + RESOLVED
        or not MARGIN <= alpha <= math.pi / 2 - MARGIN
    ):
        return None
    scene = make(alpha)
    phi = np.clip(x, -math.pi, math.pi)[list(scene.group.orbit)]
    if not check_admissible(scene, phi, tolerance=SETTLED).admissible:
        return None
    return Event(alpha, tuple(wall.name for wall in walls), tuple(phi.tolist()), residual)
