"""Thousands of descents at once: Newton with an active set, on the set of closed states, in C (`c/descent.c`).

The metric is that of the stiffness, y = sqrt(k) phi, in which the elastic energy is half a squared distance and its
Hessian the identity: all curvature comes from closure and from the contacts that are held.  At each state

    G = rows' lam + R,      rows = closure and held gaps,      R = 0 on the free creases where it is stationary;

a fold limit whose R pulls, and a gap whose Lagrange multiplier does, leaves the active set; a step that reaches a
limit, a mirror or another facet stops there and adds it.  Steps are accepted by a sufficient decrease of the energy;
after a refused one the next is shorter, as in a trust region.  What comes out are candidates: polishing and judging
them is for others.  Without symmetry Newton's directions of many creases are swept by Riccati's recursion (J. C. Dunn
and D. P. Bertsekas, J. Optim. Theory Appl. 63, 1989).

Directions are rounded to `CHOSEN` and ties go to the first, so that a descent goes the same way on other processors,
but beside singular strata: states differ by what rounding leaves, and this does not grow from step to step.
"""

from __future__ import annotations

import ctypes
import math
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp import numerics, problem, starts as starting
from origami_nlp.minima import descent_rules
from origami_nlp.minima.descent_rules import (
    FIRST_REACH,
    LONG_CHAIN,
    MOST_ONE_BY_ONE,
    MOST_STEPS,
)
from origami_nlp.problem import OPEN, Model
from origami_nlp.starts import SLOTS, Closing, Ends, Samples, VertexCrossings, put

AT_ONCE = 512
"""Creases of the descents between two looks at the time, and at Ctrl-C."""
INTS = (
    "n m rays creases period first entries pairs walls stacks plane shifted laws limits many chain steps"
).split()
FLOATS = ["level"]
FLOAT_ARRAYS = (
    "flat factor onward mirror lever over stiffness rest load root metric low high across"
    " law_weight law_shift law_piece law_grid".split()
)
INT_ARRAYS = (
    "crease variable entry three before pair real gap wall stack law law_at law_cell".split()
)
OF_FLOATS = ["x", "kept_x", "reach"]
HELD = ("at_limit", "slots", "sides")
FLAGGED = ("escapes", "idle", "converged", "settled", "broken")
OF_INTS = [*HELD, *(f"kept_{name}" for name in HELD), "hold", *FLAGGED]
NAMES = {
    numerics: "CHOSEN CLOSURE_TOL CONTACT_TOL DECREASE EPS EXPLORED NONZERO OUTSIDE RANK ROUNDED"
    " SAME_ENERGY SINGULAR TINY",
    descent_rules: "CUT EARLY ESCAPE ESCAPES FLAT_SLOPE GROWTH LEAST_PIVOT NEAR NEXT NO_SLOPE REACH SADDLE"
    " SHORTEST STALLED STIFF",
    starting: "CLOSED NAMELESS POOR QUADRATIC SETTLING SLOTS STEPS",
}
"""Numbers that C takes from here."""


class VertexInC(ctypes.Structure):
    """What is the same for all samples."""

    _fields_ = [
        *((name, ctypes.c_int64) for name in INTS),
        *((name, ctypes.c_double) for name in FLOATS),
        *((name, ctypes.c_void_p) for name in (*FLOAT_ARRAYS, *INT_ARRAYS)),
    ]


class SamplesInC(ctypes.Structure):
    """Samples, and how far each has come."""

    _fields_ = [(name, ctypes.c_void_p) for name in (*OF_FLOATS, *OF_INTS)]


def source() -> str:
    """Return what is compiled: types and tolerances as they are here, and the files beside."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint", "stdlib", "string")]
    values: dict[str, float] = {"PI": math.pi, "OPEN": OPEN, "ROWS": 3 + SLOTS}
    for module, names in NAMES.items():
        values |= {name: getattr(module, name) for name in names.split()}
    for name, value in values.items():
        lines.append(f"#define {name} ({value if isinstance(value, int) else float(value).hex()})")
    fields = [("int64_t ", INTS), ("double ", FLOATS)]
    fields += [("const double *", FLOAT_ARRAYS), ("const int64_t *", INT_ARRAYS)]
    of_samples = [("double *", OF_FLOATS), ("int64_t *", OF_INTS)]
    for struct, parts in (("Vertex", fields), ("Samples", of_samples)):
        lines += ["typedef struct {", *(f"{c}{name};" for c, names in parts for name in names)]
        lines.append(f"}} {struct};")
    here, laws = Path(__file__).parent / "c", Path(problem.__file__).parent / "c" / "laws.h"
    files = here / "linear.h", here / "kinematics.h", laws, here / "closing.h", here / "newton.h"
    lines.append("#define Lawed Vertex")
    return "\n".join([*lines, *(f.read_text("utf-8") for f in (*files, here / "descent.c"))])


def compiled(say: Callable[[str], object] = lambda line: None) -> Any:
    """Return the compiled `descend`; None where there is no compiler, or it fails.

    Parameters
    ----------
    say
        Called with a line before something is compiled.
    """
    line = "descents are compiled, once on this machine (a second)"
    library = numerics.compiled("descent", source, lambda: say(line))
    if library is None:
        return None
    descend = library.descend
    descend.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64]
    descend.restype = ctypes.c_int64
    return descend


class Descents:
    """Descents of a model's energy on the set of its admissible states.

    Parameters
    ----------
    model
        The posed scene.
    until
        Time of `time.monotonic` after which none is begun.
    threads
        That share the samples; each has its own end, whoever makes it.

    Attributes
    ----------
    closing, crossings
        What brings states onto their strata, and what determines where they cross something.
    """

    def __init__(
        self,
        model: Model,
        until: float = math.inf,
        threads: int = 1,
    ) -> None:
        self.until, self._threads = until, threads
        self.model, self.closing, self.crossings = model, Closing(model), VertexCrossings(model)
        self._descend = None if model.parameters.dead is not None else compiled()
        if self._descend is None:
            return
        plain = model.equation_count == 3 and not model.structure.gaps
        values: dict[str, Any] = {
            "limits": model.has_limits,
            "many": plain and model.size > MOST_ONE_BY_ONE,
            "chain": plain and model.size >= LONG_CHAIN,
            "steps": MOST_STEPS,
            "across": model.root,
            "low": model.fold_limits.low,
            "high": model.fold_limits.high,
            **self.closing.kinematics.tables(),
            **self.crossings.tables(),
            **self.closing.tables(),
        }
        self._kept = {}  # what C points to
        for names, kind in ((FLOAT_ARRAYS, np.float64), (INT_ARRAYS, np.int64)):
            for name in names:
                self._kept[name] = np.ascontiguousarray(values[name], dtype=kind)
        numbers = {name: values[name] for name in FLOATS}
        numbers |= {name: int(values[name]) for name in INTS}
        self._vertex = VertexInC(**numbers, **{k: a.ctypes.data for k, a in self._kept.items()})

    @property
    def usable(self) -> bool:
        """Whether there is a compiler, and there are no forces in space."""
        return self._descend is not None

    def run(self, starts: Samples) -> Ends:
        """Descend from closed samples.

        The hold of a sample ends once its stratum is reached: contacts that pull are let go then.  A sample at which
        linear algebra breaks down ends where it started.
        """
        arrays = self._in_c(starts, self._vertex)
        at_limit, slots, sides, hold = (arrays[name] for name in (*HELD, "hold"))
        s = Samples(arrays["x"], at_limit, slots, sides, hold != 0, starts.source)
        converged, settled, broken = (arrays[name] != 0 for name in FLAGGED[2:])
        put(s, np.flatnonzero(broken), starts[broken])
        return Ends(s, converged & ~broken, settled & ~broken, broken)

    def _in_c(
        self,
        starts: Samples,
        vertex: VertexInC,
    ) -> dict[str, np.ndarray]:
        """Run C on copies of samples, which are returned."""
        k, x = len(starts), np.array(starts.x, order="C")
        held = {
            name: np.array(getattr(starts, name), dtype=np.int64, order="C")
            for name in (*HELD, "hold")
        }
        reach = np.full(k, FIRST_REACH)
        arrays = {"x": x, "reach": reach, **held}
        arrays["kept_x"] = np.empty_like(x)
        arrays |= {f"kept_{name}": np.empty_like(held[name]) for name in HELD}
        arrays |= {name: np.zeros(k, dtype=np.int64) for name in FLAGGED}
        state = SamplesInC(**{name: numerics.address(a) for name, a in arrays.items()})
        part, call = max(1, AT_ONCE // x.shape[1]), self._descend
        assert call is not None

        def descend(first: int) -> bool:
            late = time.monotonic() > self.until
            return late or call(
                ctypes.byref(vertex), ctypes.byref(state), first, min(first + part, k)
            )

        if self._threads == 1 or k <= part:
            made = all(map(descend, range(0, k, part)))
        else:  # C runs without the interpreter's lock
            with ThreadPoolExecutor(self._threads) as pool:
                made = all(pool.map(descend, range(0, k, part)))
        if not made:
            raise MemoryError("descents")
        return arrays
