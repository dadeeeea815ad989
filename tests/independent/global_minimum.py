"""The lowest energy of a vertex with fold limits, proved by SCIP: spatial branch and bound, no start, no descent.

Written from the product of quaternions alone; shares nothing with the package's problems or searches.
"""

from __future__ import annotations

import math

import numpy as np


def proved(
    sectors: np.ndarray, stiffness: np.ndarray, rest: np.ndarray, seconds: float
) -> tuple[float, float, np.ndarray]:
    """Minimise 1/2 sum k (phi - rest)^2 over closed states with |phi| <= pi.

    Folds are unit quaternions (cos phi_i/2, sin phi_i/2 b_i); the product of the first half of them is the conjugate
    of that of the second half (lift q = +1), which keeps the products short.  Returns the lowest energy found, the
    proved lower bound, and the state [N].
    """
    from pyscipopt import Model, cos, quicksum, sin

    n, azimuths = len(sectors), np.concatenate([[0.0], np.cumsum(sectors)[:-1]])
    model = Model()
    model.hideOutput()
    model.setParam("limits/time", seconds)
    model.setParam("limits/gap", 1e-6)
    phi = [model.addVar(f"phi{i}", lb=-math.pi, ub=math.pi) for i in range(n)]
    energy = model.addVar("energy", lb=0.0)
    model.setObjective(energy)
    model.addCons(
        energy
        >= quicksum(
            0.5 * k * (p - r) * (p - r) for k, p, r in zip(stiffness, phi, rest, strict=True)
        )
    )

    def product(creases: range) -> list:
        """Variables of the product of some folds."""
        q: list = []
        for i in creases:
            c, s = model.addVar(lb=0.0, ub=1.0), model.addVar(lb=-1.0, ub=1.0)
            model.addCons(c == cos(0.5 * phi[i]))
            model.addCons(s == sin(0.5 * phi[i]))
            model.addCons(c * c + s * s == 1)
            bx, by = math.cos(azimuths[i]), math.sin(azimuths[i])
            if not q:
                q = [c, bx * s, by * s, 0.0 * s]
                continue
            w, x, y, z = q
            terms = [
                w * c - (bx * x + by * y) * s,
                x * c + (bx * w - by * z) * s,
                y * c + (by * w + bx * z) * s,
                z * c + (by * x - bx * y) * s,
            ]
            q = [model.addVar(lb=-1.0, ub=1.0) for _ in terms]
            for new, term in zip(q, terms, strict=True):
                model.addCons(new == term)
            model.addCons(quicksum(v * v for v in q) == 1)
        return q

    first, second = product(range(n // 2)), product(range(n // 2, n))
    for a, b, sign in zip(first, second, (1, -1, -1, -1), strict=True):
        model.addCons(a == sign * b)
    model.optimize()
    state = np.array([model.getVal(p) for p in phi]) if model.getNSols() else np.full(n, math.nan)
    return model.getObjVal() if model.getNSols() else math.inf, model.getDualbound(), state
