"""Answers on several kernels, side by side."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from tests.kernels.answers import RESIDUAL, SECONDS

KERNELS: dict[str, dict[str, str]] = {
    "Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "Prescott": {"OPENBLAS_CORETYPE": "Prescott"},
    "no AVX-512": {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": "X86_V4 AVX512_ICL"},
}
"""Kernels of OpenBLAS, and NumPy without its code for AVX-512: what the environment asks for."""
MEASURED = ("seconds", "iterations", "cost")
"""Not compared: time, and how often solvers iterated until rounding stopped them."""
SEARCHED = ("search", "hits")
"""How often descents ended where, and what they ended at that is no minimum: next to singular states rounding grows too
much for that to be the same always.  What was found, judged and proved is the rest: the answer."""
NEAR = 1e-6
"""Numbers that differ by no more, absolutely or relatively, are equal: half the digits of a double."""


@cache
def answers_on(kernel: str, group: str, part: str = ":") -> dict[str, dict[str, Any]]:
    """Ask a group of questions in a process of its own that runs on a kernel; the same are asked once."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "tests.kernels.answers", group, part],
        env={**environment, **KERNELS[kernel]},
        capture_output=True,
        text=True,
        check=True,
    )
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return {line["name"]: line for line in lines}


def differences(
    one: Any, other: Any, where: str = "", skip: tuple[str, ...] = MEASURED
) -> Iterator[str]:
    """Where two answers differ: words literally but for seconds and residuals, numbers beyond `NEAR`."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        for key in {**one, **other}:
            if key not in skip:
                yield from differences(one.get(key), other.get(key), f"{where}.{key}", skip)
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for k, (a, b) in enumerate(zip(one, other, strict=True)):
            yield from differences(a, b, f"{where}[{k}]", skip)
    elif isinstance(one, float) and isinstance(other, int | float):
        if not (one == other or math.isclose(one, other, rel_tol=NEAR, abs_tol=NEAR)):
            yield f"{where}: {one!r}, {other!r}"
    elif isinstance(one, str) and isinstance(other, str):
        a, b = (RESIDUAL.sub("#", SECONDS.sub("# s", text)) for text in (one, other))
        if a != b:
            yield f"{where}: {a!r}, {b!r}"
    elif one != other:
        yield f"{where}: {str(one)[:99]}, {str(other)[:99]}"


def compared(group: str, kernel: str, part: str = ":") -> tuple[int, list[str]]:
    """How many answers of a kernel there are, and where what was found, judged and proved is not that of the first."""
    first, found = (answers_on(one, group, part) for one in (next(iter(KERNELS)), kernel))
    assert list(found) == list(first)
    return len(found), [
        f"{name}: {line}"
        for name, answer in found.items()
        for line in differences(first[name]["data"], answer["data"], "data", MEASURED + SEARCHED)
    ]
