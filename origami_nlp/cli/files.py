"""Commands about files: what one holds, whether it is real, other formats, examples, measured hinges."""

from __future__ import annotations

import inspect as introspection
import math
import textwrap
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import did_you_mean
from origami_nlp.cli import options as o
from origami_nlp.cli.exits import Ended
from origami_nlp.cli.group import writes
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, cell_options
from origami_nlp.cli.timed import Clock, CommandOutOfTime
from origami_nlp.errors import FoldFileError, OptionError

if TYPE_CHECKING:
    from origami_nlp.display import Table
    from origami_nlp.pattern import Scene


@dataclass
class _Inspected:
    """What `inspect` says of a pattern: vertices of each frame, mobility where it is a sheet, its motion if asked."""

    lists: list[Any]
    seen: Any = None
    motion: Any = None
    why: str = ""

    def print_to(self, console: Any, verbose: bool) -> None:
        from origami_nlp.folding import print_vertices

        print_vertices(self.lists, console)
        for one in filter(None, (self.seen, self.motion)):
            one.print_to(console, verbose)
        if self.why:
            console.print(f"no sheet of rigid facets: {self.why}")

    def to_dict(self) -> dict[str, Any]:
        from origami_nlp.folding import vertices_to_dict

        data: dict[str, Any] = vertices_to_dict(self.lists)
        data |= self.seen.to_dict() if self.seen else {}
        return data | ({"motion": self.motion.to_dict()} if self.motion else {})

    def draw(self) -> Any:
        from origami_nlp.display import draw_pattern

        flat = [one.frame for one in self.lists if not one.frame.folded]
        if self.motion is None and not flat:
            raise OptionError("-o: there is no crease pattern to draw")
        return self.motion.draw() if self.motion else draw_pattern(flat[0])

    def to_fold(self) -> dict[str, Any]:
        from functools import partial

        from origami_nlp.folding import path_frames
        from origami_nlp.pattern_problem import pattern_frame, pattern_to_fold

        sheet, motion = self.seen.pattern, self.motion
        frame = partial(pattern_frame, sheet)
        if motion is not None:
            path = motion.fold_angles, motion.energy
            return pattern_to_fold(sheet, path_frames(frame, *path, "folding motion"))
        folded = self.seen.folded
        return pattern_to_fold(
            sheet, [] if folded is None else [frame(folded, f"folded: {self.seen.start}")]
        )

    def view_content(self) -> Any:
        return self.motion.view_content()


@writes("json", "scene", "fold", "figure", "html", verbose=True)
def inspect(
    origami: Source, out: Output, clock: Clock, path: bool = o.PATH, seed: int = o.SEED
) -> Any:
    """Print what a file says: of a pattern its vertices and mobility; of one vertex its springs and its problem.

    Of a pattern: degree, angles, flat-foldability and diagnosis of each interior vertex; facets, creases, holes,
    degrees of freedom, redundant equations; with --path the folding motion up to the first contact, as a rigid sheet.
    -o FILE.png draws it with the numbers of its vertices, FILE.fold is the pattern with the springs given here.  Of a
    scene, or with --vertex: the springs of each crease, variables and constraints; -o FILE.toml is that vertex as a
    scene file.
    """
    from origami_nlp.folding import list_vertices
    from origami_nlp.pattern_states import analyze_mobility, find_motion

    if not origami.is_whole:
        return _inspect_vertex(origami.read(), out)
    out.refuse("name one vertex with --vertex, to write it as a scene", "scene")
    if not path:
        out.refuse("a page shows the motion: give --path", "html")
    clock.found = found = _Inspected([list_vertices(one) for one in origami.frames()])
    try:
        found.seen = analyze_mobility(origami.read_pattern(), seed=seed)
    except FoldFileError as error:
        if path or out.files("fold", "html"):
            raise
        found.why = str(error)
    if path:
        found.motion = find_motion(found.seen.pattern, found.seen, seed=seed)
    return found


def _inspect_vertex(stated: Scene, out: Output) -> None:
    from origami_nlp.pattern import format_scene
    from origami_nlp.pattern_problem import pose

    why = "one vertex is written as a scene: end the name in .toml"
    out.refuse(why, "json", "fold", "figure", "html")
    model = str(pose(stated))
    out.say(_springs(stated))
    for law in dict.fromkeys(filter(None, stated.laws)):
        out.say(f"law {law}")
    for load in stated.loads:
        out.say(f"load: {load.words}, facet {stated.fixed_facet} fixed")
    out.say(model)
    out.write("scene", format_scene, stated)


def _springs(stated: Scene) -> Table:
    """Return one row a crease: the sector to the next crease, and its spring."""
    from origami_nlp.display import rows_table

    sectors, rest = (
        map(math.degrees, a) for a in (stated.vertex.sector_angles, stated.rest_angles)
    )
    columns = {
        "crease": [*map(str, range(1, stated.degree + 1))],
        "sector to the next [deg]": [f"{v:.7g}" for v in sectors],
        "stiffness [N m/rad]": [f"{v:.7g}" for v in stated.stiffness],
        "rest angle [deg]": [f"{v:.7g}" for v in rest],
    }
    if stated.preload:
        columns["preload [N m]"] = [f"{m:.7g}" for m in stated.preload]
    if stated.limits:
        columns["stops [deg]"] = [
            " to ".join(f"{math.degrees(a):.7g}" for a in pair) for pair in stated.limits
        ]
    if stated.laws:
        for name in ("stiffness [N m/rad]", "rest angle [deg]"):  # its numbers are in its line
            own = zip(stated.laws, columns[name], strict=True)
            columns[name] = ["" if law else v for law, v in own]
        columns["law"] = [law.name if law else "" for law in stated.laws]
    kept = f"symmetry {stated.group.name} ({stated.symmetry} asked)"
    title = f"{stated.label or 'vertex'}: degree {stated.degree}, {kept}, contact {stated.contact}"
    return rows_table([*columns], [*zip(*columns.values(), strict=True)], title)


@writes("json", "figure")
def hinge(data: str = o.HINGE_DATA, fit: str = o.FIT) -> Any:
    """Fit a hinge law to measured torques: its band, wells, where the stiffness is negative, loop, and what to look at.

    Torque is dU/dphi, positive towards valley.  A scene has the law by [laws.NAME] data = "DATA".
    """
    from origami_nlp.hinges import fit_hinge

    return fit_hinge(data, fit=fit)


@writes("json", "figure", "fold", verbose=True)
def check(
    out: Output,
    clock: Clock,
    files: list[str] = o.FILES,
    frame: int | None = o.CHECKED_FRAME,
    flat_frame: int | None = o.FLAT_FRAME,
    tolerance: float | None = o.TOLERANCE,
    orders: bool = o.ORDERS,
    most: int = o.MOST,
) -> Any:
    """Check whether folded states are real, and whether crease patterns fold flat: all faults, with place and size.

    Lengths as in the crease pattern, plane faces, fold angles and letters as the coordinates have them, closure,
    faces that pass through each other, faceOrders; of a crease pattern Kawasaki, Maekawa, big-little-big and layers.
    -o FILE.png marks the faults.  Exit code 0: all valid; 1: faults, or not decided; 2: a file cannot be read.
    --orders: of the state that the file describes, or the pattern folded flat, with unassigned creases as mountain or
    valley.
    """
    from origami_nlp.validity import Validity, check as check_file, layer_orders

    if orders:
        if len(files) > 1:
            raise OptionError("--orders is of one ORIGAMI: give one")
        return layer_orders(Source(files[0], *[None] * 13).read_pattern(), most=most)
    out.refuse("orders of layers are written with --orders", "fold")
    if len(files) > 1:
        out.refuse("a picture is of one file: give one", "figure")
    seen: list[Validity] = []
    unread = 0
    for file in files:
        try:
            one = check_file(file, frame=frame, flat_frame=flat_frame, tolerance=tolerance)
        except (FoldFileError, OptionError) as error:
            if len(files) == 1:
                raise
            unread += 1
            out.say(f"{file}: not read: {error}")
            continue
        except CommandOutOfTime:
            if len(files) == 1:
                raise
            clock.rest()
            out.say(f"{file}: {clock.said()}")
            break
        one.print_to(out.console, out.verbose)
        seen.append(one)
    if len(files) > 1:
        counts = Counter(one.verdict for one in seen)
        out.say(
            f"{len(files)} files: {counts['valid']} valid, {counts['faults']} with faults, "
            f"{counts['not decided']} not decided, {unread} not read"
        )
    out.write("json", lambda: seen[0].to_dict() if len(files) == 1 else [s.to_dict() for s in seen])
    out.write("figure", lambda: seen[0].draw())
    good = all(one.verdict == "valid" for one in seen)
    return Ended.WRONG if unread else Ended.DONE if good else Ended.NO


@writes()
def convert(
    out: Output,
    source: str = o.DRAWING,
    to: str = o.CONVERTED,
    frame: int | None = o.FRAME,
    tolerance: float | None = o.TOLERANCE,
    colour: list[str] | None = o.COLOUR,
    curves: str = o.CURVES,
    part: int | None = o.PART,
    scale: float | None = o.SCALE,
    size: float | None = o.LONGEST,
) -> None:
    """Write the crease pattern of SOURCE as OUT, in another format.

    What was repaired, left out or taken is listed.  A frame with a folded form (--frame K) is drawn flat, with its fold
    angles.
    """
    from origami_nlp.drawings import DrawingOptions, WriteOptions
    from origami_nlp.pattern import convert as written

    out.check(("OUT", to))
    letters = {}
    for pair in colour or ():
        key, sign, letter = pair.rpartition("=")
        if not (key and sign and letter):
            raise OptionError(f"--colour = {pair!r} must be KEY=LETTER, such as '#EE1032=M'")
        letters[key] = letter.upper()
    asked = DrawingOptions(tolerance, letters, int(curves) if curves.isdigit() else curves, part)
    made = written(
        source,
        to,
        frame=frame,
        drawing=asked if asked != DrawingOptions() else None,
        write=WriteOptions(scale, size),
    )
    for note in made.notes:
        out.say(f"note: {note}")
    counts = Counter(made.letters)
    shown = ", ".join(f"{counts[a]} {a}" for a in "MVUFCB" if counts[a])
    out.say(f"written: {to}: {len(made.points)} vertices, {len(made.edges)} edges ({shown})")


@writes("scene", "fold")
def example(
    out: Output,
    name: str = o.EXAMPLE,
    alpha: str | None = o.ALPHA,
    ratio: float | None = o.RATIO_WANTED,
    mountain: str | None = o.MOUNTAIN,
    valley: str | None = o.VALLEY,
    symmetry: str | None = o.SYMMETRY,
    contact: str | None = o.CONTACT,
    cell: bool | None = o.CELL,
    rolled: str | None = o.ROLLED,
) -> None:
    """Print the scene file of a known vertex, or of a design its targets; -o FILE.fold writes the crease pattern.

    NAME:ROWSxCOLUMNS, such as miura:4x6, is the size of the crease pattern.
    """
    from origami_nlp.hinges import HINGE_EXAMPLES
    from origami_nlp.inverse_design import EXAMPLES
    from origami_nlp.pattern import examples, format_scene

    word, size = examples.split_size(name)
    options = {"alpha": alpha, "ratio": ratio, "mountain": mountain, "valley": valley}
    options |= {"symmetry": symmetry, "contact": contact}
    given: dict[str, Any] = {key: value for key, value in options.items() if value is not None}
    texts = EXAMPLES | {name: make() for name, make in HINGE_EXAMPLES.items()}
    if name in texts:
        if given or cell or rolled:
            raise OptionError(f"{name!r} has no options: edit the file")
        kind, other = ("fold", "scene") if texts[name].startswith("{") else ("scene", "fold")
        out.refuse(
            f"{name} is no such file: end the name in {dict(fold='.fold', scene='.toml')[kind]}",
            other,
        )
        out = out if out.files(kind) else Output(["-"], [kind])
        out.write(kind, lambda: texts[name])
        return
    if not examples.is_example(word):
        known = (*examples.names(), *texts)
        listed = ", ".join(dict.fromkeys(known))
        raise OptionError(
            f"NAME = {name!r} is no example: those are {listed}{did_you_mean(word, known)}"
        )
    if out.files("fold"):
        more: Any = given | cell_options(cell, rolled)
        out.write("fold", lambda: examples.crease_pattern(word, *size, **more))
        if not out.files("scene"):
            return
    if cell or rolled:
        raise OptionError("--cell: a cell that repeats is a crease pattern: give -o FILE.fold")
    if ":" in name and not out.files("fold"):
        raise OptionError(f"NAME = {name!r}: a size is that of a crease pattern: give -o FILE.fold")
    stated = examples.by_name(word, **given)
    text = _about(examples.maker(word)) + format_scene(stated)
    (out if out.files("scene") else Output(["-"], ["scene"])).write("scene", lambda: text)


def _about(make: Callable[..., Any]) -> str:
    """Return what an example is as the first lines of its file."""
    said = (introspection.getdoc(make) or "").split("\nParameters\n")[0]
    said = said.removeprefix("Make ")
    lines = textwrap.wrap(" ".join((said[:1].upper() + said[1:]).split()), 98)
    lines.append(
        "To make it yours: sector_angles_deg, rest_angles_deg take degrees; stiffness is in N m/rad."
    )
    return "".join(f"# {line}\n" for line in lines)
