"""The program of a design posed and solved by CVXPY, in a process of its own, to compare times and optima.

``python -m benchmarks.by_cvxpy`` reads programs as JSON and writes margins and processor times.  CVXPY loads
a library that crashes beside CasADi, so that nothing of this package that needs CasADi is loaded there.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from importlib.util import find_spec
from typing import Any

import numpy as np

SOLVERS = ("CLARABEL", "SCS")
REPEATS = 3
ACCURACY = {
    "CLARABEL": {},
    "SCS": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iters": 100_000},
}


def is_there() -> bool:
    """Return whether CVXPY and both solvers are installed."""
    return all(find_spec(name) is not None for name in ("cvxpy", "clarabel", "scs"))


def by_cvxpy(programs: list[dict[str, Any]]) -> list[dict[str, tuple[float, float]]]:
    """Solve programs by both solvers.

    Parameters
    ----------
    programs
        Each with ``size``, ``aim`` (position of what is made largest) and ``rows``: cone, a, b.

    Returns
    -------
    list of dict
        Optimum (-inf where infeasible, nan where undecided) and median processor time [s], by solver.
    """
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.by_cvxpy"],
        input=json.dumps(programs),
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    return [{k: (v[0], v[1]) for k, v in one.items()} for one in json.loads(done.stdout)]


def _solve(program: dict[str, Any], solver: str) -> float:
    import cvxpy as cp

    v = cp.Variable(program["size"])
    rules = []
    for cone, a, b in program["rows"]:
        slack = np.array(a) @ v + np.array(b)
        if cone == "=":
            rules.append(slack == 0)
        elif cone == ">=":
            rules.append(slack >= 0)
        else:
            q = round(len(b) ** 0.5)
            rules.append(cp.reshape(slack, (q, q), order="C") >> 0)
    problem = cp.Problem(cp.Maximize(v[program["aim"]]), rules)
    try:
        problem.solve(solver=solver, **ACCURACY[solver])
    except cp.error.SolverError:
        return float("nan")
    if problem.status in ("infeasible", "infeasible_inaccurate"):
        return float("-inf")
    return float(problem.value) if problem.status == "optimal" else float("nan")


def main() -> None:
    """Read programs from standard input and write what was found to standard output."""
    out = []
    programs = json.load(sys.stdin)
    _solve(programs[0], SOLVERS[0])  # loads the library
    for program in programs:
        found = {}
        for solver in SOLVERS:
            times = []
            for _ in range(REPEATS):
                start = time.process_time()
                value = _solve(program, solver)
                times.append(time.process_time() - start)
            found[solver] = (value, float(np.median(times)))
        out.append(found)
    json.dump(out, sys.stdout)


if __name__ == "__main__":
    main()
