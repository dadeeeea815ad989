"""The same questions posed anew, by CVXPY, and answered by another solver.

A process of its own (CVXPY loads a library that crashes beside CasADi): reads questions as JSON, writes largest
margins.  It shares no code with the package: closure is a product of rotation matrices, and so are its derivatives.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np


def ask(posed, solver="SCS"):
    """Largest margins by the other solver; inf - inf is nan where it ended without an answer, -inf where infeasible."""
    questions = [plain(p) for p in posed]
    done = subprocess.run(
        [sys.executable, str(Path(__file__)), solver],
        input=json.dumps(questions),
        capture_output=True,
        text=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return [float(v) for v in json.loads(done.stdout)]


def can_be_asked(posed):
    """Whether only fold limits touch, which are linear: contacts of facets have no code here."""
    return all(c.is_limit for _, b, _ in posed.balances for c in b.stratum.contacts)


def plain(posed):
    """A question as numbers."""
    t = posed.targets
    assert can_be_asked(posed) and posed.targets.blank.group.is_trivial
    states = []
    for i, balance, _ in posed.balances:
        limits = [
            [c.index, c.side, bool(p) and not posed.loose]
            for c, p in zip(balance.stratum.contacts, balance.pressed, strict=True)
        ]
        share = t.states[i].margin
        states.append({"x": list(balance.stratum.state.x), "limits": limits, "share": share})
    return {
        "sectors": list(t.origami.sector_angles),
        "states": states,
        "loose": posed.loose,
        "stiffness": list(t.stiffness),
        "rest": list(t.rest),
    }


def closure(sectors, x):
    """Derivatives of the closure of a loop, first [3, N] and second [3, N, N]."""
    n = len(x)
    turn = np.array([[0.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # about the first axis

    def product(marked):
        m = np.eye(3)
        for i in range(n):
            c, s = np.cos(x[i]), np.sin(x[i])
            a, b = np.cos(sectors[i]), np.sin(sectors[i])
            fold = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
            for _ in range(marked.count(i)):
                fold = turn @ fold
            m = m @ fold @ np.array([[a, -b, 0], [b, a, 0], [0, 0, 1]])
        return m

    def axial(m):
        return np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / 2

    first = np.array([axial(product([i])) for i in range(n)]).T
    second = np.array([[axial(product([i, j])) for i in range(n)] for j in range(n)])
    return first, second.transpose(2, 0, 1)


def null_space(a):
    _, values, vt = np.linalg.svd(a)
    return vt[int((values > 1e-7).sum()) :].T


def answer(question, solver):
    import cvxpy as cp

    sectors = np.array(question["sectors"])
    n = len(sectors)
    k, tau, scale, t = cp.Variable(n), cp.Variable(n), cp.Variable(), cp.Variable()
    (low, high), (least, most) = question["stiffness"], question["rest"]
    rules = [cp.sum(k) == n, k >= low * scale, k <= high * scale, t <= 10]
    rules += [tau >= least * k, tau <= most * k]
    for state in question["states"]:
        x, share = np.array(state["x"]), state["share"]
        j, h = closure(sectors, x)
        lam = cp.Variable(3)
        force = cp.multiply(k, x) - tau - j.T @ lam
        held = []
        if state["limits"]:
            mu = cp.Variable(len(state["limits"]))
            for i, (crease, side, pressed) in enumerate(state["limits"]):
                row = np.zeros(n)
                row[crease] = -side  # of the opening pi - side phi
                force = force - row * mu[i]
                rules.append(mu[i] >= (share * t if pressed else 0.0))
                if pressed or question["loose"]:
                    held.append(row)
        rules.append(force == 0)
        z = null_space(np.vstack([j, *held]))
        if z.shape[1]:
            curved = cp.diag(k) - sum(lam[i] * h[i] for i in range(3))
            matrix = z.T @ curved @ z - share * t * np.eye(z.shape[1])
            rules.append((matrix + matrix.T) / 2 >> 0)
    problem = cp.Problem(cp.Maximize(t), rules)
    more = {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iters": 200_000} if solver == "SCS" else {}
    try:
        problem.solve(solver=solver, **more)
    except cp.error.SolverError:
        return float("nan")
    if problem.status in ("infeasible", "infeasible_inaccurate"):
        return float("-inf")
    return float(t.value) if problem.status == "optimal" else float("nan")


if __name__ == "__main__":
    print(json.dumps([answer(q, sys.argv[1]) for q in json.load(sys.stdin)]))
