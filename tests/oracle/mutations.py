"""Central lines made wrong, one at a time, on a copy: does the oracle see it, and how soon.

`python -m tests.oracle.mutations [FILE ...]` prints the table: of all of them, or of those in the files that are named
(`kkt/polishing.py`).  What the oracle does not see of a line that is right is printed first: it must be nothing.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from tests.oracle.__main__ import FAULTS

ROOT = Path(__file__).parents[2]
COPIED = "origami_nlp", "symbolic", "tests", "pyproject.toml"
FEW = 12
"""Questions about sheets that are asked, spread over all: they take long."""


@dataclass(frozen=True)
class Mutation:
    """A line of a file of the package, what stands there instead, and the groups of questions that must see it."""

    file: str
    right: str
    wrong: str
    groups: tuple[str, ...]

    @property
    def source(self) -> str:
        """The file with the wrong line."""
        text = (ROOT / "origami_nlp" / self.file).read_text()
        assert text.count(self.right) == 1, f"{self.file} has not this line once: {self.right}"
        return text.replace(self.right, self.wrong)


MUTATIONS = [
    Mutation(  # torques of images under a symmetry add up
        "pattern_problem/orbits.py",
        "np.add.at(out, self.orbit, np.moveaxis(",
        "np.maximum.at(out, self.orbit, np.moveaxis(",
        ("panels",),
    ),
    Mutation(  # the Hessian is positive definite, not only not negative
        "kkt/certificates.py",
        "if lowest > CURVED * scale:",
        "if lowest > -scale:",
        ("states", "refused"),
    ),
    Mutation(  # contacts push
        "kkt/multipliers.py",
        "np.abs(b @ np.maximum(mu, 0.0) - c)",
        "np.abs(b @ mu - c)",
        ("states", "refused"),
    ),
    Mutation(  # p + N z >= 0
        "kkt/multipliers.py",
        "nearest(np.zeros(kernel.shape[1]), kernel, -p)",
        "nearest(np.zeros(kernel.shape[1]), kernel, p)",
        ("states", "refused"),
    ),
    Mutation(  # Newton's matrix has the Hessian of the Lagrangian
        "kkt/polishing.py",
        "hessian = model.lagrangian_hessian(local.x, multipliers, rows)\n",
        "hessian = model.lagrangian_hessian(local.x, -multipliers, rows)\n",
        ("panels", "random_vertices"),
    ),
    Mutation(  # the two lines on which a form of rank two vanishes
        "kkt/tangent_cone.py",
        "(b * vectors[:, low[0]] + s * a * vectors[:, high[0]])",
        "(a * vectors[:, low[0]] + s * b * vectors[:, high[0]])",
        ("states", "refused"),
    ),
    Mutation(  # at a fold one eigenvalue changes its sign, at a pitchfork none or two
        "continuation/events.py",
        "(a.index - b.index) % 2:",
        "not (a.index - b.index) % 2:",
        ("located",),
    ),
    Mutation(  # a crease at its limit opens against its side
        "problem/contact.py",
        "slopes[..., r, c.index] = -c.side",
        "slopes[..., r, c.index] = c.side",
        ("states",),
    ),
    Mutation(  # the sign of a crease says which facet is above
        "pattern_problem/stacks.py",
        "right = (self.phi[c] > 0) == (",
        "right = (self.phi[c] < 0) == (",
        ("states",),
    ),
    Mutation(  # second derivatives are symmetric
        "pattern_problem/closure.py",
        "bent = bent + bent.swapaxes(2, 3)",
        "bent = bent - bent.swapaxes(2, 3)",
        ("states",),
    ),
]


def differs(source: str, file: str, groups: tuple[str, ...]) -> Counter[str]:
    """What the oracle says of a copy with another text of one file, counted; states that are new alone do not count."""
    with tempfile.TemporaryDirectory() as folder:
        for name in COPIED:
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy2
            copy(ROOT / name, Path(folder) / name)
        (Path(folder) / "origami_nlp" / file).write_text(source)
        told = Path(folder) / "told"
        few = ["--sample", str(FEW)] if groups == ("sheets",) else []
        command = [sys.executable, "-m", "tests.oracle", *few, "--out", str(told), *groups]
        environment = {**os.environ, "PYTHONPATH": folder}
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
        assert done.returncode in (0, 1), done.stderr
        lines = [json.loads(line) for line in told.read_text().splitlines()]
        return Counter(t["what"] for t in lines if t["what"] != "new" and t["name"] not in FAULTS)


def main() -> None:
    asked = sys.argv[1:]
    chosen = [m for m in MUTATIONS if not asked or m.file in asked]
    every = tuple(sorted({g for m in chosen for g in m.groups}))
    right = (ROOT / "origami_nlp" / chosen[0].file).read_text()
    print(
        f"nothing wrong: {dict(differs(right, chosen[0].file, every)) or 'nothing differs'}",
        flush=True,
    )
    for mutation in chosen:
        begun = time.monotonic()
        seen = differs(mutation.source, mutation.file, mutation.groups)
        print(f"{mutation.file}: {mutation.wrong.strip()}")
        print(f"    {time.monotonic() - begun:5.1f} s  {dict(seen) or 'SURVIVES'}", flush=True)


if __name__ == "__main__":
    main()
