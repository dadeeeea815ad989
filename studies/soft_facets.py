"""Square twists whose facets bend: the limit of rigid facets, and from which stiffness and angle on they are bistable.

`python -m studies.soft_facets` writes what docs/results/soft_facets.md shows.  The twist has the pattern's own letters
(the square all valley: it does not fold rigidly).  Two branches of minima are followed over the bending stiffness K, by
descents from the last state: the open one, and the folded one, which at K = inf is folded flat.  Where both are
minima, apart from each other, and all creases fold as their letters say, the twist is bistable.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import origami_nlp as o
from origami_nlp.kkt import project
from origami_nlp.pattern import with_bending
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import descend, judge

REST = 120.0
"""Rest angles of all creases, to the side of their letters [deg]."""
ANGLES = (15, 20, 25, 30, 35)
"""At which pleats leave the square [deg]."""
STIFFEST, SOFTEST, FACTOR, HALVINGS = 1e4, 1e-2, 10**0.05, 6
"""Of diagonals per length, over creases per length; steps of K, and halvings of the last one."""
MOST_RAISED, RAISED = 10, 1.01
APART = 1e-3
"""States that differ by more [rad] are two."""
NEAR_FOLDED = 30
"""Angle [deg] at which the folded branch begins: at small K the twist folds to near its rest angles."""


class Twist(NamedTuple):
    """A minimum: fold angles [rad], the mean of the pattern's creases [deg], and whether all fold as their letters."""

    phi: np.ndarray
    mean: float
    own: bool
    problem: Any


def twist(alpha: float, stiffness: float, rest: float = REST) -> tuple[PatternProblem, np.ndarray]:
    """Return the problem of a twist that bends, facets free to cross, and the signs of its creases [12]."""
    sheet = o.examples.pattern("squaretwist", alpha=f"{alpha}*pi/180")
    sign = np.where(np.array(list(sheet.assignment)) == "V", 1.0, -1.0)
    sheet = sheet.with_springs(sheet.lengths.tolist(), (sign * math.radians(rest)).tolist())
    return PatternProblem(with_bending(sheet, stiffness), contact=False), sign


def settled(alpha: float, stiffness: float, begun: np.ndarray | float, rest: float = REST) -> Twist:
    """Descend from a state, or from all creases at an angle [rad], to a minimum."""
    problem, sign = twist(alpha, stiffness, rest)
    n = len(sign)
    if isinstance(begun, float):
        x = np.random.default_rng(0).normal(size=problem.size) * 0.02
        x[:n] += sign * begun
    else:
        x = begun
    closed, _ = project(problem, x, (), steps=60)
    phi = descend(problem, np.clip(closed, -np.pi, np.pi)).phi
    return Twist(
        phi, math.degrees(float((sign * phi[:n]).mean())), bool((sign * phi[:n] > 0).all()), problem
    )


def folded(rest: float = REST) -> dict[int, Twist]:
    """Return the folded states of stiff facets at all angles, each from the one beside it."""
    state = settled(NEAR_FOLDED, SOFTEST, 1.0, rest)
    for stiffness in np.geomspace(SOFTEST, STIFFEST, 61):
        state = settled(NEAR_FOLDED, float(stiffness), state.phi, rest)
    out = {NEAR_FOLDED: state}
    for step in (-1, 1):
        here = state
        alpha = NEAR_FOLDED + step
        while min(ANGLES) <= alpha <= max(ANGLES):
            here = out[alpha] = settled(alpha, STIFFEST, here.phi, rest)
            alpha += step
    return out


def bistable(folded_state: Twist, open_state: Twist) -> bool:
    """Whether both states keep the letters, and are two."""
    two = float(np.abs(folded_state.phi - open_state.phi).max()) > APART
    return folded_state.own and open_state.own and two


def softest_bistable(alpha: int, begun: Twist, rest: float = REST) -> dict[str, Any]:
    """Follow both branches from stiff facets to soft ones, and halve the step at which bistability ends."""
    closed, opened = begun, settled(alpha, STIFFEST, 0.3, rest)
    stiffness, last, seen = STIFFEST, None, []
    while stiffness >= SOFTEST:
        closed, opened = (settled(alpha, stiffness, s.phi, rest) for s in (closed, opened))
        seen.append((stiffness, closed.mean, opened.mean))
        if not bistable(closed, opened):
            break
        last = stiffness, closed, opened
        stiffness /= FACTOR
    if last is None:
        return {"alpha_deg": alpha, "critical": None, "branches": seen}
    low, (high, closed, opened) = stiffness, last
    for _ in range(HALVINGS):
        middle = math.sqrt(low * high)
        pair = [settled(alpha, middle, s.phi, rest) for s in (closed, opened)]
        if bistable(*pair):
            high, (closed, opened) = middle, pair
        else:
            low = middle
    # where a state all but ends a descent stops beside it: the first stiffness at which the kernel certifies both
    for _ in range(MOST_RAISED):
        judged = [judge(s.problem, s.phi) for s in (closed, opened)]
        apart = float(np.abs(judged[0].phi - judged[1].phi).max())
        if apart > APART and all(j.verdict == "minimum" for j in judged):
            break
        high *= RAISED
        closed, opened = (settled(alpha, high, s.phi, rest) for s in (closed, opened))
    else:
        return {"alpha_deg": alpha, "critical": None, "branches": seen}
    return {
        "alpha_deg": alpha,
        "critical": high,
        "folded_deg": closed.mean,
        "open_deg": opened.mean,
        "first_not": low,
        "branches": seen,
    }


def limit(alpha: int, begun: Twist, rest: float = REST) -> dict[str, list[float]]:
    """Return how far both states are from rigid ones (flat, and folded flat) over K, largest crease [rad]."""
    _, sign = twist(alpha, 1.0)
    n = len(sign)
    closed, opened = begun, settled(alpha, STIFFEST, 0.3, rest)
    out: dict[str, list[float]] = {"stiffness": [], "folded": [], "open": []}
    for stiffness in np.geomspace(STIFFEST, STIFFEST / 100, 9):
        closed, opened = (settled(alpha, float(stiffness), s.phi, rest) for s in (closed, opened))
        out["stiffness"].append(float(stiffness))
        out["folded"].append(float(np.abs(closed.phi[:n] - np.pi * sign).max()))
        out["open"].append(float(np.abs(opened.phi[:n]).max()))
    return out


def study(rest: float = REST) -> dict[str, Any]:
    """Return the curve of critical stiffness over angle, and the limit of rigid facets at one angle."""
    begun = folded(rest)
    rows = [softest_bistable(alpha, begun[alpha], rest) for alpha in ANGLES]
    return {"rest_deg": rest, "rows": rows, "limit": limit(NEAR_FOLDED, begun[NEAR_FOLDED], rest)}


def draw(found: dict[str, Any]) -> Any:
    """Draw the two branches at one angle, the critical stiffness over the angle, and the limit of rigid facets."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.5, 3.9), layout="constrained", dpi=110)
    left, middle, right = figure.subplots(1, 3)
    for row, colour in zip(found["rows"][::2], ("#1f4e9c", "#c1121f", "#2a7f3f"), strict=False):
        k, closed, opened = np.array(row["branches"]).T
        left.semilogx(k, closed, color=colour, label=f"{row['alpha_deg']} deg, folded")
        left.semilogx(k, opened, color=colour, ls="--", label=f"{row['alpha_deg']} deg, open")
    left.set_xlabel("bending stiffness / crease stiffness, per length")
    left.set_ylabel("mean fold angle [deg]")
    left.set_title("two branches of minima", fontsize=10)
    left.legend(fontsize=7)
    known = [r for r in found["rows"] if r["critical"]]
    alpha, critical = [r["alpha_deg"] for r in known], [r["critical"] for r in known]
    middle.semilogy(alpha, critical, "o-", color="#222222")
    middle.fill_between(alpha, critical, STIFFEST, color="#c8d5e8", label="bistable")
    middle.set_ylim(min(critical) / 3, STIFFEST)
    middle.set_xlabel("angle of the pleats to the square [deg]")
    middle.set_ylabel("bending stiffness / crease stiffness")
    middle.set_title(f"bistable from here on, rest angles {found['rest_deg']:g} deg", fontsize=10)
    middle.legend(fontsize=8)
    for name, colour in (("folded", "#1f4e9c"), ("open", "#c1121f")):
        right.loglog(
            found["limit"]["stiffness"], found["limit"][name], "o-", ms=3, color=colour, label=name
        )
    k = np.array(found["limit"]["stiffness"])
    right.loglog(k, found["limit"]["folded"][0] * k[0] / k, "k:", lw=1, label="slope -1")
    right.set_xlabel("bending stiffness / crease stiffness")
    right.set_ylabel("largest distance to the rigid state [rad]")
    right.set_title(f"limit of rigid facets, {NEAR_FOLDED} deg", fontsize=10)
    right.legend(fontsize=8)
    for axes in (left, middle, right):
        axes.tick_params(labelsize=8)
        axes.grid(True, lw=0.3, color="#dddddd")
    return figure


def main() -> None:
    """Run the study; write its numbers and its picture."""
    folder = Path(__file__).parent.parent / "docs" / "figures"
    found = study()
    for row in found["rows"]:
        print({k: v for k, v in row.items() if k != "branches"})
    both = found["limit"]
    for name in ("folded", "open"):
        slopes = np.diff(np.log(both[name])) / np.diff(np.log(both["stiffness"]))
        print(name, "slopes from stiff to soft", slopes.round(3).tolist())
    draw(found).savefig(folder / "soft_facets.png")


if __name__ == "__main__":
    main()
