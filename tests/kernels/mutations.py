"""Central lines of the kernel made wrong, one at a time, on a copy: which test of their rooms sees it, and how soon.

`python -m tests.kernels.mutations [FILE ...]` prints the table: of all of them, or of those in the files that are named
(`kkt/polishing.py`).
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
COPIED = "origami_nlp", "symbolic", "tests", "pyproject.toml"


@dataclass(frozen=True)
class Mutation:
    """A line of a file of the package, what stands there instead, and the folders of tests that must see it."""

    file: str
    right: str
    wrong: str
    tests: tuple[str, ...]

    @property
    def source(self) -> str:
        """The file with the wrong line."""
        text = (ROOT / "origami_nlp" / self.file).read_text()
        assert text.count(self.right) == 1, f"{self.file} has not this line once: {self.right}"
        return text.replace(self.right, self.wrong)


MUTATIONS = [
    Mutation(  # a crease on a mirror folds by half its angle in the wedge
        "problem/closure.py",
        "half = half / 2",
        "half = half / 1",
        ("problem",),
    ),
    Mutation(  # the gap is the sine of an angle
        "problem/gaps.py",
        "rays[k]) / sine",
        "rays[k]) * sine",
        ("problem", "kkt"),
    ),
    Mutation(  # the Hessian is positive definite, not only not negative
        "kkt/certificates.py",
        "if lowest > CURVED * scale:",
        "if lowest > -scale:",
        ("kkt",),
    ),
    Mutation(  # contacts push
        "kkt/multipliers.py",
        "np.abs(b @ np.maximum(mu, 0.0) - c)",
        "np.abs(b @ mu - c)",
        ("kkt",),
    ),
    Mutation(  # p + N z >= 0
        "kkt/multipliers.py",
        "nearest(np.zeros(kernel.shape[1]), kernel, -p)",
        "nearest(np.zeros(kernel.shape[1]), kernel, p)",
        ("kkt",),
    ),
    Mutation(  # Newton's matrix has the Hessian of the Lagrangian
        "kkt/polishing.py",
        "hessian = model.lagrangian_hessian(local.x, multipliers, rows)\n",
        "hessian = model.lagrangian_hessian(local.x, -multipliers, rows)\n",
        ("kkt",),
    ),
    Mutation(  # a lower state that is reached through facets refutes nothing
        "kkt/descent_witness.py",
        "        if model.refuses(y):\n",
        "        if False:\n",
        ("kkt", "facets"),
    ),
    Mutation(  # downhill
        "kkt/descent_witness.py",
        "falls = slope < -INDEPENDENT",
        "falls = slope > -INDEPENDENT",
        ("kkt",),
    ),
    Mutation(  # the two lines on which a form of rank two vanishes
        "kkt/tangent_cone.py",
        "(b * vectors[:, low[0]] + s * a * vectors[:, high[0]])",
        "(a * vectors[:, low[0]] + s * b * vectors[:, high[0]])",
        ("kkt",),
    ),
    Mutation(  # an arc is longer than its chord
        "continuation/tracer.py",
        "chord * (1 + 0.5",
        "chord * (1 - 0.5",
        ("continuation",),
    ),
    Mutation(  # at a fold one eigenvalue changes its sign, at a pitchfork none or two
        "continuation/events.py",
        "(a.index - b.index) % 2:",
        "not (a.index - b.index) % 2:",
        ("continuation",),
    ),
    Mutation(  # chords on the line of both planes are measured from one point
        "pattern_problem/crossings.py",
        "np.minimum(high_a, high_b + shift)",
        "np.minimum(high_a, high_b - shift)",
        ("pattern_problem",),
    ),
    Mutation(  # the length of the common normal changes as well
        "pattern_problem/contact_pairs.py",
        "tt / d - (both + both.T + volume * ss) / d**2",
        "tt / d + (both + both.T + volume * ss) / d**2",
        ("pattern_problem",),
    ),
]


def caught(mutation: Mutation) -> tuple[str, float]:
    """Return the first test that fails, "" for none, and the seconds until then; it passes with the right line."""
    with tempfile.TemporaryDirectory() as folder:
        for name in COPIED:
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy2
            copy(ROOT / name, Path(folder) / name)

        def failing(source: str, tests: list[str]) -> str:
            (Path(folder) / "origami_nlp" / mutation.file).write_text(source)
            done = subprocess.run(
                [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests],
                cwd=folder,
                env={**os.environ, "PYTHONPATH": folder},
                capture_output=True,
                text=True,
            )
            assert done.returncode in (0, 1), done.stdout + done.stderr  # they ran
            first = re.search(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", done.stdout, re.MULTILINE)
            return first[1] if first else ""

        begun = time.monotonic()
        test = failing(mutation.source, [f"tests/{room}" for room in mutation.tests])
        seconds = time.monotonic() - begun
        if test:
            right = (ROOT / "origami_nlp" / mutation.file).read_text()
            assert not failing(right, [test]), f"{test} fails whatever the line"
    return test, seconds


def main() -> None:
    asked = sys.argv[1:]
    for mutation in MUTATIONS:
        if not asked or mutation.file in asked:
            test, seconds = caught(mutation)
            print(f"{mutation.file}: {mutation.wrong.strip()}")
            print(f"    {seconds:5.1f} s  {test or 'SURVIVES'}", flush=True)


if __name__ == "__main__":
    main()
