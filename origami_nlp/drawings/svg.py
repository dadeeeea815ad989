"""SVG in: lines of Origami Simulator's colours, wherever groups, transforms and style sheets put them.

Its rules (js/pattern.js): the stroke says what a line is, opacity times stroke-opacity times 180 degrees is the fold
angle, the opacity of a group does not count.  ``data-assignment`` and ``data-foldAngle`` (Rabbit Ear's) come first.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from fontTools.misc.transform import Identity, Transform

from origami_nlp.drawings.lines import DrawingOptions, LineList, Lines
from origami_nlp.drawings.style import SIMULATOR_COLOURS, Sheet, canonical_colour
from origami_nlp.errors import DrawingError

STRAIGHT = 1e-6
"""Share of its chord by which the handles of a straight curve may be off it: drawing programs write lines so."""

Point = tuple[float, float]


def path_chains(d: str) -> tuple[list[list[Point]], int]:
    """Return the chains of points of a path, and how many of its pieces are curves, which are left out.

    Parameters
    ----------
    d
        The path, as SVG writes it; what comes after an error is not drawn, as browsers do.

    Returns
    -------
    list of list of tuple
        Points (x, y).
    int
        Curves, those not counted whose handles lie on their chord.

    Examples
    --------
    >>> path_chains("M1 1h2v3z")
    ([[(1.0, 1.0), (3.0, 1.0), (3.0, 4.0), (1.0, 1.0)]], 0)
    >>> path_chains("M0 0 Q1 1 2 0 L3 0")
    ([[(2.0, 0.0), (3.0, 0.0)]], 1)
    """
    from fontTools.svgLib.path.parser import parse_path

    pen = _Pen()
    if not re.search("[aA]", d):  # "010" is one number but among the flags of an arc
        d = re.sub(r"(?<![\d.])0+(?=\d)", "", d)
    with suppress(ValueError, IndexError, TypeError):
        parse_path(d, pen)
    return [chain for chain in pen.chains if len(chain) > 1], pen.curves


class _Pen:
    """What the parser of fontTools draws with."""

    def __init__(self) -> None:
        self.chains: list[list[Point]] = []
        self.curves = 0

    def moveTo(self, to: Point) -> None:
        self.chains.append([to])

    def closePath(self) -> None:
        self.chains.append([self.chains[-1][-1]])  # what follows begins where the outline did

    def endPath(self) -> None:
        pass

    def lineTo(self, to: Point) -> None:
        self.chains[-1].append(to)

    def curveTo(self, *points: Point) -> None:
        if _is_straight(*(complex(*p) for p in (self.chains[-1][-1], *points))):
            self.lineTo(points[-1])
        else:
            self.curves += 1
            self.moveTo(points[-1])

    qCurveTo = curveTo

    def arcTo(self, rx: float, ry: float, turn: float, large: bool, far: bool, to: Point) -> None:
        self.curves += 1
        self.moveTo(to)


def _is_straight(here: complex, *points: complex) -> bool:
    *handles, to = points
    chord = to - here
    if not chord:
        return all(h == here for h in handles)
    along = [(h - here) / chord for h in handles]
    return all(abs(z.imag) <= STRAIGHT and -STRAIGHT <= z.real <= 1 + STRAIGHT for z in along)


NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
PIXELS = {"": 1.0, "px": 1.0, "in": 96.0, "mm": 96 / 25.4, "cm": 96 / 2.54, "pt": 4 / 3, "pc": 16.0}
"""Of each unit of CSS; user units are pixels."""
UNITS = {"mm": "mm", "cm": "cm", "in": "in"}
_NOT_DRAWN = frozenset(
    "defs symbol clipPath mask marker pattern title desc metadata style namedview script".split()
)
_SHAPES = frozenset("line polyline polygon rect path".split())
_ROUND = frozenset("circle ellipse text".split())


def read_svg(raw: bytes, name: str, options: DrawingOptions) -> Lines:
    """Read the lines of an SVG drawing.

    Parameters
    ----------
    raw
        The file.
    name
        How messages call it.
    options
        What else is known of it.

    Returns
    -------
    Lines
        In user units, or mm, cm, in where one user unit is one.

    Raises
    ------
    DrawingError
        If it is no SVG, has no line whose letter is known, or curves that nothing was said of.

    Examples
    --------
    >>> found = read_svg(b'<svg><path stroke="red" opacity=".5" d="M0 0h4"/></svg>', "it", DrawingOptions())
    >>> found.letters, found.angles.tolist()
    (('M',), [-90.0])
    """
    root = parse_xml(raw, name)
    if root.tag != "svg":
        raise DrawingError(f"{name} is no SVG: its root is <{root.tag}>")
    letters = {canonical_colour(key): letter for key, letter in options.letters.items()}
    sheet, found = Sheet(root), LineList(name, replace(options, letters=letters))
    if sheet.left_out:
        found.notes.append(f"style sheet, selectors left out: {', '.join(sheet.left_out[:4])}")
    stack: list[tuple[Element, Transform, Mapping[str, str]]] = [(root, Identity, {})]
    while stack:
        element, above, inherited = stack.pop()
        tag, look = element.tag, sheet.look(element, inherited)
        if tag in _NOT_DRAWN:
            continue
        if look.get("display") == "none":
            found.left_out["hidden shapes"] += sum(one.tag in _SHAPES for one in element.iter())
            continue
        matrix = above.transform(_matrix(element, name))
        if tag == "svg" and element is not root:
            matrix = matrix.translate(*(_length(element, k, name) for k in "xy"))
        colour = canonical_colour(look.get("stroke", "none"))
        if tag in ("use", "image", "foreignObject") or (tag in _ROUND and colour != "none"):
            found.left_out[f"<{tag}>"] += 1
        elif tag in _SHAPES and look.get("visibility") in ("hidden", "collapse"):
            found.left_out["hidden shapes"] += 1
        elif tag in _SHAPES and colour != "none":
            _shape(found, element, matrix, colour, look)
        stack += [(child, matrix, look) for child in reversed(element)]
    found.length_unit = _unit(root)
    title = root.findtext("title") or ""
    return found.lines("colours", y_down=True, title=title.strip())


def _shape(
    found: LineList, element: Element, matrix: Transform, colour: str, look: Mapping[str, str]
) -> None:
    """Add the lines of a shape with a stroke."""
    said = element.get("data-assignment", "").upper()
    known = said if said and said in "BMVFUC" else SIMULATOR_COLOURS.get(colour)
    letter = found.letter(colour, known)
    if letter is None:
        return
    chains, curves = _chains(element, found.name)
    found.left_out["curves"] += curves
    stated = _real(element.get("data-foldAngle", ""))
    angle = _fold_angle(letter, look) if stated is None else stated
    if found.is_asked(colour) and letter in "MV":
        angle = math.copysign(angle, -1.0 if letter == "M" else 1.0)
    where = f"in <{element.tag}> {element.get('id', '')!r}"
    for chain in chains:
        found.add(matrix.transformPoints(chain), letter, angle, where)


def _fold_angle(letter: str, look: Mapping[str, str]) -> float:
    """Return the fold angle [deg] that an opacity says of a mountain or valley, as Origami Simulator does."""
    given = [look[key] for key in ("opacity", "stroke-opacity") if key in look]
    shares = [1.0 if (s := _real(v.replace("%", "e-2"))) is None else s for v in given]
    share = math.prod(min(max(s, 0.0), 1.0) for s in shares)
    if letter not in "MV" or not given or share == 0.0:
        return math.nan
    return math.copysign(180.0 * share, 1.0 if letter == "V" else -1.0)


def _chains(element: Element, name: str) -> tuple[list[list[Point]], int]:
    """Return the chains of points of a shape, and how many curves it has."""
    tag = element.tag
    if tag == "path":
        return path_chains(element.get("d", ""))
    if tag in ("line", "rect"):
        keys = ("x1", "y1", "x2", "y2") if tag == "line" else ("x", "y", "width", "height")
        x, y, u, v = (_length(element, key, name) for key in keys)
        if tag == "line":
            return [[(x, y), (u, v)]], 0
        return [[(x, y), (x + u, y), (x + u, y + v), (x, y + v), (x, y)]], 0
    numbers = [float(n) for n in re.findall(NUMBER, element.get("points", ""))]
    chain = list(zip(numbers[::2], numbers[1::2], strict=False))
    return ([[*chain, *chain[: tag == "polygon"]]] if len(chain) > 1 else []), 0


def _length(element: Element, key: str, name: str) -> float:
    text = element.get(key, "0").strip()
    match = re.fullmatch(rf"({NUMBER})\s*([a-z]*)", text)
    if match is None or match[2] not in PIXELS:
        raise DrawingError(f"{name}: {key} = {text[:40]!r} of a <{element.tag}> must be a length")
    return float(match[1]) * PIXELS[match[2]]


def _real(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _matrix(element: Element, name: str) -> Transform:
    """Return what the transform of an element does to its points."""
    made = Identity
    for part in element.get("transform", "").split(")")[:-1]:
        kind, _, words = (word.strip() for word in part.strip(" ,\t\r\n").partition("("))
        n = [float(w) for w in re.findall(NUMBER, words)]
        try:
            if kind == "matrix":
                a, b, c, d, e, f = n
                made = made.transform((a, b, c, d, e, f))
            elif kind == "rotate":
                turn, x, y = (*n, 0.0, 0.0) if len(n) == 1 else n
                made = made.translate(x, y).rotate(math.radians(turn)).translate(-x, -y)
            elif kind in ("skewX", "skewY"):
                (lean,) = map(math.radians, n)
                made = made.skew(*((lean, 0.0) if kind == "skewX" else (0.0, lean)))
            else:
                made = {"translate": made.translate, "scale": made.scale}[kind](*n)
        except (KeyError, TypeError, ValueError):
            raise DrawingError(f"{name}: transform {kind}({words[:40]}) is none of SVG") from None
    return made


def _unit(root: Element) -> str:
    """Return the unit of which one user unit is one; "" where there is none."""
    width = re.fullmatch(rf"\s*({NUMBER})\s*([a-z]+)\s*", root.get("width", ""))
    box = [float(n) for n in re.findall(NUMBER, root.get("viewBox", ""))]
    if width is None or len(box) != 4 or float(width[1]) != box[2]:
        return ""
    return UNITS.get(width[2], "")


DEEPEST = 500
"""Elements within each other."""


def parse_xml(raw: bytes, name: str) -> Element:
    """Return the root of an XML document; tags come without their namespaces.

    Parameters
    ----------
    raw
        The file.
    name
        How messages call it.

    Returns
    -------
    Element
        The root.

    Raises
    ------
    DrawingError
        If it is no XML, defines an entity, or is nested too deeply.

    Examples
    --------
    >>> parse_xml(b'<svg xmlns="http://www.w3.org/2000/svg"><g/></svg>', "it")[0].tag
    'g'
    """
    builder, depth = TreeBuilder(), 0
    parser = expat.ParserCreate(namespace_separator="}")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise DrawingError(f"{name} has more than {DEEPEST} elements within each other")
        builder.start(_local(tag), {_local(k): v for k, v in attributes.items()})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(_local(tag))

    def refuse(*_: object) -> NoReturn:
        raise DrawingError(f"{name} defines XML entities, which can hide anything: save it anew")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(raw, True)
    except expat.ExpatError as error:
        raise DrawingError(f"{name} is not valid XML: {error}") from None
    except (LookupError, ValueError) as error:  # an unknown encoding
        if isinstance(error, DrawingError):
            raise
        raise DrawingError(f"{name} is not valid XML: {error}") from None
    return builder.close()


def _local(tag: str) -> str:
    return tag.rpartition("}")[2]
