"""The options of all commands, each stated once: what it is called, what its help says, what it refuses."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.arguments import check_number, check_whole
from origami_nlp.cli.group import WITHOUT_VALUE


def _seed(value: int) -> int:
    return check_whole("seed", value, 0)


def _max_starts(value: int) -> int:
    return check_whole("max_starts", value, 1)


def _workers(value: int) -> int:
    return check_whole("workers", value, 1)


def _prove(value: str | None) -> str | None:
    """Let what stands after --prove be a number of seconds, or nothing."""
    if value in (None, WITHOUT_VALUE):
        return value
    try:
        check_number("--prove", float(value), 0.0)
    except ValueError:
        check_number("--prove", value, 0.0)
    return value


def wanted_proof(value: str | None) -> bool | float | None:
    """Return what `find_minima` takes as `prove`."""
    if value is None or value == WITHOUT_VALUE:
        return None if value is None else True
    return float(value) or False


def _rest_angle(value: float | None) -> float | None:
    return None if value is None else check_number("--rest-angle", value, 0.0, 180.0)


# ---------------------------------------------------------------- what comes in

SceneFile = Annotated[
    str, typer.Argument(metavar="SCENE", help="Scene file (TOML), or - for stdin.")
]
SceneOrFold = Annotated[
    str,
    typer.Argument(metavar="SCENE", help="Scene file (TOML), FOLD file, or - for TOML on stdin."),
]
SceneOrPanels = Annotated[
    str | None,
    typer.Argument(
        metavar="[SCENE]", help="Scene file (TOML), or - for stdin; none: the paper's panels."
    ),
]
SceneUnlessPanels = Annotated[
    str | None,
    typer.Argument(
        metavar="SCENE", help="Scene file (TOML), or - for stdin; leave out with --panels."
    ),
]
FoldFile = Annotated[str, typer.Argument(metavar="FOLD", help="FOLD file, or - for stdin.")]
SweepFile = Annotated[str, typer.Argument(metavar="SWEEP", help="Sweep file (TOML).")]
Candidates = Annotated[
    str, typer.Argument(metavar="FILE", help="Candidates: .json or .csv, or - for JSON on stdin.")
]
ProofFile = Annotated[str, typer.Argument(metavar="FILE", help="Proof (JSON), or - for stdin.")]
Family = Annotated[str, typer.Argument(metavar="FAMILY", help="degree6 or degree8.")]

# ---------------------------------------------------------------- what goes out

JsonFile = Annotated[
    str | None, typer.Option("--json", metavar="FILE", help="Write JSON to FILE, or - for stdout.")
]
MarkdownFile = Annotated[
    str | None, typer.Option(metavar="FILE", help="Write Markdown to FILE, or - for stdout.")
]
FigureFile = Annotated[
    Path | None,
    typer.Option("--figure", metavar="FILE", help="Write a figure (.png, .pdf or .svg)."),
]
FigureWanted = Annotated[
    Path, typer.Option(metavar="FILE", help="Where to write it (.png, .pdf or .svg).")
]
HtmlFile = Annotated[
    Path | None,
    typer.Option(
        "--html",
        metavar="FILE",
        help="Write a page with states to turn and paths to fold along (extra view).",
    ),
]
AnimateFile = Annotated[
    Path | None,
    typer.Option(
        "--animate", metavar="FILE", help="Write the states in turn as .gif, or .mp4 with ffmpeg."
    ),
]
LatexFile = Annotated[
    str | None, typer.Option(metavar="FILE", help="Write LaTeX snippets to FILE, or - for stdout.")
]
CsvFile = Annotated[
    Path | None, typer.Option("--csv", metavar="FILE", help="Write the map as CSV.")
]
NpzFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Write grids, boundary and minima as NumPy .npz."),
]
StatesFold = Annotated[
    str | None, typer.Option("--fold", metavar="FILE", help="Write the states as a FOLD file.")
]
StatesMesh = Annotated[
    str | None,
    typer.Option(
        "--mesh", metavar="FILE", help="Write the states as .obj, .stl or .glb (extra mesh)."
    ),
]

# ---------------------------------------------------------------- how to search

Seed = Annotated[int, typer.Option(callback=_seed, help="Seed of the random starts.")]
MaxStarts = Annotated[int, typer.Option(callback=_max_starts, help="Cap on starts.")]
Prove = Annotated[
    str | None,
    typer.Option(
        metavar="[SECONDS]",
        callback=_prove,
        help="Prove that no minimum is missing, in at most SECONDS; without it: where it is cheap. 0: do not try.",
    ),
]
CertificateFile = Annotated[
    str | None,
    typer.Option(metavar="FILE", help="Write the proof, for check-proof."),
]
Effort = Annotated[
    str,
    typer.Option(
        metavar="quick|normal|thorough",
        help="Starts, and how often each minimum is to be reached before the search stops.",
    ),
]
Workers = Annotated[
    int,
    typer.Option(callback=_workers, help="Processes for the descents; the result is the same."),
]

# ---------------------------------------------------------------- FOLD files

FrameNumber = Annotated[
    int | None, typer.Option("--frame", help="Frame of a FOLD file, from 0; default: the first.")
]
VertexNumber = Annotated[
    int | None, typer.Option(help="FOLD file: the vertex, numbered from 0 as in the file.")
]
FoldSymmetry = Annotated[
    str | None, typer.Option(help="FOLD file: none, auto, C<n> or D<n> (default auto).")
]
FoldContact = Annotated[
    str | None, typer.Option(help="FOLD file: full, fold-limits or none (default full).")
]
FoldStiffness = Annotated[
    float | None,
    typer.Option(help="FOLD file: of creases without one [N m/rad] (default 1)."),
]
FoldRestAngle = Annotated[
    float | None,
    typer.Option(
        callback=_rest_angle,
        help="FOLD file: size for M and V creases without an angle [deg] (default 180).",
    ),
]
FoldRestAngles = Annotated[
    str | None,
    typer.Option(
        metavar="file|measured",
        help="FOLD file: a folded form rests at the angles that the file states, or at those it is folded at "
        "(default: file where it states them).",
    ),
]

# ---------------------------------------------------------------- cones

Degree = Annotated[int, typer.Option(help="Number N of creases: even, at least 6.")]
Ratio = Annotated[float, typer.Option(help="Stiffness ratio r_k = k_even/k_odd.")]
RestElevation = Annotated[
    str, typer.Option(help='Elevation nu_0 of the rest state, signed: 0.3 or "-pi/6".')
]
RestRule = Annotated[
    str,
    typer.Option(help="waterbomb: a state of the cone; paper: as printed in section 5."),
]
EndRule = Annotated[
    str,
    typer.Option(
        help="contract: branches with a steep flap end at pi/2 - 2 pi/N, where a single one touches nothing "
        "(cut); contact: a single steep flap goes on until it touches."
    ),
]
