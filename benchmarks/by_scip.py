"""SCIP on a vertex within fold limits: its global minimum, or how far it came; `pip install pyscipopt`.

Closure as a product of quaternions, one per fold and sector, with half angles as variables: what a user would write.
"""

from __future__ import annotations

import importlib.util
import math
import time
from dataclasses import dataclass
from typing import Any

from origami_nlp.pattern import Scene

LIMIT = 10.0
"""Seconds after which it is stopped."""


@dataclass(frozen=True)
class Global:
    """What SCIP says: its status, energies below and above (inf: none), and processor seconds."""

    degree: int
    status: str
    lower: float
    upper: float
    seconds: float


def is_installed() -> bool:
    """Return whether SCIP can be asked."""
    return importlib.util.find_spec("pyscipopt") is not None


def solve(scene: Scene, limit: float = LIMIT) -> Global:
    """Minimise the energy of a scene over its closed states within fold limits, globally."""
    from pyscipopt import Model, cos, sin

    scip: Any = Model()
    scip.hideOutput()
    scip.setParam("limits/time", limit)
    phi = [scip.addVar(f"phi{i}", lb=-math.pi, ub=math.pi) for i in range(scene.degree)]
    q: tuple[Any, ...] = (1.0, 0.0, 0.0, 0.0)
    for i, (x, a) in enumerate(zip(phi, scene.vertex.sector_angles, strict=True)):
        c, s = (scip.addVar(f"{n}{i}", lb=-1, ub=1) for n in "cs")
        scip.addCons(c == cos(0.5 * x))
        scip.addCons(s == sin(0.5 * x))
        w, u, v, z = q
        # a fold about e1 by phi, then a turn about e3 by the sector
        fold = (w * c - u * s, u * c + w * s, v * c + z * s, z * c - v * s)
        d, e = math.cos(a / 2), math.sin(a / 2)
        after = (
            fold[0] * d - fold[3] * e,
            fold[1] * d + fold[2] * e,
            fold[2] * d - fold[1] * e,
            fold[3] * d + fold[0] * e,
        )
        q = tuple(scip.addVar(f"q{k}{i}", lb=-1, ub=1) for k in range(4))
        for variable, value in zip(q, after, strict=True):
            scip.addCons(variable == value)
    # the sectors turn once: the product is -1, as a quaternion
    scip.addCons(q[0] <= 0)
    for part in q[1:]:
        scip.addCons(part == 0)
    energy = scip.addVar("energy", lb=0)
    springs = zip(scene.stiffness, phi, scene.rest_angles, strict=True)
    scip.addCons(energy >= sum(0.5 * k * (x - r) * (x - r) for k, x, r in springs))
    scip.setObjective(energy)
    begin = time.process_time()
    scip.optimize()
    seconds = time.process_time() - begin
    upper = float(scip.getPrimalbound()) if scip.getNSols() else math.inf
    return Global(scene.degree, scip.getStatus(), float(scip.getDualbound()), upper, seconds)
