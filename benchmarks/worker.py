"""A process that searches for minima with whatever checkout of the package PYTHONPATH names, one scene a line.

Run as a script, `python -P worker.py`, by `checkout`, so that it uses nothing but what every checkout has: a line of
JSON in (scene, seed, options), one out (processor seconds, minima, how many were known when).
"""

from __future__ import annotations

import inspect
import json
import os
import sys
import time
from typing import Any

from origami_nlp.minima import find_minima
from origami_nlp.pattern import scene_from_dict


def answer(asked: dict[str, Any]) -> dict[str, Any]:
    """Search once; options that this checkout does not know are left out, and named."""
    scene = scene_from_dict(asked["scene"])
    known = inspect.signature(find_minima).parameters
    # what is measured is the search
    wanted = {"prove": False, "escape": False, **asked["options"]}
    options = {k: v for k, v in wanted.items() if k in known}
    curve: list[tuple[float, int]] = []

    def progress(starts: int, found: int, *rest: object) -> None:
        if not curve or found != curve[-1][1]:
            curve.append((time.process_time() - begin, found))

    begin = time.process_time()
    result = find_minima(scene, seed=asked["seed"], progress=progress, **options)
    seconds = time.process_time() - begin
    curve.append((seconds, len(result.minima)))
    return {
        "seconds": seconds,
        "curve": curve,
        "left_out": sorted(set(asked["options"]) - set(options)),
        "minima": [
            {"fold_angles": m.fold_angles, "energy": m.energy, "kind": m.kind}
            for m in result.minima
        ],
        "residual": max(
            (r for m in result.minima for r in (m.closure_residual, m.kkt_residual) if r == r),
            default=0.0,  # of a search that found nothing
        ),
        "status": getattr(result.completeness, "status", ""),
    }


def main() -> None:
    """Answer until there are no more lines; what anything else prints goes to standard error."""
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for line in sys.stdin:
        out.write(json.dumps(answer(json.loads(line))) + "\n")
        out.flush()


if __name__ == "__main__":
    main()
