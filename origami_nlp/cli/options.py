"""The options of all commands, each stated once: its name, what it is unless given, and what its help says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

WRITES = "FILE"
"""Metavar of every option that writes what a command found, and of no other option."""
FOLD_FILES = "Options for FOLD files, drawings and examples"
"""Heading of the options that say what a file leaves open."""


def _option(metavar: str | None, help: str, *names: str, usual: Any = None, **more: Any) -> Any:
    """Return an option; a metavar of words with bars between them is completed by these."""
    if metavar and metavar.islower() and "|" in metavar:
        words = metavar.split("|")
        more["autocompletion"] = lambda: words
    return typer.Option(usual, *names, metavar=metavar, help=help, **more)


def _flag(help: str, *names: str, usual: bool | None = False, **more: Any) -> Any:
    return typer.Option(usual, *names, help=help, show_default=False, **more)


def _argument(metavar: str, help: str, **more: Any) -> Any:
    return typer.Argument(..., metavar=metavar, help=help, **more)


def output(help: str) -> Any:
    """Return the option that takes the files to write."""
    return _option(WRITES, help, "--output", "-o")


def _of_file(metavar: str, help: str) -> Any:
    return _option(metavar, help, rich_help_panel=FOLD_FILES)


def _file_flag(help: str, name: str) -> Any:
    return _flag(help, name, usual=None, rich_help_panel=FOLD_FILES)


def _claims() -> list[str]:
    from origami_nlp.symbolic.catalogue import claims

    return [claim.id for claim in claims()]


# ---------------------------------------------------------------- what comes in

_KINDS = "a vertex by its scene file (TOML); a pattern by its FOLD file or drawing; - for stdin"
ORIGAMI = _argument("ORIGAMI", f"What is folded: {_KINDS}; or an example by name, as miura:8x8.")
CHECKED = _argument("ORIGAMI", "FOLD file, drawing, - for stdin, or an example such as miura:8x8.")
SWEEP = _argument("SWEEP", "Sweep file (TOML).")
CANDIDATES = _argument("FILE", "Candidates (JSON).")
PROOF = _argument("FILE", "Proof (JSON), or - for stdin.")
FAMILY = _argument("FAMILY", "degree6 or degree8.", autocompletion=lambda: ["degree6", "degree8"])
EXAMPLE = _argument(
    "NAME",
    "miura, waterbomb, waterbombbase, birdbase, squaretwist, yoshimura, resch, degree6 or degree8; metasheet with "
    "-o FILE.fold; targets of a design: waitukaitis-five, six-states, three-equal, switch, flat-and-one.",
)
TARGETS = _argument("TARGETS", "What is asked for (TOML), - for stdin, or an example by name.")
DRAWING = _argument("SOURCE", "FOLD, SVG, .cp, .opx or DXF file, - for stdin, or an example.")
CONVERTED = _argument("OUT", "Its ending says what is written: .fold .svg .cp .dxf.")
_COLUMNS = "columns angle_deg (or _rad), torque_Nm (or _Nmm) and, if wanted, weight, as measured"
HINGE_DATA = _argument("DATA", f"Table of text, - for stdin: {_COLUMNS}; # begins a remark.")

# ---------------------------------------------------------------- what a file leaves open

FRAME = _of_file("N", "The frame, from 0 as in the file (default: the first that has geometry).")
VERTEX = _of_file("V", "One vertex by itself, numbered from 0 as in the file.")
SYMMETRY = _of_file("GROUP", "none, auto, C<n> or D<n> (default auto); also of a scene file.")
CONTACT = _of_file("full|fold-limits|none", "Which facets may not cross (default full).")
STIFFNESS = _of_file("K", "Stiffness where the file gives none [N m/rad] (default 1).")
PER_LENGTH = _file_flag("Stiffness is per length of crease [N/rad].", "--per-length")
REST_ANGLE = _of_file("DEG", "Size of rest angles where the file gives none [deg] (default 180).")
REST_FROM = _of_file("file|measured", "Where a folded form rests (default: as its file says).")
BEND = _of_file("K", "Facets bend about diagonals of stiffness K per length [N/rad].")
SNAP = _of_file("SHARE", "Move corners of a drawing by at most this share: sectors become exact.")
CELL = _file_flag("Of an example such as miura:1x1: a cell that repeats.", "--cell")
ROLLED = _of_file("N", "Of --cell: copies once round a tube, N or P,Q along both; 0: may curl.")

# ---------------------------------------------------------------- how to search

SEED = _option("N", "Seed of all that is drawn at random.", usual=0)
MAX_STARTS = _option("N", "Cap on random starts.")
STARTS = _option("N", "Random starts in a row without news that end the search, not --effort.")
SECONDS = _option("S", "Wall time after which the command ends with what it has (exit code 124).")
VERBOSE = _flag("Print certificates, residuals and the account of the search.", "--verbose", "-v")
EFFORT = _option("quick|normal|thorough", "How long the search goes on.", usual="normal")
METHOD = _option("batch|ipopt", "Compiled descents, or IPOPT on the same problem.", usual="batch")
FULL = _flag("Judge stability without the symmetry too, or not.", "--full/--no-full", usual=None)
NOISE = _option("DEG", "How many random errors of DEG degrees does each state survive?")
PROVE = _flag(
    "Prove that none is missing, or not (default: where it is cheap).",
    "--prove/--no-prove",
    usual=None,
)
CERTIFICATE = _option(WRITES, "Write the proof, for check-proof.")
WORKERS = _option("N", "Processes (default: one a processor); the result does not depend on them.")
DASK = _option("ADDRESS", "Run on an existing Dask cluster (extra sweep).")
_GRID, _DIR = ("N", "Grid points along a coordinate."), ("DIR", "Folder of results, made if new.")
SIZE, PHASE_SIZE = (_option(*_GRID, "--size", usual=many) for many in (401, 200))
FOLDER, DEMO_FOLDER = (_option(*_DIR, "--folder", usual=u) for u in (..., Path("origami_demo")))
STATE = _option("K", "Number of the minimum: the one that is loaded, or reported alone.")
PATH = _flag("Trace the folding motion of the sheet up to the first contact.", "--path")

# ---------------------------------------------------------------- parameters and loads

_NAMES = "ratio, alpha, stiffness[1], rest_angles[1], sector_angles[1]; of a pattern vertices.x[5]"
_VARIES = f"The parameter that varies: {_NAMES} too; angles as 0.5, pi/6 or 30deg."
PARAMETER = _option("NAME=FROM:TO", _VARIES, usual=...)
EVENT = _option("NAME=FROM:TO", "Where events are looked for.", usual=...)
CHECKS = _option("N", "Searches: both ends, the middle, then the widest gaps.", usual=3)
LINES = _option("N", "Values of the second at which the first is followed.", usual=3)
CREASE = _option("K", "Torque on crease K, from 1, and its images; of a pattern repeatable.")
PULL = _option("V W", "Of a pattern: forces that pull vertices V and W apart, numbered from 0.")
FORCE = _option("V X Y Z", "Of a pattern: a force (X, Y, Z) on V, seen from --fixed-facet.")
FIXED_FACET = _option("F", "Of --force: the facet that stays, from 1 (default 1).", "--fixed-facet")
TO = _option("LOAD|snap", "Where it ends: N m, N or a factor; snap: either way.", usual="snap")
UNLOAD = _flag("Take the load back to 0 afterwards.", "--unload")
YIELDS = _option("T|K=T", "Torque at which creases yield [N m]; repeatable.", "--yield")
SEGMENTS = _flag("Also follow the contact boundaries (metastability).", "--segments")
SPACE = _flag("In place of the map: components, holes and pinch points of the space.", "--space")
CRITICAL = _flag("In place of the map: critical points and the Morse identity.", "--critical")

# ---------------------------------------------------------------- files that are checked, converted, made

CHECKED_FRAME = _option("N", "Frame that is checked, from 0 (default: all).", "--frame")
TOLERANCE = _option("SHARE", "By how much places are off, of the sheet (default: their digits).")
ORDERS = _flag("Count the layer orders of one ORIGAMI; -o FILE.fold lists them.", "--orders")
COLOUR = _option("KEY=LETTER", "What a colour or layer is: M, V, B, C, U, F, or - for nothing.")
CURVES = _option("refuse|leave", "Leave curves out.", usual="refuse")
PART = _option("K", "One of several sheets, from 1, the largest first.")
LONGEST = _option("MM", "Millimetres of the longest side.", "--longest")
ALPHA = _option("ANGLE", 'Sector angle alpha [rad], a number or e.g. "pi/4".')

# ---------------------------------------------------------------- cones

_RATIO = "Stiffness ratio r_k: k_m/k_v, of mountain to valley creases; of a cone k_even/k_odd."
RATIO = _option("R", _RATIO, usual=1.0)
RATIO_WANTED = _option("R", _RATIO, "--ratio")
DEGREE = _option("N", "Number N of creases: even, at least 6.", usual=...)
REST_ELEVATION = _option("ANGLE", 'Elevation nu_0 at rest [rad]: 0.3 or "-pi/6".', usual=...)
REST_RULE = _option("waterbomb|paper", "What the cone rests in.", usual="waterbomb")
END_RULE = _option("contract|contact", "Where a steep flap ends.", usual="contract")
CLAIM = _option("ID", "Decide this claim only (repeatable).", "--only", autocompletion=_claims)
