"""Answers on several kernels, side by side.

`python -m tests.kernels.compare [GROUP ...]` prints the table.
"""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from tests.kernels.answers import GROUPS, RESIDUAL, SECONDS

KERNELS: dict[str, dict[str, str]] = {
    "Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "SkylakeX": {"OPENBLAS_CORETYPE": "SkylakeX"},
    "Prescott": {"OPENBLAS_CORETYPE": "Prescott"},
    "Zen": {"OPENBLAS_CORETYPE": "Zen"},
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


@dataclass(frozen=True)
class Compared:
    """Questions of a group, how many answers of a kernel are those of the first, and how the others differ.

    answers: in what was found, judged and proved.  printed, data: in every word that is printed, in all data.
    wrong, differing: question and place of what differs, of answers and of all.
    """

    group: str
    kernel: str
    questions: int
    answers: int
    printed: int
    data: int
    seconds: float
    wrong: tuple[tuple[str, str], ...]
    differing: tuple[tuple[str, str], ...]


def compared(group: str, kernels: Sequence[str], part: str = ":") -> Iterator[Compared]:
    """Compare the answers on each kernel with those on the first."""
    first: dict[str, dict[str, Any]] = {}
    for kernel in kernels:
        found = answers_on(kernel, group, part)
        first = first or found
        answers, printed, data = 0, 0, 0
        wrong: list[tuple[str, str]] = []
        differing: list[tuple[str, str]] = []
        for name, answer in found.items():
            one, other = first[name]["data"], answer["data"]
            core = list(differences(one, other, "data", MEASURED + SEARCHED))
            lines = list(differences(first[name]["printed"], answer["printed"], "printed"))
            items = list(differences(one, other, "data"))
            answers, printed, data = answers + (not core), printed + (not lines), data + (not items)
            wrong += [(name, line) for line in core]
            differing += [(name, line) for line in lines + items]
        spent = sum(answer["seconds"] for answer in found.values())
        assert list(found) == list(first)
        counts = len(found), answers, printed, data
        yield Compared(group, kernel, *counts, spent, tuple(wrong), tuple(differing))


def main() -> None:
    groups = [word for word in sys.argv[1:] if not word.startswith("-")] or list(GROUPS)
    heads = ("questions", "answers", "printed", "data", "seconds")
    print(f"{'group':14}{'kernel':12}" + "".join(f"{head:>10}" for head in heads))
    reported = []
    for group in groups:
        for c in compared(group, list(KERNELS)):
            counts = "".join(f"{n:10}" for n in (c.questions, c.answers, c.printed, c.data))
            print(f"{c.group:14}{c.kernel:12}{counts}{c.seconds:10.1f}", flush=True)
            reported += [f"{c.kernel}: {name}: {line}" for name, line in c.differing]
    print(*(re.sub(r"\s+", " ", line)[:400] for line in reported), sep="\n")


if __name__ == "__main__":
    main()
