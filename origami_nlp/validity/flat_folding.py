"""Does a crease pattern fold flat: Kawasaki, Maekawa and layers at each vertex, then all layers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.numerics import INPUT_TOL
from origami_nlp.pattern import FoldVertex, fold_vertices, listed, merged_sectors, misses_of_noise
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
        if miss > v.kawasaki_error:
            differ = f"differ by {math.degrees(miss):.3g} degrees"
            drawn = f"a drawing that is off by {miss / whole:.1e} of its size would explain it"
            text = f"alternate angles round vertex {v.number} {differ}; {drawn}"
            f.fault(KAWASAKI, text, miss, vertices=where)
        unassigned += v.maekawa is None
        if v.maekawa:
            many = f"{v.assignment.count('M')} mountains and {v.assignment.count('V')} valleys"
            text = f"vertex {v.number} has {many}: they must differ by 2"
            f.fault(MAEKAWA, text, abs(v.maekawa), vertices=where)
        elif v.maekawa == 0 and miss <= v.kawasaki_error and not (folds := folds_flat(v)):
            undecided += [v.number] * (folds is None)
            if folds is not None:
                text = f"layers round vertex {v.number} ({v.assignment}) have no order"
                f.fault(VERTEX, text, vertices=where)
    many = f"{len(vertices)} interior vert{'ex' if len(vertices) == 1 else 'ices'}"
    some = f"{many}; {unassigned} not assigned in whole" if unassigned else many
    doubt = f"vertices {listed(undecided)} are not decided" if undecided else ""
    off = f"off by up to {math.degrees(largest):.1e} degrees"
    ok = f.settle(KAWASAKI, f"{many}, {'exact to rounding' if largest <= INPUT_TOL else off}")
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


def _folded(v: FoldVertex) -> FoldVertex | None:
    """Return a vertex without its flat creases (F), between which facets are one; None where none is folded."""
    keep = [k for k, letter in enumerate(v.assignment) if letter != "F"]
    if not keep or math.isnan(sum(v.sector_angles)):
        return None
    sectors = merged_sectors(np.array(v.sector_angles), keep)
    edges, letters = tuple(v.edges[k] for k in keep), "".join(v.assignment[k] for k in keep)
    return replace(v, edges=edges, sector_angles=tuple(sectors.tolist()), assignment=letters)
