"""Each command of the installed package once, in a folder of its own: ``python .ci/smoke.py [--quick]`` anywhere.

``--floors`` prints the oldest stated dependencies, as requirements for pip.

Nothing of a checkout is used.  A command passes with exit code 0, words on standard output and the files that it is
asked for.  One that needs an extra which is not installed passes by ending with code 2 and naming that extra.
"""

import importlib.metadata
import importlib.util
import itertools
import os
import shlex
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

SCENE = """
[vertex]
sector_angles_deg = [70, 95, 108, 87]
[creases]
stiffness = [0.02, 0.02, 0.02, 0.02]
rest_angles_deg = [-60, 60, 60, 60]
[model]
contact = "fold-limits"
"""
SWEEP = """
[scene]
example = "degree6"
[[axes]]
set = "ratio"
from = 1
to = 2
count = 2
"""
QUICK = """
--version
--help
example degree6 --alpha pi/3 -o degree6.toml
example miura:2x2 -o miura.fold
inspect degree6.toml
inspect miura.fold -o vertices.json
minima miura:2x2 --contact fold-limits --certificate proof.json
check-proof proof.json
minima scene.toml --no-prove -o minima.json -o minima.png -o minima.fold -o minima.html
minima scene.toml --no-prove -o minima.glb
inspect miura:2x2 --path -o motion.json
design three-equal -o design.json
contacts scene.toml
load scene.toml --crease 1 --to 0.001 -o load.json
paper cone count --degree 6 --rest-elevation 0.3
"""
"""One a line; files that a command writes are read by those after it."""
SLOW = """
minima miura:2x2 --starts 1 -o pattern.json
follow scene.toml --parameter creases.stiffness[1]=0.02:0.021 -o follow.json
boundary scene.toml --parameter creases.stiffness[1]=0.01:0.02 --event creases.stiffness[2]=0.02:0.03 -o set.json
barriers scene.toml -o barriers.json
landscape degree6.toml --size 33 -o landscape.pdf
landscape degree6.toml --critical
landscape degree6.toml --space
sweep sweep.toml --folder swept
paper verify --only s2.loop-closure
paper cone count --full --degree 6 --rest-elevation 0.3
paper cone foldings --degree 6 -o cone.json
"""
"""Left out by ``--quick``."""
EXTRAS = {"design": "clarabel", "minima.glb": "trimesh"}
"""What a word in a command needs beside the core."""
WRITTEN = ("-o", "--certificate")
"""Options that are followed by a file."""


def passed(words: list[str], folder: Path) -> str:
    """Run a command; return what is wrong with how it ended, or nothing."""
    command = [sys.executable, "-m", "origami_nlp", *words]
    # no PYTHONPATH, and run elsewhere: no checkout is looked into
    kept = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONHOME")}
    done = subprocess.run(
        command, cwd=folder, env=kept, capture_output=True, text=True, encoding="utf-8"
    )
    lacking = [m for w, m in EXTRAS.items() if w in words and not importlib.util.find_spec(m)]
    if lacking:
        told = done.returncode == 2 and "pip install" in done.stderr and lacking[0] in done.stderr
        return "" if told else f"does not say that {lacking[0]} is missing: {done.stderr}"
    if done.returncode:
        return f"exit code {done.returncode}: {done.stderr[-2000:]}"
    files = [words[k + 1] for k, word in enumerate(words) if word in WRITTEN]
    missing = [name for name in files if not (folder / name).stat().st_size]
    if missing or not (done.stdout or files):
        return f"nothing was written: {missing or 'on standard output'}"
    return ""


def floors() -> list[str]:
    """Return the oldest stated dependencies of the core and of the extras that commands need, a requirement each."""
    project = tomllib.loads(Path("pyproject.toml").read_text())["project"]
    extras = (
        project["optional-dependencies"][name]
        for name in ("design", "graph", "mesh", "sweep", "dxf")
    )
    stated = itertools.chain(project["dependencies"], *extras)
    return sorted({one.replace(">=", "==") for one in stated})


def main() -> None:
    """Run all, and end with exit code 1 if one failed."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "scene.toml").write_text(SCENE)
        (folder / "sweep.toml").write_text(SWEEP)
        failed = 0
        for line in (QUICK if "--quick" in sys.argv else QUICK + SLOW).split("\n"):
            if not line:
                continue
            start = time.perf_counter()
            wrong = passed(shlex.split(line), folder)
            failed += bool(wrong)
            print(f"{time.perf_counter() - start:5.1f} s  {line}  {wrong}", flush=True)
    names = ("numpy", "scipy", "casadi", "matplotlib", "typer", "rich", "shapely", "cattrs")
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in names)
    print(f"Python {sys.version.split()[0]}, {versions}: {failed} failed")
    sys.exit(failed > 0)


if __name__ == "__main__":
    if "--floors" in sys.argv:
        print("\n".join(floors()))
    else:
        main()
