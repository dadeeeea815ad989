"""Commands that say more of states: `contacts`, `load`, `barriers`, `critical`, ..."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output, answers, writes
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search, search as search_minima
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import bounded, end_of, paused
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from origami_nlp.pattern import Pattern

Creases: TypeAlias = Annotated[
    list[int] | None,
    typer.Option(
        metavar="K",
        help="Torque on crease K, from 1; of a pattern, repeated: on each of them; of a vertex on its images too.",
    ),
]
Edges: TypeAlias = Annotated[
    list[int] | None,
    typer.Option(
        metavar="E",
        help="Of a pattern, in place of --crease: torque on the crease that is edge E of the file, from 0; repeated: "
        "on each of them.",
    ),
]
PullOf: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="V,W",
        help="Of a pattern: forces that pull vertices V and W apart, numbered from 0 as in the file.",
    ),
]
ForceOn: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="V,X,Y,Z",
        help="Of a pattern: a force along (X, Y, Z) on vertex V, as seen from the facet --fixed-facet.",
    ),
]
FixedFacet: TypeAlias = Annotated[
    int | None,
    typer.Option(
        "--fixed-facet",
        metavar="F",
        help="With --force: the facet that is fixed in space, from 1 (default 1).",
    ),
]
YieldAt: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        "--yield",
        metavar="T|K=T",
        help="Torque [N m] at which creases yield, elastic below and perfectly plastic at it: T all, K=T "
        "crease K alone; repeated.",
    ),
]


def torque_bounds(option: str, given: list[str] | None, creases: int) -> dict[int, float] | None:
    """Return the torques that an option says, by crease from 1; later ones count."""
    out: dict[int, float] = {}
    for text in given or ():
        crease, some, torque = text.rpartition("=")
        try:
            which = [int(crease)] if some else range(1, creases + 1)
            out |= dict.fromkeys(which, float(torque))
        except ValueError:
            raise OptionError(
                f"{option} = {text!r} must be a torque, or CREASE=TORQUE as in 2=0.01"
            ) from None
    return out or None


def load_number(text: str) -> float:
    """Return the load that ``--to`` says."""
    try:
        return float(text)
    except ValueError:
        raise OptionError(f"--to = {text!r} must be a load, or snap") from None


def work_of(
    sheet: Any, creases: list[int] | None, pull: list[float], force: list[float], fixed_facet: int
) -> Any:
    """Return what a load on a pattern works on, as options say it."""
    from origami_nlp.pattern_problem import DeadForce, Pull, Torque

    if creases:
        return Torque(sheet, tuple(creases))
    if pull:
        a, b = pull
        return Pull(sheet, (_whole("--pull", a), _whole("--pull", b)))
    v, x, y, z = force
    return DeadForce(sheet, _whole("--force", v), (x, y, z), fixed_facet)


def creases_of(pattern: Pattern, edges: list[int] | None) -> list[int]:
    """Return the numbers of creases, from 1, that are edges of the file, from 0."""
    from origami_nlp.pattern import listed

    number = {edge: crease for crease, edge in enumerate(pattern.numbers.tolist(), start=1)}
    for edge in edges or ():
        if edge not in number:
            raise OptionError(
                f"--edge = {edge} is no crease: the file has creases at edges {listed([*number])}"
            )
    return [number[edge] for edge in edges or ()]


def _numbers(option: str, text: str, count: int) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise OptionError(f"{option} = {text!r} must be {count} numbers with commas between them")
    return values


def _whole(option: str, value: float) -> int:
    if value != int(value):
        raise OptionError(f"{option}: vertex {value:g} must be a whole number, as in the file")
    return int(value)


SEARCHES = ("seed", "effort")
"""Options of the search whose minima are looked at."""


@bounded
@takes_scene(o.OrigamiFile, whole=True, springs=False)
@answers("json", "html", search=SEARCHES)
def contacts(
    scene: Source,
    state: o.StateNumber = None,
    segments: Annotated[
        bool, typer.Option("--segments", help="Also follow the contact boundaries (metastability).")
    ] = False,
    **options: Any,
) -> Any:
    """Report contact moments, stiffness along the contact and load margin of ORIGAMI's pinned states."""
    from origami_nlp.contact import find_contacts

    stated = scene.read_whole(contact=True)
    result = search(stated, scene.name, contact=scene.whole_contact, escape=False, **options)
    return find_contacts(result, state=state, segments=segments)


@takes_scene(o.OrigamiFile, whole=True)
@answers(
    "json",
    "csv",
    "figure",
    "html",
    "fold",
    "mesh",
    search=("full", "effort", "seed", "seconds"),
    details=True,
)
def load(
    scene: Source,
    crease: Creases = None,
    edge: Edges = None,
    pull: PullOf = None,
    force: ForceOn = None,
    fixed_facet: FixedFacet = None,
    to: Annotated[
        str,
        typer.Option(
            metavar="LOAD|snap",
            help="Torque [N m], force [N] or factor at which the path ends, from 0; snap: both ways to the first snap.",
        ),
    ] = "snap",
    state: Annotated[
        int, typer.Option(metavar="K", help="Number of the minimum at load 0 that is loaded.")
    ] = 1,
    unload: Annotated[
        bool, typer.Option("--unload", help="Take the load back to 0 afterwards.")
    ] = False,
    confirm: Annotated[bool, typer.Option(help="Confirm each snap by a search beside it.")] = True,
    starts: o.Starts = None,
    yields: YieldAt = None,
    **search: Any,
) -> Any:
    """Load a stable state of ORIGAMI until it snaps, or to a given load: load against angle, snaps, hysteresis.

    A pattern is loaded by one of --crease, --edge, --pull and --force, a vertex by --crease, else by the scene's own
    forces.  Images of the crease under the symmetry of a vertex bear the same torque; where the state breaks the
    symmetry (a pitchfork) the path goes on along stable states that branch off, or snaps.  --no-full keeps the
    symmetry; --symmetry none loads the one crease alone.  With --yield creases yield: their rest angles move, and stay
    moved as the load falls; the path ends where it first snaps.
    """
    from origami_nlp.loading import load_path
    from origami_nlp.pattern import Scene

    end = to if to == "snap" else load_number(to)
    if fixed_facet is not None and not force:
        raise OptionError(f"--fixed-facet = {fixed_facet} is for --force V,X,Y,Z: leave it out")
    if scene.is_whole and sum(map(bool, (crease, edge, pull, force))) != 1:
        raise OptionError(
            "a pattern is loaded by one of --crease K, --edge E, --pull V,W and --force V,X,Y,Z"
        )
    pulled = _numbers("--pull", pull, 2) if pull else []
    forced = _numbers("--force", force, 4) if force else []
    what = scene.read_whole()
    work: Any
    if isinstance(what, Scene):
        if edge or pull or force or len(crease or ()) > 1:
            raise OptionError("--edge, --pull, --force and several --crease are for patterns")
        if not crease and not what.loads:
            raise OptionError("--crease K is missing: the crease that bears the torque, from 1")
        work = crease[0] if crease else None
    else:
        work = work_of(what, creases_of(what, edge) or crease, pulled, forced, fixed_facet or 1)
    count = what.degree if isinstance(what, Scene) else what.creases
    search |= {"yield_torque": torque_bounds("--yield", yields, count), "starts": starts}
    with progress(f"{scene.name} under load"):
        return load_path(what, work, to=end, state=state, unload=unload, confirm=confirm, **search)


@bounded
@takes_scene(o.OrigamiOrPanels, whole=True, springs=False)
@writes("json", "figure", "html", "fold")
def barriers(
    out: Output,
    scene: Source,
    seed: o.Seed = 0,
    verbose: o.Verbose = False,
) -> None:
    """Find the lowest pass between every two minima of ORIGAMI, and a path through it.

    Along traced curves; with two or more degrees of freedom along descents and, of patterns, paths over any height, as
    upper bounds, exact where the flat state parts two minima of a vertex.
    """
    from origami_nlp.barriers import check_dof, draw_barriers, find_barriers
    from origami_nlp.pattern import Scene, examples

    given = scene.name
    if scene.is_panels:
        out.refuse("this is for one ORIGAMI, not for all panels", "fold")
    stated: list[Any] = [*examples.panels()] if scene.is_panels else [scene.read_whole()]
    for one in stated:
        if isinstance(one, Scene):
            check_dof(one)
    found = []
    for one in stated:
        if isinstance(one, Scene):
            result = search(one, given, seed=seed, escape=False)
            with progress(f"{one.label or given}: passes between the minima"):
                found.append(find_barriers(one, result, seed=seed))
        else:
            with progress(f"{given}: barriers") as report, paused(again=False) as left:
                limits: Any = {"seconds": left, "progress": lambda text: report(text=text)}
                found.append(find_barriers(one, seed=seed, **limits))
        found[-1].print_to(out.console, verbose)
    documents = [b.to_dict() for b in found]
    out.write("json", lambda: documents if scene.is_panels else documents[0])
    out.write("fold", lambda: found[0].to_fold())
    out.write("figure", draw_barriers, *found)
    out.turn(*found)
    end_of(found[0])


@bounded
@takes_scene(o.SceneOrPanels, springs=False)
@writes("json")
def critical(
    out: Output,
    scene: Source,
    seed: o.Seed = 0,
    compare: Annotated[
        bool,
        typer.Option(
            "--compare/--no-compare", help="Also search for minima, and compare the two lists."
        ),
    ] = True,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print points that are not essential as well.")
    ] = False,
) -> None:
    """Find minima, saddles and maxima of SCENE, contacts included, and check the Morse identity."""
    from origami_nlp.critical import PANEL_HEADS, compare_minima, find_critical_points, panel_row
    from origami_nlp.display import rows_table
    from origami_nlp.pattern import examples
    from origami_nlp.space import find_space

    given = scene.name
    scenes = examples.panels() if scene.is_panels else [scene.read()]
    rows, data = [], []
    euler: dict[object, int] = {}
    for number, stated in enumerate(scenes):
        name = stated.label or str(given)
        with progress("critical points", len(scenes)) as report:
            report(number, text=name)
            found = find_critical_points(stated, seed=seed)
            if compare:
                found = compare_minima(found, search_minima(stated, given, seed=seed, escape=False))
            shape = (stated.vertex, stated.group.name, stated.mirror, stated.limits)
            if shape not in euler:
                report(text=f"{name}: space")
                euler[shape] = find_space(stated).euler_characteristic
        verdict = found.verdict(euler[shape])
        rows.append(panel_row(found, verdict.euler_characteristic))
        data.append(replace(found, morse=verdict).to_dict())
        if not scene.is_panels:
            out.say(found.table(verbose))
            for line in found.lines(verbose):
                out.say(line)
            out.say(verdict.text)
        elif out.console.is_terminal:
            out.say(f"{stated.label}: {verdict.text}")
    if scene.is_panels:
        out.say(rows_table(PANEL_HEADS, rows, "critical points of the paper's panels"))
    out.write("json", lambda: data if scene.is_panels else data[0])


@bounded
@takes_scene(o.SceneFile, springs=False)
@answers("json", "figure")
def space(scene: Source, rings: o.Rings = 64) -> Any:
    """Find components, holes, pinch points and handles of SCENE's admissible symmetric states."""
    from origami_nlp.space import find_space

    stated = scene.read()
    with progress(f"{stated.label or scene.name}: mesh, walls, layers"):
        return find_space(stated, rings=rings)
