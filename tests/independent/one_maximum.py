"""Check that the energy has one maximum at most on each branch of all vertices of degree four in a box of sectors.

Along a branch let p be the fold opposite to the leading crease, which it follows strictly, f = U'(p).  The spring of
that crease adds nothing to f''.  Those of the three others, at rest within 180 degrees, make f'' a mixture, with
weights >= 0, of the six functions g = (1/2 (phi_i -+ pi)^2)'''.  If there is a number gamma at each place for which

    g' + gamma g > 0  for all six,

then f''' > 0 wherever f'' = 0: f'' goes through 0 once at most, from - to +, so that f is concave, then convex,
and comes down through 0 once at most: one maximum.  At -p the same gamma, turned, does: half of a branch is looked at.

With u = theta from 0 (flat) to pi/2 (the leading crease at 180 degrees), as in docs/results/most_states.md with
exp(-u) = tan(theta/2):  tan(phi/2) = sin(theta)/(A + B cos(theta)), the leading crease A = 0, B^2 = 1 - q, the one
opposite A^2 = (1 - q)/q, B = 0; neighbours B = b, A = b tanh d and A = b/sqrt(q'), B = A tanh d,
b^2 = (1 - q')/(1 - tanh(d)^2).  Differences such as 1 - q are products of sines: no digits are lost.

What is looked at is this over positive factors common to all six, with G = p'^5 g as a polynomial in sines and cosines
(g is infinite at the limit): G' + gamma G > 0, from pi/2 - zone on with gamma = gamma_1 (pi/2 - theta), where the
left side is 0 at the limit for all six and its slope, towards the flat state, is shown to be positive.  The leading
crease at rest at its own limit is taken apart: 1/2 (pi - phi)^2 = 2 acos(z)^2, z = sin(p/2)/sqrt(q), a power series in
1 - z.  All of it in Taylor models, `one_maximum.c`.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

GRIDS = ((24, 16, 0.3), (24, 32, 0.2), (24, 32, 0.45), (24, 48, 0.3))
"""Cells of places, cells next to the limit, and where these begin: one of them is to do."""
FINEST = 0.004
"""Half width [rad] of the smallest cells."""
ALL = Fraction(360**3, 6) / 2 / 4
"""Volume [deg^3] of all vertices with sectors below 180 degrees, in the first, second and fourth; each once, of four
numberings the one in which creases 1 and 2 lead (the other three: its turns)."""
Box = tuple[int, int, int]
"""Of sectors 1, 2 and 4, how many widths each is at least."""


class NoCompiler(RuntimeError):
    """There is no C compiler."""


def compiled(name: str) -> Any:
    """Return the function of this name from the file in C of this name."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        raise NoCompiler
    folder = Path(tempfile.mkdtemp())
    # no multiplication is fused with a sum: the same numbers on all processors
    flags = ["-O3", "-march=native", "-std=c99", "-D_GNU_SOURCE", "-ffp-contract=off"]
    target, source = folder / f"{name}.so", Path(__file__).with_name(f"{name}.c")
    subprocess.run([compiler, *flags, "-shared", "-fPIC", "-o", target, source, "-lm"], check=True)
    found = getattr(ctypes.CDLL(str(target)), name)
    shutil.rmtree(folder, ignore_errors=True)
    return found


@cache
def _library() -> Any:
    found = compiled("one_maximum")
    real, whole = ctypes.c_double, ctypes.c_int
    found.argtypes = [ctypes.POINTER(real), real, whole, whole, whole, real, real]
    return found


def proves(box: Box, width: Fraction) -> bool:
    """Whether there is one maximum at most on both branches of all vertices in a box."""
    low = [Fraction(k) * width for k in box]
    third = 360 - sum(low) - 3 * width, 360 - sum(low)
    if min(*low, third[0]) <= 0 or max(*(a + width for a in low), third[1]) >= 180:
        return False
    first, second, fourth = (a + width / 2 for a in low)
    middle = [float(a) for a in (first, second, 360 - first - second - fourth, fourth)]
    return all(_one(middle, float(width / 2), branch) for branch in (0, 1))


def _one(middle: list[float], half: float, branch: int) -> bool:
    sectors = (ctypes.c_double * 4)(*middle)
    return any(_library()(sectors, half, branch, n, m, z, FINEST) for n, m, z in GRIDS)


def share(boxes: Iterable[Box], width: Fraction) -> Fraction:
    """Share of all vertices in boxes; those with the second sector below the fourth stand for their mirror images.

    A box that is proved is one of vertices numbered so that creases 1 and 2 lead: no turn of it is another.
    """
    some = set(boxes)
    assert all(second <= fourth for _, second, fourth in some)
    both = sum(1 if second == fourth else 2 for _, second, fourth in some)
    return both * width**3 / ALL
