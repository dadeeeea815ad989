"""Commands about files: what one holds, whether it is real, other formats, examples, measured hinges."""

from __future__ import annotations

import inspect as introspection
import textwrap
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import did_you_mean
from origami_nlp.cli import options as o
from origami_nlp.cli.exits import Ended
from origami_nlp.cli.group import writes
from origami_nlp.cli.output import KINDS, Output
from origami_nlp.cli.source import Source, cell_options
from origami_nlp.cli.timed import Clock, CommandOutOfTime
from origami_nlp.errors import FoldFileError, OptionError

if TYPE_CHECKING:
    from origami_nlp.pattern import Scene


@dataclass
class _Inspected:
    """What `inspect` says of a pattern: vertices of each frame, mobility where it is a sheet, its motion if asked."""

    lists: list[Any]
    seen: Any = None
    motion: Any = None
    why: str = ""

    def print_to(self, console: Any, verbose: bool) -> None:
        from origami_nlp.validity import print_vertices

        print_vertices(self.lists, console)
        for one in filter(None, (self.seen, self.motion)):
            one.print_to(console, verbose)
        if self.why:
            console.print(f"no sheet of rigid facets: {self.why}")

    def to_dict(self) -> dict[str, Any]:
        from origami_nlp.validity import vertices_to_dict

        data = vertices_to_dict(self.lists) | (self.seen.to_dict() if self.seen else {})
        return data | ({"motion": self.motion.to_dict()} if self.motion else {})

    def draw(self) -> Any:
        from origami_nlp.display import draw_pattern

        flat = [one.frame for one in self.lists if not one.frame.folded]
        if self.motion is None and not flat:
            raise OptionError("-o: there is no crease pattern to draw")
        return self.motion.draw() if self.motion else draw_pattern(flat[0])

    def to_fold(self) -> dict[str, Any]:
        from origami_nlp.pattern_problem import path_frames, state_frame, states_to_fold

        frame = partial(state_frame, self.seen.pattern)
        frames, folded = [], self.seen.folded
        if self.motion is not None:
            path = self.motion.fold_angles, self.motion.energy
            frames = path_frames(frame, *path, "folding motion")
        elif folded is not None:
            frames = [frame(folded, f"folded: {self.seen.start}")]
        return states_to_fold(self.seen.pattern, frames)

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
    from origami_nlp.pattern_states import analyze_mobility, find_motion
    from origami_nlp.validity import list_vertices

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
    from origami_nlp.display import record_table, springs_of
    from origami_nlp.pattern import format_scene
    from origami_nlp.pattern_problem import pose

    why = "one vertex is written as a scene: end the name in .toml"
    out.refuse(why, "json", "fold", "figure", "html")
    model = str(pose(stated))
    kept = f"symmetry {stated.group.name} ({stated.symmetry} asked)"
    title = f"{stated.label or 'vertex'}: degree {stated.degree}, {kept}, contact {stated.contact}"
    out.say(record_table(springs_of(stated), title))
    for law in dict.fromkeys(filter(None, stated.laws)):
        out.say(f"law {law}")
    for load in stated.loads:
        out.say(f"load: {load.words}, facet {stated.fixed_facet} fixed")
    out.say(model)
    out.write("scene", format_scene, stated)


@writes("json", "figure")
def hinge(data: str = o.HINGE_DATA) -> Any:
    """Fit a hinge law to measured torques: its band, wells, where the stiffness is negative, loop, and what to look at.

    Torque is dU/dphi, positive towards valley.  A scene has the law by [laws.NAME] data = "DATA".
    """
    from origami_nlp.hinges import fit_hinge

    return fit_hinge(data)


@writes("json", "figure", "fold", verbose=True)
def check(
    out: Output,
    clock: Clock,
    files: list[str] = o.FILES,
    frame: int | None = o.CHECKED_FRAME,
    tolerance: float | None = o.TOLERANCE,
    orders: bool = o.ORDERS,
) -> Any:
    """Check whether folded states are real, and whether crease patterns fold flat: all faults, with place and size.

    Lengths as in the crease pattern, plane faces, fold angles and letters as the coordinates have them, closure,
    faces that pass through each other, faceOrders; of a crease pattern Kawasaki, Maekawa and layers.
    -o FILE.png marks the faults.  Exit code 0: all valid; 1: faults, or not decided; 2: a file cannot be read.
    --orders: of the state that the file describes, or the pattern folded flat, with unassigned creases as mountain or
    valley.
    """
    from origami_nlp.validity import Validity, check as check_file, layer_orders

    one = len(files) == 1
    if orders:
        if not one:
            raise OptionError("--orders is of one ORIGAMI: give one")
        return layer_orders(Source.of(files[0]).read_pattern())
    out.refuse("orders of layers are written with --orders", "fold")
    if not one:
        out.refuse("a picture is of one file: give one", "figure")
    seen: list[Validity] = []
    ends = Counter[str]()
    for file in files:
        try:
            seen.append(check_file(file, frame=frame, tolerance=tolerance))
        except (FoldFileError, OptionError, CommandOutOfTime) as error:
            if one:
                raise
            if isinstance(error, CommandOutOfTime):
                clock.rest()
                out.say(f"{file}: {clock.said()}")
                break
            ends["not read"] += 1
            out.say(f"{file}: not read: {error}")
        else:
            ends[seen[-1].verdict] += 1
            seen[-1].print_to(out.console, out.verbose)
    if not one:
        counts = (f"{ends[word]} {word}" for word in ("valid", "faults", "not decided", "not read"))
        out.say(f"{len(files)} files: {', '.join(counts)}")
    out.write("json", lambda: seen[0].to_dict() if one else [s.to_dict() for s in seen])
    out.write("figure", lambda: seen[0].draw())
    good = ends["valid"] == sum(ends.values())
    return Ended.WRONG if ends["not read"] else Ended.DONE if good else Ended.NO


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
    pairs = [pair.rpartition("=") for pair in colour or ()]
    for pair, parts in zip(colour or (), pairs, strict=True):
        if not all(parts):
            raise OptionError(f"--colour = {pair!r} must be KEY=LETTER, such as '#EE1032=M'")
    letters = {key: letter.upper() for key, _, letter in pairs}
    asked = DrawingOptions(tolerance, letters, curves, part)
    drawing = asked if asked != DrawingOptions() else None
    made = written(source, to, frame=frame, drawing=drawing, write=WriteOptions(scale, size))
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
    options = {"alpha": alpha, "ratio": ratio, "symmetry": symmetry, "contact": contact}
    given: dict[str, Any] = {key: value for key, value in options.items() if value is not None}
    texts = EXAMPLES | {name: make() for name, make in HINGE_EXAMPLES.items()}
    repeated: Any = given | cell_options(cell, rolled)
    whole = bool(out.files("fold"))
    if name in texts:
        if given or cell:
            raise OptionError(f"{name!r} has no options: edit the file")
        kind, other = ("fold", "scene") if texts[name].startswith("{") else ("scene", "fold")
        out.refuse(f"{name} is no such file: give one that ends in {KINDS[kind][0][0]}", other)
        out.or_stdout(kind).write(kind, lambda: texts[name])
        return
    if not examples.is_example(word):
        known = [*dict.fromkeys((*examples.names(), *texts))]
        meant = did_you_mean(word, known)
        raise OptionError(f"NAME = {name!r} is no example: those are {', '.join(known)}{meant}")
    if not whole and (cell or ":" in name):
        raise OptionError(f"NAME = {name!r}: a size or a cell is of a pattern: give -o FILE.fold")
    out.write("fold", lambda: examples.crease_pattern(word, *size, **repeated))
    if out.files("scene") or not whole:
        if cell:
            raise OptionError("--cell: a cell that repeats is a crease pattern, no scene")
        stated = examples.by_name(word, **given)
        text = _about(examples.maker(word)) + format_scene(stated)
        out.or_stdout("scene").write("scene", lambda: text)


def _about(make: Callable[..., Any]) -> str:
    """Return what an example is as the first lines of its file."""
    said = (introspection.getdoc(make) or "").split("\nParameters\n")[0]
    said = said.removeprefix("Make ")
    lines = textwrap.wrap(" ".join((said[:1].upper() + said[1:]).split()), 98)
    lines.append(
        "To make it yours: sector_angles_deg, rest_angles_deg take degrees; stiffness is in N m/rad."
    )
    return "".join(f"# {line}\n" for line in lines)
