"""Numbers of an origami by name: what states are followed over, and what a sweep sets.

Of a vertex they are ``creases.stiffness[1]``, ``creases.rest_angles[1]``, ``creases.preload[1]``,
``vertex.sector_angles[1]``, where ``creases.`` and ``vertex.`` may be left out, numbered from 1; with ``_deg`` before
the entry in degrees.  ``torque[1]`` is added to the preload of a crease; ``loads`` is the factor of all forces that the
scene states, ``loads[1]`` that of one.  ``law_scale[1]`` multiplies the hinge law of a crease as it is stated (of wells
and detents that is their depth), ``law_shift[1]`` moves it towards valley.  ``ratio`` is the stiffness of mountains
over that of valleys, ``alpha`` the sector angle alpha_1 of the paper's families.  Of patterns they are ``ratio`` and
those of `pattern.with_places`; of an example by name its options too.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.paths.parameter_range import IN_DEGREES, meant_by
from origami_nlp.pattern import (
    LAW_PLACES,
    Pattern,
    Scene,
    Vertex,
    check_law_place,
    examples,
    law_at,
    with_places,
)

PLACE = re.compile(
    r"(?:creases\.)?(stiffness|rest_angles|preload|torque|law_scale|law_shift)\[(\d{1,4})\]"
    r"|(?:vertex\.)?(sector_angles)\[(\d{1,4})\]|(loads)\[(\d{1,4})\]"
)


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


Stated = Scene | Pattern | Example


def with_numbers(of: Stated, values: Mapping[str, float]) -> Scene | Pattern:
    """Return an origami with other numbers.

    Parameters
    ----------
    of
        Where the other numbers come from.  Of a scene whose symmetry is stated images under it get what a crease gets.
    values
        By name, see the module.

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
    """
    made: Any = of
    bare = {name: IN_DEGREES.sub("", name) for name in values}
    left = {n: math.radians(values[k]) if n != k else values[k] for k, n in bare.items()}
    if isinstance(made, Example):
        made = made.make(**{k: left.pop(k) for k in bare.values() if k in made.options})
    if "ratio" in left:
        k = tuple(_in_ratio(made, left.pop("ratio")))
        made = made.with_springs(k) if isinstance(made, Pattern) else replace(made, stiffness=k)
    return with_places(made, left) if isinstance(made, Pattern) else _scene_with(made, left)


def _in_ratio(of: Scene | Pattern, ratio: float) -> list[float]:
    """Return stiffnesses, those of mountains times sqrt(r / r_0), those of valleys over it."""
    check_law_place(of.laws, "ratio")
    k = np.array(of.stiffness)
    mountain = np.array(of.rest_angles if isinstance(of, Scene) else of.rest) < 0
    if mountain.all() or not mountain.any():
        raise OptionError("'ratio' is of mountains over valleys: there is only one of them")
    log = np.log(k)
    # k_m / k_v = r, their geometric mean unchanged (paper, section 3: k_m = 0.025 sqrt(r), k_v = 0.025 / sqrt(r))
    now = log[mountain].mean() - log[~mountain].mean()
    side = np.where(mountain, 0.5, -0.5)
    return list((k * np.exp(side * (math.log(ratio) - now))).tolist())


def _scene_with(scene: Scene, values: Mapping[str, float]) -> Scene:
    """Return a scene with numbers at places, ``alpha`` or ``loads``."""
    given = ("stiffness", "rest_angles", "loads", "laws")
    lists: dict[str, list[Any]] = {name: list(getattr(scene, name)) for name in given}
    lists["preload"] = list(preload := scene.preload or (0.0,) * scene.degree)
    vertex, sectors = scene.vertex, dict[int, float]()
    for name, t in values.items():
        if name == "alpha":
            vertex = Vertex(tuple(_at_alpha(scene, t)))
            continue
        what, entry = _place(scene, name)
        if what == "loads":
            for k in range(len(scene.loads)) if entry < 0 else (entry,):
                force: Any = tuple(t * f for f in scene.loads[k].force or (0.0,) * 3)
                lists["loads"][k] = replace(scene.loads[k], force=force)
            continue
        check_law_place(scene.laws, what, entry)
        for i in _images(scene, entry, what == "sector_angles"):
            if what == "sector_angles":
                sectors[i] = t
            elif what in LAW_PLACES:
                # of what is stated: an image may be named as well
                lists["laws"][i] = law_at(scene.laws[i], what, t)
            elif what == "torque":
                lists["preload"][i] = preload[i] + t
            else:
                lists[what][i] = t
    if sectors:
        vertex = Vertex(_with_sectors(vertex, sectors), vertex.flat)
    changed: Any = {name: tuple(v) for name, v in lists.items()}
    return replace(scene, vertex=vertex, **changed)


def _place(scene: Scene, name: str) -> tuple[str, int]:
    """Return what a name is of, and which entry (0-based; -1: all)."""
    match = PLACE.fullmatch(name)
    what, number = [*filter(None, match.groups())] if match else (name, "0")
    most = len(scene.loads) if what == "loads" else scene.degree
    if not 1 - (what == name == "loads" and most > 0) <= int(number) <= most:
        known = "stiffness, rest_angles, preload, torque, sector_angles, law_scale or law_shift"
        more = f", or loads, loads[1] to loads[{len(scene.loads)}]" if scene.loads else ""
        how = f"write ratio, alpha, or {known} with entries 1 to {scene.degree}{more}"
        raise OptionError(f"{name!r} is no number of the scene: {how}{meant_by(name)}")
    return what, int(number) - 1


def _images(scene: Scene, entry: int, facet: bool) -> Sequence[int]:
    """Return the creases, or facets, that a stated symmetry makes of one."""
    if scene.symmetry == "auto":
        return (entry,)
    moved = ((s - entry - facet) if mirrored else entry + s for s, mirrored in scene.group.elements)
    return sorted({place % scene.degree for place in moved})


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
