"""What the oracle asks of the package, as plain numbers: this file alone may change when names of the package do.

Questions are read from standard input, a line of JSON each; radians, J, N m, and the enums of the package.
"""

from __future__ import annotations

import json
import math
import resource
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import origami_nlp as o
from origami_nlp import inverse_design, kkt
from origami_nlp.paper import cone
from origami_nlp.pattern import Scene, pattern_from_dict, scene_from_dict
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.symbolic import catalogue

Answer = dict[str, Any]


def origami(stated: Answer) -> Any:
    """What is folded: a scene as a table, or a pattern as plain data."""
    if "scene" in stated:
        return scene_from_dict(stated["scene"])
    return pattern_from_dict(stated["pattern"])


def search(q: Answer, **besides: Any) -> Any:
    """A search that does nothing besides but what is asked for; of a pattern its contact is asked for here."""
    folded = origami(q["stated"])
    if isinstance(folded, Scene):
        besides["full"] = False
    else:
        besides |= {"seconds": 600.0, **({"contact": q["contact"]} if "contact" in q else {})}
    asked = {"prove": False, "escape": False} | besides
    return o.find_minima(folded, seed=q.get("seed", 0), effort=q.get("effort", "normal"), **asked)


def listed(states: Any) -> list[list[Any]]:
    return [[float(s.energy), [float(a) for a in s.fold_angles]] for s in states]


def minima(q: Answer) -> Answer:
    """The minima that a search lists, what it cannot decide, and of each family starts and minima."""
    found = search(q)
    s, told = found.search, {k: listed(getattr(found, k)) for k in ("minima", "undecided")}
    return told | {"families": {f: [n, s.reached[f], s.alone[f]] for f, n in s.by_source.items()}}


def proof(q: Answer) -> Answer:
    """Whether the list of minima is proved complete, and the list."""
    found = search(q, prove=True)
    status = found.completeness.status if found.completeness else "not tried"
    return {"status": status, "minima": listed(found.minima)}


def judged(q: Answer) -> Answer:
    """What a state is: verdict, kind, eigenvalues; of each contact the facets that touch, its moment and the range."""
    folded = origami(q["stated"])
    problem = (
        pose(folded)
        if isinstance(folded, Scene)
        else PatternProblem(folded, q.get("contact", "") != "fold-limits")
    )
    state = kkt.State(problem, problem.reduce(np.array(q["angles"])))
    if not state.residual <= 1e-9 or np.abs(state.fold_angles - q["angles"]).max() > 1e-9:
        return {"verdict": "not closed"}
    what = kkt.classify(state)
    contacts = []
    for c in what.contacts:
        low, high = (float(x) if math.isfinite(x) else None for x in c.multiplier_range)
        contacts.append([c.type, list(c.creases), list(c.facets), float(c.multiplier), low, high])
    values = [float(v) for v in what.eigenvalues if math.isfinite(v)]
    answer = {"verdict": what.verdict, "kind": what.kind or "", "energy": float(state.energy)}
    return answer | {"eigenvalues": values, "contacts": contacts}


def escapes(q: Answer) -> Answer:
    """What it takes to leave each minimum: energy above it, and whether that is exact or a bound."""
    ways = [(m.energy, m.escape) for m in search(q, escape=True).minima]
    return {"passes": [[e, way and way.barrier, way and way.method] for e, way in ways]}


def barriers(q: Answer) -> Answer:
    """Passes between minima: energy and kind."""
    found = search(q)
    told = o.find_barriers(found.origami, found).to_dict()["passes"]
    return {"passes": [[p["energy"], p["pass_kind"]] for p in told]}


def events(q: Answer) -> Answer:
    """Where states appear, vanish, change or snap along a parameter, over two, or under a load: type, place."""
    folded, options = origami(q["stated"]), dict(q.get("options", {}))
    options.pop("confirm", None)  # a search beside each snap, off in all questions
    if q["along"] == "load":
        found: Any = o.load_path(folded, q["load"], **options)
    elif q["along"] == "boundary":
        curves = o.find_bifurcation_set(folded, *q["parameters"], **options).curves
        ends = ((c.type, c.points[k].t) for c in curves for k in (0, -1))
        return {"events": sorted([kind, *t] for kind, t in ends)}
    else:
        found = o.follow(folded, q["parameters"][0], **options)
    return {"events": sorted([e.type, float(e.t)] for e in found.events)}


def designed(q: Answer) -> Answer:
    """Springs that hold given states: whether they do, and how firmly."""
    made = o.design(inverse_design.parse_targets(q["targets"]))
    return {"verified": made.verified, "margin": made.margin}


def cones(q: Answer) -> Answer:
    """Counts of the states of a cone: degree, stiffness ratio, rest elevation."""
    return cone.count(*q["cone"]).to_dict()


def verified(q: Answer) -> Answer:
    """Verdicts on the statements of the paper."""
    results = catalogue.decide_all(catalogue.claims(), workers=1)
    return {r.claim.id: str(r.verdict.verdict) for r in results}


VERBS: dict[str, Callable[[Answer], Answer]] = {
    f.__name__: f
    for f in (minima, proof, judged, escapes, barriers, events, designed, cones, verified)
}


def main() -> None:
    for line in sys.stdin:
        q = json.loads(line)
        begin = time.process_time()
        try:
            answer = VERBS[q["verb"]](q)
        except Exception as error:  # a breakdown is an answer, by name
            answer = {"error": f"{type(error).__name__}: {error}"}
        answer["seconds"] = round(time.process_time() - begin, 4)
        answer["peak"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
