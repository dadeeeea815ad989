"""The options of all commands, each stated once: what it is called, what its help says, what it refuses."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from origami_nlp.arguments import check_number, check_whole, shown
from origami_nlp.cli.group import FOLD_FILES, WITHOUT_VALUE, WRITES
from origami_nlp.errors import OptionError


def _one_of(*words: str) -> dict[str, Any]:
    """Return how an option with a few words is shown and completed."""
    return {"metavar": "|".join(words), "autocompletion": lambda: list(words)}


def _checked(check: Callable[..., Any], *bounds: Any) -> dict[str, Any]:
    """Return how an option is checked where it is given: by a name for messages, and bounds."""
    name, *within = bounds
    return {"callback": lambda value: None if value is None else check(name, value, *within)}


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


def _rest_angle(value: str | None) -> str | None:
    """Let a size in degrees stand after --rest-angle; what stands after --rest-from is a word."""
    if value is None:
        return None
    try:
        check_number("--rest-angle", float(value), 0.0, 180.0)
    except ValueError:
        raise OptionError(
            f"--rest-angle = {shown(value)} must be a number from 0 to 180 [deg], the size for creases without an "
            "angle; whether a folded form rests as the file says or as measured is --rest-from file|measured"
        ) from None
    return value


def extended(
    run: Callable[..., None],
    command: Callable[..., Any],
    more: Mapping[str, tuple[Any, Any]],
    last: bool = False,
    **kinds: Any,
) -> Callable[..., None]:
    """Give what runs a command its parameters, and more options: annotation of each, and what it is unless given.

    last: these stay behind all that are added later.  kinds: annotations in place of stated ones.
    """
    stated = inspect.signature(command, eval_str=True)
    kind = inspect.Parameter.KEYWORD_ONLY if last else inspect.Parameter.POSITIONAL_OR_KEYWORD
    own = [
        p.replace(annotation=kinds.get(p.name, p.annotation))
        for p in stated.parameters.values()
        if p.kind is not inspect.Parameter.VAR_KEYWORD and p.name not in more
    ]
    at = len(own) if last else sum(p.kind is not inspect.Parameter.KEYWORD_ONLY for p in own)
    new = [
        inspect.Parameter(name, kind, default=usual, annotation=what)
        for name, (what, usual) in more.items()
    ]
    run.__signature__ = stated.replace(parameters=[*own[:at], *new, *own[at:]])  # type: ignore[attr-defined]
    return run


# ---------------------------------------------------------------- what comes in

SceneFile = Annotated[
    str,
    typer.Argument(metavar="SCENE", help="Scene file (TOML), FOLD file, or - for either on stdin."),
]
ORIGAMI = (
    "What is folded: a vertex by its scene file (TOML), a pattern by its FOLD file, - for either on stdin, or an "
    "example by name, such as miura:8x8"
)
OrigamiFile = Annotated[str, typer.Argument(metavar="ORIGAMI", help=f"{ORIGAMI}.")]
PANELS = "panels for the paper's 18 scenes"
OrigamiOrPanels = Annotated[str, typer.Argument(metavar="ORIGAMI", help=f"{ORIGAMI}; {PANELS}.")]
SceneOrPanels = Annotated[
    str,
    typer.Argument(
        metavar="SCENE", help=f"Scene file (TOML), FOLD file, - for either on stdin; {PANELS}."
    ),
]
PatternFile = Annotated[
    str,
    typer.Argument(
        metavar="PATTERN", help="FOLD file, - for stdin, or an example by name, such as miura:8x8."
    ),
]
SweepFile = Annotated[str, typer.Argument(metavar="SWEEP", help="Sweep file (TOML).")]
Candidates = Annotated[str, typer.Argument(metavar="FILE", help="Candidates (JSON).")]
ProofFile = Annotated[str, typer.Argument(metavar="FILE", help="Proof (JSON), or - for stdin.")]
Family = Annotated[
    str,
    typer.Argument(
        metavar="FAMILY", autocompletion=lambda: ["degree6", "degree8"], help="degree6 or degree8."
    ),
]

ExampleName = Annotated[
    str,
    typer.Argument(
        metavar="NAME",
        help="miura, waterbomb, waterbombbase, birdbase, squaretwist, yoshimura, resch, degree6 or degree8; metasheet "
        "with -o FILE.fold; targets of a design: waitukaitis-five, six-states, three-equal, switch, "
        "flat-and-one.",
    ),
]

# ---------------------------------------------------------------- what goes out


def output_files(help: str) -> Any:
    """Return the annotation of the option that takes the files to write."""
    return Annotated[list[str] | None, typer.Option("--output", "-o", metavar=WRITES, help=help)]


def place(file: str) -> str:
    """Return where a file goes: ``-`` for standard output, which ``-.fold`` is too, else the file."""
    return "-" if Path(file).name == file and Path(file).stem == "-" else file


# ---------------------------------------------------------------- how to search

Seed = Annotated[
    int,
    typer.Option(
        metavar="N", **_checked(check_whole, "seed", 0), help="Seed of all that is drawn at random."
    ),
]
MaxStarts = Annotated[
    int | None,
    typer.Option(
        metavar="N", **_checked(check_whole, "max_starts", 1), help="Cap on random starts."
    ),
]
Starts = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        **_checked(check_whole, "starts", 0),
        help="Of a pattern: random starts in a row that find nothing new, then the search ends (default: by --effort).",
    ),
]
Seconds = Annotated[
    float | None,
    typer.Option(
        metavar="S",
        **_checked(check_number, "--seconds", 0.0),
        help="Wall time after which the command ends with what it has, and says so.",
    ),
]
Verbose = Annotated[
    bool,
    typer.Option(
        "--verbose", "-v", help="Print certificates, residuals and the account of the search too."
    ),
]
Noise = Annotated[
    float | None,
    typer.Option(
        metavar="DEG",
        **_checked(check_number, "--noise", 0.0, 10.0),
        help="Say how many random errors of DEG degrees each state survives, of angles and stiffnesses.",
    ),
]
Prove = Annotated[
    str | None,
    typer.Option(
        metavar="[SECONDS]",
        callback=_prove,
        help="Prove that no minimum is missing, in at most SECONDS; without it: where it is cheap. 0: do not try.",
    ),
]
ProveChecks = Annotated[
    str | None,
    typer.Option(
        "--prove",
        metavar="[SECONDS]",
        callback=_prove,
        help="Prove at each check that no minimum is missing, in at most SECONDS.",
    ),
]
CertificateFile = Annotated[
    str | None, typer.Option(metavar="FILE", help="Write the proof (of a sheet, for check-proof).")
]
Effort = Annotated[
    str,
    typer.Option(
        **_one_of("quick", "normal", "thorough"),
        help="Starts, and how often each minimum is to be reached before the search stops.",
    ),
]
Method = Annotated[
    str,
    typer.Option(
        **_one_of("batch", "ipopt"),
        help="What goes down from starts: compiled descents, or IPOPT on the same problem, which is slower.",
    ),
]
FullOrNot = Annotated[
    bool | None,
    typer.Option(
        "--full/--no-full",
        help="Judge stability in the full space too, where the symmetry may break; or do not.",
        show_default=False,
    ),
]
_WORKERS = _checked(check_whole, "workers", 1)
Workers = Annotated[
    int | None,
    typer.Option(
        metavar="N", **_WORKERS, help="Processes; the result is the same with any number."
    ),
]
WorkersWanted = Annotated[
    int | None,
    typer.Option(
        "--workers",
        metavar="N",
        **_WORKERS,
        help="Processes; the result is the same with any number (default: one a processor).",
    ),
]
Size = Annotated[
    int, typer.Option("--size", metavar="N", help="Grid points along each coordinate.")
]
Rings = Annotated[
    int, typer.Option("--rings", metavar="N", help="Rings of the mesh around the flat state.")
]
Samples = Annotated[int, typer.Option("--samples", metavar="N", help="How many cases are sampled.")]
Quick = Annotated[bool, typer.Option("--quick", help="A first look: fewer cases, less time.")]
OutFolder = typer.Option("--folder", metavar="DIR", help="Folder for the results; made if new.")

StateNumber = Annotated[
    int | None, typer.Option(metavar="K", help="Only the minimum number K of the list.")
]
ParameterRange = Annotated[
    str,
    typer.Option(
        "--parameter",
        metavar="NAME=FROM:TO",
        help="The parameter that varies: ratio, alpha, creases.stiffness[1], creases.rest_angles[1] or "
        "vertex.sector_angles[1]; of a pattern mountains.stiffness or vertices.x[5] too; angles as 0.5, pi/6 or 30deg.",
    ),
]

# ---------------------------------------------------------------- FOLD files

_OF_FOLD: Any = {"rich_help_panel": FOLD_FILES}
FrameNumber = Annotated[
    int | None,
    typer.Option(
        "--frame",
        metavar="N",
        **_OF_FOLD,
        help="The frame, from 0 as in the file (default: the first with geometry).",
    ),
]
VertexNumber = Annotated[
    int | None,
    typer.Option(
        metavar="V", **_OF_FOLD, help="One vertex by itself, numbered from 0 as in the file."
    ),
]
FoldSymmetry = Annotated[
    str | None,
    typer.Option(
        metavar="GROUP",
        **_OF_FOLD,
        help="none, auto, C<n> or D<n> (default auto); in place of a scene file's own, too.",
    ),
]
FoldContact = Annotated[
    str | None,
    typer.Option(
        **_one_of("full", "fold-limits", "none"),
        **_OF_FOLD,
        help="full, fold-limits or none (default full).",
    ),
]
PerLength = Annotated[
    bool | None,
    typer.Option(
        "--per-length",
        **_OF_FOLD,
        help="Stiffness is per length [N/rad], times the length of the crease.",
        show_default=False,
    ),
]
Cell = Annotated[
    bool | None,
    typer.Option(
        "--cell",
        **_OF_FOLD,
        help="Of an example such as miura:1x1, so many rows and columns of what repeats in it: a cell that repeats.",
        show_default=False,
    ),
]
Rolled = Annotated[
    str | None,
    typer.Option(
        "--rolled",
        metavar="N",
        **_OF_FOLD,
        help="Of --cell: so many copies lead once round a closed tube, N along the first lattice vector, or P,Q along "
        "both; 0: copies may curl.",
        show_default=False,
    ),
]
Bend = Annotated[
    float | None,
    typer.Option(
        "--bend",
        metavar="K",
        **_OF_FOLD,
        help="Facets with more than three corners bend: their diagonals are creases of stiffness K per length "
        "[N/rad].",
    ),
]
Diagonal = Annotated[
    str | None,
    typer.Option(
        "--diagonal",
        **_one_of("short", "long", "both"),
        **_OF_FOLD,
        help="Which diagonals --bend takes; both: each facet bends about either (default short).",
    ),
]
FoldStiffness = Annotated[
    float | None,
    typer.Option(
        metavar="K",
        **_OF_FOLD,
        help="Stiffness of creases for which the file gives none [N m/rad] (default 1).",
    ),
]
FoldRestAngle = Annotated[
    str | None,
    typer.Option(
        metavar="DEG",
        callback=_rest_angle,
        **_OF_FOLD,
        help="Size of the rest angle of M and V creases for which the file gives no angle [deg] (default 180).",
    ),
]
FoldRestFrom = Annotated[
    str | None,
    typer.Option(
        **_one_of("file", "measured"),
        **_OF_FOLD,
        help="A folded form rests at the angles that the file states, or at those measured on it (default: file where "
        "it states them).",
    ),
]

# ---------------------------------------------------------------- cones

DEGREE = "Number N of creases: even, at least 6."
FLAPS = 'Valley and mountain flaps around the ring: "VVM", or "V2M".'
ELEVATION = 'Elevation nu of the folded cone [rad], up > 0 and down < 0: 0.3 or "-pi/6".'

Degree = Annotated[int, typer.Option(metavar="N", help=DEGREE)]
DegreeWanted = Annotated[int | None, typer.Option("--degree", metavar="N", help=DEGREE)]
RATIO = "Stiffness ratio r_k: k_m/k_v, of mountain to valley creases; of a cone k_even/k_odd."
Ratio = Annotated[float, typer.Option(metavar="R", help=RATIO)]
RatioWanted = Annotated[float | None, typer.Option("--ratio", metavar="R", help=RATIO)]
Flaps = Annotated[str, typer.Option(metavar="FLAPS", help=FLAPS)]
FlapsWanted = Annotated[str | None, typer.Option("--flaps", metavar="FLAPS", help=FLAPS)]
Elevation = Annotated[str, typer.Option(metavar="ANGLE", help=ELEVATION)]
Elevations = Annotated[
    list[str] | None, typer.Option("--elevation", metavar="ANGLE", help=ELEVATION)
]
RestElevation = Annotated[
    str,
    typer.Option(
        "--rest-elevation",
        metavar="ANGLE",
        help='Elevation nu_0 at rest [rad], up > 0 and down < 0: 0.3 or "-pi/6".',
    ),
]
Depth = Annotated[
    float,
    typer.Option(
        metavar="SHARE",
        help="Count minima deeper than this share of U_flat, the flat state's energy; 0 counts all.",
    ),
]
RestRule = Annotated[
    str,
    typer.Option(
        **_one_of("waterbomb", "paper"),
        help="waterbomb: a state of the cone; paper: as printed in section 5.",
    ),
]
EndRule = Annotated[
    str,
    typer.Option(
        **_one_of("contract", "contact"),
        help="contract: branches with a steep flap end at pi/2 - 2 pi/N, where a single one touches nothing "
        "(cut); contact: a single steep flap goes on until it touches.",
    ),
]
