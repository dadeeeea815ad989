"""Does a crease pattern fold flat: Kawasaki, Maekawa and layers at each vertex, then all layers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.numerics import INPUT_TOL
from origami_nlp.pattern import FoldVertex, fold_vertices, misses_of_noise
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.validity.counting import count_orders, flat_folded
from origami_nlp.validity.faults import KAWASAKI, MAEKAWA, Findings
from origami_nlp.validity.flat_fold import folds_flat

VERTEX = "layers round each vertex"
EXISTS = "layers have an order"


def check_flat_folding(f: Findings, problem: PatternProblem | None) -> None:
    """Check that a crease pattern folds flat; without a problem only round each vertex."""
    vertices = [w for v in fold_vertices(f.frame)[0] if (w := _folded(v)) is not None]
    undecided, unassigned, largest = [], 0, 0.0
    for v in vertices:
        where = [v.number]
        if v.kawasaki is None:
            if v.degree % 2:
                f.fault(KAWASAKI, f"vertex {v.number} has {v.degree} creases", vertices=where)
            else:
                undecided.append(v.number)
            continue
        largest = max(largest, miss := v.kawasaki)
        ends = f.frame.coords[f.frame.edges[np.isin(f.frame.numbers, v.edges)]]
        whole = misses_of_noise(f.frame, np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), 1.0)
        if f.tolerance is not None:
            v = replace(v, kawasaki_error=f.tolerance * whole)
        good = miss <= v.kawasaki_error
        if not good:
            needs = miss / whole
            differ = f"differ by {math.degrees(miss):.3g} degrees"
            drawn = f"a drawing that is off by {needs:.1e} of its size would explain it"
            text = f"alternate angles round vertex {v.number} {differ}; {drawn}"
            f.fault(KAWASAKI, text, miss, vertices=where)
        if v.maekawa is None:
            unassigned += 1
            continue
        if v.maekawa:
            mountains, valleys = v.assignment.count("M"), v.assignment.count("V")
            text = f"vertex {v.number} has {mountains} mountains and {valleys} valleys: they must differ by 2"
            f.fault(MAEKAWA, text, abs(v.maekawa), vertices=where)
        if good and not v.maekawa:
            folds = folds_flat(v)
            if folds is None:
                undecided.append(v.number)
            elif not folds:
                text = f"layers round vertex {v.number} ({v.assignment}) have no order"
                f.fault(VERTEX, text, vertices=where)
    many = f"{len(vertices)} interior vert{'ex' if len(vertices) == 1 else 'ices'}"
    some = f"{many}; {unassigned} not assigned in whole" if unassigned else many
    doubt = f"vertices {', '.join(map(str, undecided[:8]))} are not decided" if undecided else ""
    ok = f.settle(KAWASAKI, f"{many}, {_off(largest)}")
    ok &= f.settle(MAEKAWA, some)
    ok &= f.settle(VERTEX, some, doubt if problem is None else "")
    if not ok or problem is None:
        why = "not asked where a vertex does not fold flat, or there is no sheet"
        f.skip(EXISTS, why, problem is None)
        return
    phi, free = flat_folded(problem.pattern)
    found = count_orders(problem, phi, free, 0)
    if found.reason and found.decided:
        f.fault(EXISTS, found.reason, place=())
        f.settle(EXISTS)
    else:
        orders = f"{found.count_words} order{'' if found.count == 1 and found.whole else 's'}"
        f.settle(EXISTS, f"{orders} of {found.pairs:,} pairs of layers", found.reason)


def _off(largest: float) -> str:
    """Write by how much alternate angles differ; what rounding leaves is none."""
    if largest <= INPUT_TOL:
        return "exact to rounding"
    return f"off by up to {math.degrees(largest):.1e} degrees"


def _folded(v: FoldVertex) -> FoldVertex | None:
    """Return a vertex without its flat creases (F), between which facets are one; None where none is folded."""
    keep = [k for k, letter in enumerate(v.assignment) if letter != "F"]
    if not keep or math.isnan(sum(v.sector_angles)):
        return None
    if len(keep) == v.degree:
        return v
    ahead = np.roll(np.array(v.sector_angles), -keep[0])
    a = np.add.reduceat(ahead, [k - keep[0] for k in keep])
    letters = "".join(v.assignment[k] for k in keep)
    whole = set(letters) <= {"M", "V"}
    return replace(
        v,
        edges=tuple(v.edges[k] for k in keep),
        sector_angles=tuple(a.tolist()),
        assignment=letters,
        kawasaki=None if len(keep) % 2 else abs(float(a[::2].sum() - a[1::2].sum())),
        maekawa=abs(letters.count("M") - letters.count("V")) - 2 if whole else None,
    )
