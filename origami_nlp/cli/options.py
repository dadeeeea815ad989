"""The options of all commands, each stated once: its name, what it is unless given, and what its help says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from origami_nlp.arguments import check_number
from origami_nlp.io import is_number

WRITES = "FILE"
"""Metavar of every option that writes what a command found, and of no other option."""
FOLD_FILES = "Options for FOLD files, drawings and examples"
"""Heading of the options that say what a file leaves open."""
ASKED = "asked"
"""What an option whose value may be left out gets then."""
MAY_LACK_VALUE = ("--prove",)
"""Options whose value, a number, may be left out."""


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


def _of_file(metavar: str, help: str, *names: str) -> Any:
    return _option(metavar, help, *names, rich_help_panel=FOLD_FILES)


def _prove(value: str | None) -> str | None:
    """Let what stands after --prove be a number of seconds, or nothing."""
    if value is not None and value != ASKED:
        check_number("--prove", float(value) if is_number(value) else value, 0.0)
    return value


def wanted_proof(value: str | None) -> bool | float | None:
    """Return what `find_minima` takes as `prove`."""
    if value is None or value == ASKED:
        return None if value is None else True
    return float(value) or False


def _claims() -> list[str]:
    from origami_nlp.symbolic.catalogue import claims

    return [claim.id for claim in claims()]


# ---------------------------------------------------------------- what comes in

ORIGAMI = _argument(
    "ORIGAMI",
    "What is folded: a vertex by its scene file (TOML); a pattern by its FOLD file or drawing (SVG, .cp, .opx, DXF); "
    "- for either on stdin; or an example by name, such as miura:8x8.",
)
FILES = _argument("ORIGAMI...", "FOLD files, drawings, - for stdin, or examples such as miura:8x8.")
SWEEP = _argument("SWEEP", "Sweep file (TOML).")
CANDIDATES = _argument("FILE", "Candidates (JSON).")
PROOF = _argument("FILE", "Proof (JSON), or - for stdin.")
FAMILY = _argument("FAMILY", "degree6 or degree8.", autocompletion=lambda: ["degree6", "degree8"])
EXAMPLE = _argument(
    "NAME",
    "miura, waterbomb, waterbombbase, birdbase, squaretwist, yoshimura, resch, degree6 or degree8; metasheet with "
    "-o FILE.fold; targets of a design: waitukaitis-five, six-states, three-equal, switch, flat-and-one.",
)
TARGETS = _argument(
    "TARGETS",
    "What is asked for (TOML), - for stdin, or an example by name: waitukaitis-five, six-states, three-equal, switch "
    "or flat-and-one (example NAME prints its file).",
)
DRAWING = _argument("SOURCE", "FOLD, SVG, .cp, .opx or DXF file, - for stdin, or an example.")
CONVERTED = _argument("OUT", "Its ending says what is written: .fold .svg .cp .dxf.")
HINGE_DATA = _argument(
    "DATA",
    "Table of text, - for stdin: columns angle_deg (or angle_rad), torque_Nm (or torque_Nmm) and, if wanted, weight, "
    "in the order of the measurement; # begins a remark.",
)

# ---------------------------------------------------------------- what a file leaves open

FRAME = _of_file(
    "N", "The frame, from 0 as in the file (default: the first with geometry).", "--frame"
)
VERTEX = _of_file("V", "One vertex by itself, numbered from 0 as in the file.")
SYMMETRY = _of_file(
    "GROUP", "none, auto, C<n> or D<n> (default auto); in place of a scene file's own, too."
)
CONTACT = _of_file("full|fold-limits|none", "Which facets may not cross (default full).")
STIFFNESS = _of_file(
    "K", "Stiffness of creases for which the file gives none [N m/rad] (default 1)."
)
PER_LENGTH = _flag(
    "Stiffness is per length [N/rad], times the length of the crease.",
    "--per-length",
    usual=None,
    rich_help_panel=FOLD_FILES,
)
REST_ANGLE = _of_file(
    "DEG",
    "Size of the rest angle of M and V creases for which the file gives no angle [deg] (default 180).",
)
REST_FROM = _of_file(
    "file|measured",
    "A folded form rests at the angles that the file states, or at those measured on it (default: file where it "
    "states them).",
)
BEND = _of_file(
    "K",
    "Facets with more than three corners bend: their diagonals are creases of stiffness K per length [N/rad].",
)
DIAGONAL = _of_file(
    "short|long|both",
    "Which diagonals --bend takes; both: each facet bends about either (default short).",
)
SNAP = _of_file(
    "SHARE",
    "Move corners of a drawing by at most this share of the sheet, by as little as it takes, so that sectors that are "
    "equal, in a line or fold flat within it do so exactly (off unless given).",
)
CELL = _flag(
    "Of an example such as miura:1x1, so many rows and columns of what repeats in it: a cell that repeats.",
    "--cell",
    usual=None,
    rich_help_panel=FOLD_FILES,
)
ROLLED = _of_file(
    "N",
    "Of --cell: so many copies lead once round a closed tube, N along the first lattice vector, or P,Q along both; "
    "0: copies may curl.",
)

# ---------------------------------------------------------------- how to search

SEED = _option("N", "Seed of all that is drawn at random.", usual=0)
MAX_STARTS = _option("N", "Cap on random starts.")
STARTS = _option(
    "N",
    "Random starts in a row that find nothing new, then the search ends (default: by --effort).",
)
SECONDS = _option("S", "Wall time after which the command ends with what it has (exit code 124).")
VERBOSE = _flag(
    "Print certificates, residuals and the account of the search too.", "--verbose", "-v"
)
EFFORT = _option(
    "quick|normal|thorough",
    "How many random starts in a row find nothing new before the search stops.",
    usual="normal",
)
METHOD = _option(
    "batch|ipopt",
    "What goes down from starts: compiled descents, or IPOPT on the same problem, which is slower.",
    usual="batch",
)
FULL = _flag(
    "Judge stability in the full space too, where the symmetry may break; or do not.",
    "--full/--no-full",
    usual=None,
)
NOISE = _option(
    "DEG",
    "Say how many random errors of DEG degrees each state survives, of angles and stiffnesses.",
)
PROVE = _option(
    "[SECONDS]",
    "Prove that no minimum is missing, in at most SECONDS; without it: where it is cheap. 0: do not try. Of follow: "
    "at each check.",
    "--prove",
    callback=_prove,
)
CERTIFICATE = _option(WRITES, "Write the proof (of a sheet, for check-proof).")
WORKERS = _option(
    "N", "Processes; the result is the same with any number (one a processor unless given)."
)
SIZE = _option("N", "Grid points along each coordinate.", "--size", usual=401)
PHASE_SIZE = _option("N", "Grid points along each coordinate.", "--size", usual=200)
RINGS_OF_SAMPLES = _option("N", "Rings of the mesh around the flat state.", "--rings", usual=16)
RINGS = _option("N", "Rings of the mesh around the flat state.", "--rings", usual=64)
SAMPLES = _option("N", "How many cases are sampled.", usual=25)
FOLDER = _option("DIR", "Folder for the results; made if new.", "--folder", usual=...)
DEMO_FOLDER = _option(
    "DIR", "Folder for the results; made if new.", "--folder", usual=Path("origami_demo")
)
STATE = _option("K", "Number of the minimum: the one that is loaded, or reported alone.")
PATH = _flag("Trace the folding motion of the sheet up to the first contact.", "--path")

# ---------------------------------------------------------------- parameters and loads

PARAMETER = _option(
    "NAME=FROM:TO",
    "The parameter that varies: ratio, alpha, creases.stiffness[1], creases.rest_angles[1] or "
    "vertex.sector_angles[1]; of a pattern mountains.stiffness or vertices.x[5] too; angles as 0.5, pi/6 or 30deg.",
    "--parameter",
    usual=...,
)
EVENT = _option(
    "NAME=FROM:TO",
    "The parameter in whose range events are looked for; NAME=VALUE for those nearby.",
    usual=...,
)
CHECKS = _option("N", "Searches: both ends, the middle, then the widest gaps.", usual=3)
LINES = _option("N", "Values of the second at which the first is followed.", usual=3)
CREASE = _option(
    "K",
    "Torque on crease K, from 1; of a pattern, repeated: on each of them; of a vertex on its images too.",
)
EDGE = _option(
    "E",
    "Of a pattern, in place of --crease: torque on the crease that is edge E of the file, from 0; repeated: on each.",
)
PULL = _option(
    "V,W", "Of a pattern: forces that pull vertices V and W apart, numbered from 0 as in the file."
)
FORCE = _option(
    "V,X,Y,Z",
    "Of a pattern: a force along (X, Y, Z) on vertex V, as seen from the facet --fixed-facet.",
)
FIXED_FACET = _option(
    "F", "With --force: the facet that is fixed in space, from 1 (default 1).", "--fixed-facet"
)
TO = _option(
    "LOAD|snap",
    "Torque [N m], force [N] or factor at which the path ends, from 0; snap: both ways to the first snap.",
    usual="snap",
)
UNLOAD = _flag("Take the load back to 0 afterwards.", "--unload")
CONFIRM = _flag("Confirm each snap by a search beside it.", "--confirm/--no-confirm", usual=True)
YIELDS = _option(
    "T|K=T",
    "Torque [N m] at which creases yield, elastic below and perfectly plastic at it: T all, K=T crease K alone; "
    "repeated.",
    "--yield",
)
SEGMENTS = _flag("Also follow the contact boundaries (metastability).", "--segments")
PASSES = _flag("Find the passes between minima and draw the paths.", "--passes")
SPACE = _flag(
    "In place of the map: components, holes, pinch points and handles of the admissible states.",
    "--space",
)
CRITICAL = _flag(
    "In place of the map: minima, saddles and maxima, contacts included, and the Morse identity.",
    "--critical",
)
DASK = _option("ADDRESS", "Run on an existing Dask cluster (extra sweep).")

# ---------------------------------------------------------------- files that are checked, converted, made

CHECKED_FRAME = _option("N", "Frame that is checked, from 0 (default: all).", "--frame")
FLAT_FRAME = _option(
    "N",
    "Crease pattern that folded forms are compared with (default: the first that is numbered as they are).",
    "--flat-frame",
)
TOLERANCE = _option(
    "SHARE",
    "Share of the sheet by which places may be off: of a drawing, within which ends are joined (default: the smallest "
    "at which it is whole); of what is checked, by its digits (1e-6 to 1e-4; 1e-4 of a drawing).",
)
ORDERS = _flag(
    "Count the layer orders of one ORIGAMI instead, by components; -o FILE.fold lists them as frames.",
    "--orders",
)
MOST = _option("N", "Of --orders: how many are listed in files.", usual=100)
COLOUR = _option(
    "KEY=LETTER",
    "What a colour (#EE1032=M) or a layer of DXF is: M, V, B, C, U, F, or - to leave it out; repeatable.",
)
CURVES = _option(
    "refuse|leave|N", "Refuse curves, leave them out, or take N chords for each.", usual="refuse"
)
PART = _option("K", "One of several sheets, from 1, the largest first.")
SCALE = _option("MM", "Millimetres for one unit of the file.")
LONGEST = _option("MM", "Millimetres of the longest side.", "--longest")
FIT = _option(
    "spline|pchip",
    "Least squares, with knots by BIC; or through the points, averaged where there are many.",
    usual="spline",
)
ALPHA = _option(
    "ANGLE", 'The sector angle alpha [rad] of those that have one, a number or e.g. "pi/4".'
)
MOUNTAIN = _option("ANGLE", 'Rest angle of mountains [rad], e.g. "-pi/2".')
VALLEY = _option("ANGLE", 'Rest angle of valleys [rad], e.g. "pi/2".')

# ---------------------------------------------------------------- cones

_RATIO = "Stiffness ratio r_k: k_m/k_v, of mountain to valley creases; of a cone k_even/k_odd."
RATIO = _option("R", _RATIO, usual=1.0)
RATIO_WANTED = _option("R", _RATIO, "--ratio")
DEGREE = _option("N", "Number N of creases: even, at least 6.", usual=...)
FLAPS = _option("FLAPS", 'Valley and mountain flaps around the ring: "VVM", or "V2M".', usual=...)
ELEVATION = _option(
    "ANGLE",
    'Elevation nu of the folded cone [rad], up > 0 and down < 0: 0.3 or "-pi/6".',
    usual=...,
)
REST_ELEVATION = _option(
    "ANGLE",
    'Elevation nu_0 at rest [rad], up > 0 and down < 0: 0.3 or "-pi/6".',
    "--rest-elevation",
    usual=...,
)
DEPTH = _option(
    "SHARE",
    "Count minima deeper than this share of U_flat, the flat state's energy; 0 counts all.",
    usual=0.0,
)
REST_RULE = _option(
    "waterbomb|paper",
    "waterbomb: a state of the cone; paper: as printed in section 5.",
    usual="waterbomb",
)
END_RULE = _option(
    "contract|contact",
    "contract: branches with a steep flap end at pi/2 - 2 pi/N, where a single one touches nothing (cut); contact: a "
    "single steep flap goes on until it touches.",
    usual="contract",
)
LISTED = _flag("List them (up to degree 32; default: up to 16).", "--list/--no-list", usual=None)
CLAIM = _option("ID", "Decide this claim only (repeatable).", "--only", autocompletion=_claims)
WITHOUT_CONTACT = _flag("Do not count minima at the end of a branch.", "--without-contact")
