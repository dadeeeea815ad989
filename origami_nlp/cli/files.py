"""Commands about files: what one holds, whether it is real, other formats, examples, measured hinges."""

from __future__ import annotations

from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import did_you_mean
from origami_nlp.cli import options as o
from origami_nlp.cli.exits import Ended
from origami_nlp.cli.group import writes
from origami_nlp.cli.output import KINDS, Output
from origami_nlp.cli.source import Source, cell_options
from origami_nlp.errors import FoldFileError, OptionError

if TYPE_CHECKING:
    from origami_nlp.pattern import Scene


DEGREES = "# sector_angles_deg, rest_angles_deg take degrees; stiffness is in N m/rad.\n"
"""First line of a scene file that is to be edited."""


@writes("json", "scene", "fold", "figure", "html", verbose=True)
def inspect(origami: Source, out: Output, path: bool = o.PATH, seed: int = o.SEED) -> None:
    """Print what a file says: of a pattern its vertices and mobility; of one vertex its springs and its problem.

    Of a pattern: degree, angles, flat-foldability and diagnosis of each interior vertex; facets, creases, holes,
    degrees of freedom, redundant equations; with --path the folding motion up to the first contact, as a rigid sheet.
    -o FILE.png draws it with the numbers of its vertices, FILE.fold is the pattern with the springs given here.  Of a
    scene, or with --vertex: the springs of each crease, variables and constraints; -o FILE.toml is that vertex as a
    scene file.
    """
    from origami_nlp.display import draw_pattern
    from origami_nlp.pattern import frame_pattern
    from origami_nlp.pattern_problem import path_frames, state_frame, states_to_fold
    from origami_nlp.pattern_states import analyze_mobility, find_motion
    from origami_nlp.validity import list_vertices

    if not origami.is_whole:
        return _inspect_vertex(origami.read(), out)
    out.refuse("name one vertex with --vertex, to write it as a scene", "scene")
    vertices, seen, motion = list_vertices(origami.frames()), None, None
    flat = [one for one in vertices.frames if not one.folded]
    if not path:
        out.refuse("a page shows the motion: give --path", "html")
        out.refuse("there is no crease pattern to draw", *["figure"] * (not flat))
    try:
        seen = analyze_mobility(origami.read_pattern(), seed=seed)
        motion = find_motion(seen.pattern, seen, seed=seed) if path else None
    except FoldFileError as error:
        if path or out.files("fold", "html"):
            raise
        why = f"no sheet of rigid facets: {error}"
    out.say(vertices, *filter(None, (seen, motion)))
    if seen and origami.snap is not None:
        drawn = analyze_mobility(frame_pattern(origami.frames("first")[0]), seed=seed)
        folded = f"{drawn.rank_folded} folded, degrees of freedom {drawn.dof}"
        folded = "no folded state found" if drawn.folded is None else folded
        out.say(f"without --snap: rank {drawn.rank_flat} flat, {folded}")
    data = vertices.to_dict() | (seen.to_dict() if seen else {})
    out.write("json", lambda: data | ({"motion": motion.to_dict()} if motion else {}))
    out.write("figure", lambda: motion.draw() if motion else draw_pattern(flat[0]))
    if seen is None:
        return out.say(why)
    frame, frames = partial(state_frame, seen.pattern), []
    if motion:
        frames = path_frames(frame, motion.fold_angles, motion.energy, "folding motion")
        out.page(motion)
    elif seen.folded is not None:
        frames = [frame(seen.folded, f"folded: {seen.start}")]
    out.write("fold", states_to_fold, seen.pattern, frames)


def _inspect_vertex(stated: Scene, out: Output) -> None:
    from origami_nlp.display import record_table, springs_of
    from origami_nlp.pattern import format_scene
    from origami_nlp.pattern_problem import pose

    why = "one vertex is written as a scene: end the name in .toml"
    out.refuse(why, "json", "fold", "figure", "html")
    model = str(pose(stated))
    kept = f"symmetry {stated.group.name} ({stated.symmetry} asked)"
    title = f"{stated.label or 'vertex'}: degree {stated.degree}, {kept}, contact {stated.contact}"
    loads = (f"load: {load.words}, facet {stated.fixed_facet} fixed" for load in stated.loads)
    laws = (f"law {law}" for law in dict.fromkeys(filter(None, stated.laws)))
    out.say(record_table(springs_of(stated), title), *laws, *loads, model)
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
    file: str = o.CHECKED,
    frame: int | None = o.CHECKED_FRAME,
    tolerance: float | None = o.TOLERANCE,
    orders: bool = o.ORDERS,
) -> Any:
    """Check whether a folded state is real, and whether a crease pattern folds flat: all faults, with place and size.

    Lengths as in the crease pattern, plane faces, fold angles and letters as the coordinates have them, closure,
    faces that pass through each other, faceOrders; of a crease pattern Kawasaki, Maekawa and layers.
    -o FILE.png marks the faults.  Exit code 0: all valid; 1: faults, or not decided; 2: a file cannot be read.
    --orders: of the state that the file describes, or the pattern folded flat, with unassigned creases as mountain or
    valley.
    """
    from origami_nlp.validity import check as check_file, layer_orders

    if orders:
        return layer_orders(Source.of(file).read_pattern())
    out.refuse("orders of layers are written with --orders", "fold")
    seen = check_file(file, frame=frame, tolerance=tolerance)
    out.report(seen)
    return Ended.DONE if seen.verdict == "valid" else Ended.NO


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
    size: float | None = o.LONGEST,
) -> None:
    """Write the crease pattern of SOURCE as OUT, in another format.

    What was repaired, left out or taken is listed.  A frame with a folded form (--frame K) is drawn flat, with its fold
    angles.
    """
    from origami_nlp.drawings import DrawingOptions
    from origami_nlp.pattern import convert as written

    out.check(("OUT", to))
    letters = {}
    for pair in colour or ():
        key, _, letter = pair.rpartition("=")
        if not (key and letter):
            raise OptionError(f"--colour = {pair!r} must be KEY=LETTER, such as '#EE1032=M'")
        letters[key] = letter.upper()
    asked = DrawingOptions(tolerance, letters, curves, part)
    drawing = asked if asked != DrawingOptions() else None
    made = written(source, to, frame=frame, drawing=drawing, size=size)
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
    if name in texts:
        if given or cell:
            raise OptionError(f"{name!r} has no options: edit the file")
        kind, other = ("fold", "scene") if texts[name].startswith("{") else ("scene", "fold")
        out.refuse(f"{name} is no such file: give one that ends in {KINDS[kind][0][0]}", other)
        return out.or_stdout(kind).write(kind, lambda: texts[name])
    if not examples.is_example(word):
        known = [*dict.fromkeys((*examples.names(), *texts))]
        meant = did_you_mean(word, known)
        raise OptionError(f"NAME = {name!r} is no example: those are {', '.join(known)}{meant}")
    cells: Any = cell_options(cell, rolled)
    out.write("fold", lambda: examples.crease_pattern(word, *size, **given | cells))
    if out.files("scene") or not out.files("fold"):
        if word not in examples.BY_NAME:
            raise OptionError(f"NAME = {name!r} is a crease pattern, no vertex: give -o FILE.fold")
        if cell or (any(size) and not out.files("fold")):
            raise OptionError(f"NAME = {name!r} is of a pattern, cell or size: give -o FILE.fold")
        text = DEGREES + format_scene(examples.by_name(word, **given))
        out.or_stdout("scene").write("scene", lambda: text)
