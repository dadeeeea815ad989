"""Numbers of an origami by name: what states are followed over, what a load multiplies, what a sweep sets.

``creases.stiffness[3]`` is that of one crease (from 1), ``mountains.stiffness``, ``valleys.stiffness`` and
``creases.stiffness`` those of all of a kind; the same for ``rest_angles``, where ``creases.rest_angles`` is the size
for mountains and valleys and the others are angles.  ``law_scale`` multiplies a hinge law as it is stated,
``law_shift`` moves it by an angle.  A vertex has ``preload``, ``torque`` (added to the preload),
``vertex.sector_angles[1]``, ``loads`` (the factor of all forces that it states, ``loads[1]`` that of one), and
``alpha``, the sector angle alpha_1 of the paper's families.  ``vertices.x[5]`` and ``vertices.y[5]`` are coordinates of
a vertex of flat paper, numbered from 0 as in the file.  ``ratio`` is the stiffness of mountains over that of valleys.
What stands before the point may be left out before an entry; ``_deg`` before the entry says that the number is in
degrees.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from origami_nlp.arguments import did_you_mean
from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.pattern import examples
from origami_nlp.pattern.hinges_stated import LAW_PLACES, check_law_place, law_at
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.sheet import Pattern
from origami_nlp.pattern.vertex import Vertex

NAME = re.compile(
    r"(?:(?P<of>creases|mountains|valleys|vertex|vertices)\.)?"
    r"(?P<what>\w+)(?:\[(?P<entry>\d{1,6})\])?"
)
SIGNS = {"creases": 0.0, "mountains": -1.0, "valleys": 1.0}
KEPT = {"sector_angles": "vertex", "x": "vertices", "y": "vertices", "loads": ""}
"""What may stand before the point, but for creases."""


@dataclass(frozen=True)
class Example:
    """An example, whose options are numbers that have names.

    Attributes
    ----------
    make
        Takes the options.
    options
        Their names.
    """

    make: Callable[..., Any]
    options: tuple[str, ...] = ()

    @staticmethod
    def of(name: str, pattern: bool, **given: Any) -> Example:
        """Return the example of a name, such as ``"miura:3x3"``, as a crease pattern or as one vertex."""
        word, size = examples.split_size(name)
        made = examples.BY_NAME.get(word)
        options = [*inspect.signature(made).parameters] if made else []
        if not pattern:
            return Example(partial(examples.by_name, name, **given), tuple(options))
        sized = dict(zip(("rows", "columns"), size, strict=True)) | given
        return Example(partial(_sheet, name, sized), ("rows", "columns", *options))


def _sheet(name: str, sized: Mapping[str, Any], **options: Any) -> Pattern:
    shape = {**sized, **options}
    for key in ("rows", "columns"):
        if (count := shape.pop(key, None)) is not None:
            shape[key] = int(count) if count == int(count) else count
    return examples.pattern(name if "rows" not in shape else name.partition(":")[0], **shape)


Numbered: TypeAlias = Scene | Pattern | Example


def with_numbers(of: Numbered, values: Mapping[str, float]) -> Scene | Pattern:
    """Return an origami with other numbers.

    Parameters
    ----------
    of
        Where the other numbers come from.  Of a scene whose symmetry is stated images under it get what a crease gets.
    values
        By name, see the module; set one after the other, ``ratio`` first.

    Returns
    -------
    Scene or Pattern
        With these.

    Raises
    ------
    OptionError
        If there is no such number.
    OrigamiError
        If a value does not fit.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import with_numbers
    >>> sheet = with_numbers(o.examples.pattern("miura:2x2"), {"mountains.stiffness": 0.5})
    >>> sorted(set(sheet.stiffness.tolist()))
    [0.025, 0.5]
    """
    bare = {name: re.sub(r"_deg(?=\[|$)", "", name) for name in values}
    left = {n: math.radians(values[k]) if n != k else values[k] for k, n in bare.items()}
    if isinstance(of, Example):
        of = of.make(**{k: left.pop(k) for k in bare.values() if k in of.options})
    origami: Any = of
    k, rest, preload = np.array(origami.stiffness), origami.rest.copy(), np.zeros(origami.creases)
    if "ratio" in left:
        k = _in_ratio(origami, left.pop("ratio"))
    scene = origami if isinstance(origami, Scene) else None
    preload += (scene.preload or 0.0) if scene else 0.0
    laws, loads, corners = list(origami.laws), [*scene.loads] if scene else [], {}
    sectors, wound = dict[int, float](), preload.copy()
    vertex: Any = scene and scene.vertex
    of_laws = dict[tuple[int, str], float]()
    for name, t in left.items():
        if scene and name == "alpha":
            vertex = Vertex(tuple(_at_alpha(scene, t)))
            continue
        what, which, sized = _named(origami, name)
        if what == "loads":
            for i in which:
                force: Any = tuple(t * f for f in loads[i].force or (0.0,) * 3)
                loads[i] = replace(loads[i], force=force)
        elif what in LAW_PLACES:  # of what is stated, whatever names it, and how often
            of_laws |= {(i, what): t for i in which}
        elif what == "sector_angles":
            sectors |= dict.fromkeys(which, t)
        elif what in "xy":
            corners[which[0], "xy".index(what)] = t
        elif what == "torque":
            wound[which] = preload[which] + t
        else:
            signed = origami.signs[which] if sized else 1.0
            {"stiffness": k, "rest_angles": rest, "preload": wound}[what][which] = t * signed
    for (i, what), t in of_laws.items():
        laws[i] = law_at(laws[i], what, t)
    if vertex and sectors:
        vertex = Vertex(_with_sectors(vertex, sectors), vertex.flat)
    if scene:
        own: Any = {"stiffness": k, "rest_angles": rest, "preload": wound}
        own = {key: tuple(v.tolist()) for key, v in own.items()}
        return replace(scene, vertex=vertex, laws=tuple(laws), loads=tuple(loads), **own)
    sheet = origami.with_springs(k.tolist(), rest.tolist())
    sheet = sheet.with_laws(laws) if laws else sheet
    return replace(sheet, corners=_moved(origami, corners)) if corners else sheet


def _named(of: Any, name: str) -> tuple[str, list[int], bool]:
    """Return what a name is of, which entries (from 0), and whether these are sizes of mountains and valleys."""
    creases = range(1, of.creases + 1)
    known = dict.fromkeys(("stiffness", "rest_angles", *LAW_PLACES), creases)
    if isinstance(of, Scene):
        known |= dict.fromkeys(("preload", "torque", "sector_angles"), creases)
        known |= {"loads": range(1, len(of.loads) + 1)} if of.loads else {}
    else:
        known |= dict.fromkeys("xy", range(len(of.corners)))
    match = NAME.fullmatch(name)
    what = match["what"] if match else ""
    if match is None or what not in known:
        more = ", ratio, alpha" if isinstance(of, Scene) else ", ratio"
        meant = did_you_mean(what, [*known, "ratio", "alpha"])
        raise OptionError(f"{name!r} is no number of it: write {', '.join(known)}{more}{meant}")
    entries, kind = known[what], match["of"]
    if match["entry"] is None and (what == "loads" or (kind in SIGNS and what not in KEPT)):
        sign = SIGNS.get(kind, 0.0)
        signs = np.sign(of.rest) if isinstance(of, Scene) else of.signs
        which = [i for i in range(len(entries)) if not sign or signs[i] == sign]
        if not which:
            raise OptionError(f"{name!r}: there are no {kind}")
        sized = what == "rest_angles" and not sign
    else:
        number = int(match["entry"] or -1)
        if number not in entries or kind not in (None, KEPT.get(what, "creases")):
            ends = f"{what}[{entries[0]}] to {what}[{entries[-1]}]"
            raise OptionError(f"{name!r} is no number of it: write {ends}")
        which, sized = _images(of, number - entries[0], what), False
    for i in which if what not in KEPT else ():
        check_law_place(of.laws, what, i)
    return what, which, sized


def _images(of: Any, entry: int, what: str) -> list[int]:
    """Return the creases, or facets, that a stated symmetry makes of one."""
    if not isinstance(of, Scene) or of.symmetry == "auto" or what == "loads":
        return [entry]
    facet = what == "sector_angles"
    moved = ((s - entry - facet) if mirrored else entry + s for s, mirrored in of.group.elements)
    return sorted({place % of.degree for place in moved})


def _in_ratio(of: Scene | Pattern, ratio: float) -> np.ndarray:
    """Return stiffnesses, those of mountains times sqrt(r / r_0), those of valleys over it."""
    check_law_place(of.laws, "ratio")
    mountain = of.rest < 0
    if mountain.all() or not mountain.any():
        raise OptionError("'ratio' is of mountains over valleys: there is only one of them")
    k = np.array(of.stiffness)
    log = np.log(k)
    # k_m / k_v = r, their geometric mean unchanged (paper, section 3: k_m = 0.025 sqrt(r), k_v = 0.025 / sqrt(r))
    now = log[mountain].mean() - log[~mountain].mean()
    return np.asarray(k * np.exp(np.where(mountain, 0.5, -0.5) * (math.log(ratio) - now)))


def _at_alpha(scene: Scene, t: float) -> list[float]:
    """Return sector angles of the paper's families, which are linear in alpha_1."""
    now = np.array(scene.vertex.sector_angles)
    for made in (examples.degree6, examples.degree8):
        zero, one = (np.array(made(a).vertex.sector_angles) for a in (0.5, 1.0))
        slope = np.round(2 * (one - zero))
        origin = zero - 0.5 * slope
        if len(zero) == len(now) and np.abs(origin + now[0] * slope - now).max() <= RESOLVED:
            return list((origin + t * slope).tolist())
    raise OptionError("'alpha' needs the sector angles of the families degree6 or degree8")


def _with_sectors(vertex: Vertex, given: Mapping[int, float]) -> tuple[float, ...]:
    """Return sector angles with those that are given; where the sheet is flat the others give way alike."""
    out, images = np.array(vertex.sector_angles), list(given)
    others = [i for i in range(len(out)) if i not in given]
    if vertex.flat and others:
        # the sum stays 2 pi
        out[others] -= (sum(given.values()) - out[images].sum()) / len(others)
    out[images] = list(given.values())
    return tuple(out.tolist())


def _moved(pattern: Pattern, given: Mapping[tuple[int, int], float]) -> np.ndarray:
    """Return corners with some coordinates changed."""
    if not pattern.is_flat or np.ptp(pattern.corners[:, 2]):
        raise OptionError("vertices are moved in the plane z = 0 of flat paper")
    out = pattern.corners.copy()
    out[tuple(zip(*given, strict=True))] = list(given.values())
    return out
