"""What a proof does with boxes in C (`c/`), compiled once by the compiler of the machine; without one NumPy does it."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from origami_nlp import numerics
from origami_nlp.proof.affine import TINY, UNIT

LANES = 64
"""Boxes that an operation is done for at once: their numbers stay in the processor's cache."""
CODES = "LOAD STORE KEEP ADD SUB MUL NEG ABS DIV ROOT MOST AT_MOST".split()
"""Operations of straight-line programs."""
EXACT = 1e-3
"""Least squares take no row to be more accurate than this, relative to its slopes: its square is what they miss by, and
one over that their condition."""


def _source() -> str:
    """Return what is compiled: numbers as they are here, and the files beside."""
    lines = [f"#include <{name}.h>" for name in ("math", "stdint", "string")]
    lines += [f"#define {name} {code}" for code, name in enumerate(CODES)]
    names = "CHOSEN DEPENDENT NONZERO ROUNDED".split()
    values = {name: getattr(numerics, name) for name in names}
    values |= {"EXACT": EXACT, "TINY": TINY, "UNIT": UNIT}
    lines += [f"#define {name} ({float(value).hex()})" for name, value in values.items()]
    lines.append(f"#define LANES {LANES}")
    files = ("straight_line.c", "contraction.c")
    return "\n".join(
        [*lines, *((Path(__file__).parent / "c" / f).read_text("utf-8") for f in files)]
    )


def library() -> Any:
    """Return the compiled functions; None where nothing can be compiled."""
    made = numerics.compiled("proof", _source)
    if made is not None and not made.contract.argtypes:
        whole, at, number = ctypes.c_int64, ctypes.c_void_p, ctypes.c_double
        made.run.argtypes = [whole, *[at] * 4, whole]
        made.nonzero.argtypes = [whole, whole, whole, at, at, at, number, at]
        made.contract.argtypes = [at] * 12
        for function in (made.run, made.nonzero, made.contract):
            function.restype = None
    return made
