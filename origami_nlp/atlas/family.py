"""A family of scenes over one parameter, and the line of its programmes.

Names are those of sweep files: ``ratio``, ``alpha``, ``creases.stiffness[1]``, ``creases.rest_angles[1]``,
``vertex.sector_angles[1]``; several joined by ``+`` take the same value.  What a crease gets, its images under the
symmetry of the scene get too.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.path import ParameterLine, line_between
from origami_nlp.pattern import Scene, Vertex, parse_angle
from origami_nlp.programme import Model

SAMPLES = 17
"""Scenes of a family that are posed before it is followed, to see whether it is smooth."""
FAMILIES = {
    "degree6": ((1.0, -2.0, 1.0, 1.0, -2.0, 1.0), (0.0, math.pi, 0.0, 0.0, math.pi, 0.0)),
    "degree8": (
        (1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0),
        tuple(math.pi / 2 * v for v in (0, 1, 1, 0, 0, 1, 1, 0)),
    ),
}
"""Sector angles of the paper's families: change with alpha_1, and value at alpha_1 = 0."""
_PLACE = re.compile(r"(creases\.stiffness|creases\.rest_angles|vertex\.sector_angles)\[(\d{1,4})\]")
_DEGREES = re.compile(r"(.*?)\s*deg")


@dataclass(frozen=True)
class Over:
    """What is followed over.

    Attributes
    ----------
    name
        Of the parameter, see the module.
    low, high
        From and to, in its unit.
    unit
        ``"rad"``, ``"N m/rad"`` or ``""``.
    log
        Whether steps are ratios.
    """

    name: str
    low: float
    high: float
    unit: str
    log: bool

    def s_of(self, t: float) -> float:
        """Return the number that is followed: t, or its logarithm."""
        return math.log(t) if self.log else t

    def t_of(self, s: float) -> float:
        """Return the parameter, exact at both ends of the range."""
        if s == self.s_of(self.low):
            return self.low
        if s == self.s_of(self.high):
            return self.high
        return math.exp(s) if self.log else s


def parse_over(text: str) -> Over:
    """Read ``NAME=FROM:TO``, angles in radians, as multiples of pi, or with ``deg``.

    Parameters
    ----------
    text
        Such as ``"ratio=0.01:100"``, ``"alpha=30deg:60deg"`` or ``"creases.rest_angles[1]=-pi:pi/2"``.

    Returns
    -------
    Over
        The parameter and its range.

    Raises
    ------
    OptionError
        If it is not written so, or the range is empty.
    AngleError
        If an end is no number.

    Examples
    --------
    >>> from origami_nlp.atlas import parse_over
    >>> parse_over("ratio=0.01:100").log
    True
    """
    name, equals, ends = text.partition("=")
    low, colon, high = ends.partition(":")
    if not equals or not colon:
        raise OptionError(f"over = {text!r} must be NAME=FROM:TO, such as ratio=0.01:100")
    name = name.strip()
    values = [_number(v, name) for v in (low, high)]
    log = name == "ratio" or name.startswith("creases.stiffness")
    unit = "" if name == "ratio" else "N m/rad" if log else "rad"
    a, b = values
    if not a < b:
        raise OptionError(f"over = {text!r}: the range must run from a smaller to a larger value")
    if log and a <= 0:
        raise OptionError(f"over = {text!r}: {name} must be above 0")
    return Over(name, a, b, unit, log)


NEARBY = 1.3
"""A value without a range stands for the range from that share of it to that multiple; angles: 0.2 rad about it."""


def parse_nearby(text: str) -> Over:
    """Read ``NAME=FROM:TO`` as `parse_over` does, or ``NAME=VALUE`` for a range around a value."""
    name, _, value = text.partition("=")
    if ":" in value or not value:
        return parse_over(text)
    t = _number(value, name.strip())
    wide = parse_over(f"{name}={t / NEARBY!r}:{t * NEARBY!r}") if t > 0 else None
    if wide is not None and wide.log:
        return wide
    return parse_over(f"{name}={t - 0.2!r}:{t + 0.2!r}")


def _number(text: str, name: str) -> float:
    match = _DEGREES.fullmatch(text.strip())
    if match:
        return math.radians(parse_angle(match[1], name))
    return parse_angle(text.strip(), name)


@dataclass(frozen=True, eq=False)
class Family:
    """Scenes over one parameter t.

    Attributes
    ----------
    over
        The parameter and its range.
    scene_of
        Makes the scene at t; sector angles, rest angles and logarithms of stiffness must be linear in t (in ln t where
        `Over.log`).
    """

    over: Over
    scene_of: Callable[[float], Scene] = field(repr=False)

    def scene(self, t: float) -> Scene:
        """Return the scene at t, named after it."""
        made = self.scene_of(t)
        label = f"{made.label}, " if made.label else ""
        return replace(made, name=f"{label}{self.over.name} = {t:.10g}")

    @cached_property
    def line(self) -> ParameterLine:
        """The programmes along it.

        Raises
        ------
        OptionError
            If scenes along it are not posed alike, or their numbers jump.
        """
        over = self.over
        low, high = over.s_of(over.low), over.s_of(over.high)
        where = np.linspace(low, high, SAMPLES)
        scenes = [self.scene_of(over.t_of(float(s))) for s in where]
        names = [f"{over.name} = {over.t_of(float(s)):.6g}" for s in where]
        posed = posed_alike([Model(scene) for scene in scenes], over.name, names)
        self._check(posed, where)
        line = line_between(posed[0], posed[-1], high - low).from_here(-low)
        first, last = (np.array(scenes[k].vertex.sector_angles) for k in (0, -1))
        if (first != last).any():
            change = (last - first) / (high - low)
            line = replace(line, sector_angles=first - low * change, sector_change=change)
        return line

    def _check(self, posed: list[Model], where: np.ndarray) -> None:
        """Complain where the numbers of scenes are not linear in s."""
        numbers = [
            np.concatenate(
                [m.parameters.sectors, np.log(m.parameters.stiffness), m.parameters.rest]
            )
            for m in posed
        ]
        change = np.diff(numbers, axis=0)
        apart = np.abs(change - np.median(change, axis=0)).max(axis=1)
        if apart.max() > RESOLVED:
            k = int(apart.argmax())
            a, b = (self.over.t_of(float(where[k + i])) for i in (0, 1))
            raise OptionError(
                f"the scenes over {self.over.name} do not change smoothly between {a:.6g} and {b:.6g}: "
                "these are two families, follow each alone"
            )


def posed_alike(models: list[Model], name: str, names: list[str]) -> list[Model]:
    """Return models with the structure and scale of the one that has most contacts.

    Raises
    ------
    OptionError
        If some have another symmetry, or contacts that this one has not; name: of the parameter, names: of the scenes.
    """
    whole = max(models, key=lambda m: len(m.structure.gaps))
    gaps = set(whole.structure.gaps)
    for model, where in zip(models, names, strict=True):
        group = model.scene.group.name
        if group != whole.scene.group.name or not set(model.structure.gaps) <= gaps:
            raise OptionError(
                f"{where}: symmetry {group} or the facets that may touch are not those of other scenes over {name}: "
                "state the symmetry, or follow a shorter range"
            )
    return [_posed_as(whole, model) for model in models]


def _posed_as(whole: Model, model: Model) -> Model:
    """Return a model with the structure and the scale of another."""
    parameters = model.parameters.scaled(model.scale / whole.scale)
    return whole.varied(parameters, np.array(model.scene.vertex.sector_angles))


def family_of(scene: Scene, over: Over) -> Family:
    """Return the scenes that differ from one in a parameter.

    Parameters
    ----------
    scene
        Where the other numbers come from; its symmetry is kept.
    over
        The parameter and its range.

    Returns
    -------
    Family
        The scenes.

    Raises
    ------
    OptionError
        If the scene has no such parameter.
    """
    base = replace(scene, symmetry=scene.group.name)
    if over.name == "ratio":
        return Family(over, _over_ratio(base))
    if over.name == "alpha":
        return Family(over, _over_alpha(base))
    places = []
    for name in over.name.split("+"):
        match = _PLACE.fullmatch(name.strip())
        if match is None or not 1 <= int(match[2]) <= base.degree:
            raise OptionError(
                f"over = {over.name!r} is no parameter of the scene: write ratio, alpha, creases.stiffness[1], "
                f"creases.rest_angles[1] or vertex.sector_angles[1], with entries 1 to {base.degree}"
            )
        places.append((match[1], int(match[2]) - 1))
    return Family(over, _over_places(base, places))


def _over_ratio(scene: Scene) -> Callable[[float], Scene]:
    """Multiply stiffnesses of mountains by sqrt(r / r_0), divide those of valleys by it."""
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    mountain = rest < 0
    if mountain.all() or not mountain.any():
        raise OptionError(
            "over = 'ratio' is the stiffness of mountains over that of valleys: the scene has only one of them"
        )
    log = np.log(k)
    now = log[mountain].mean() - log[~mountain].mean()
    side = np.where(mountain, 0.5, -0.5)

    def at(ratio: float) -> Scene:
        return replace(
            scene, stiffness=tuple((k * np.exp(side * (math.log(ratio) - now))).tolist())
        )

    return at


def _over_alpha(scene: Scene) -> Callable[[float], Scene]:
    sectors = np.array(scene.vertex.sector_angles)
    for slope, start in FAMILIES.values():
        if len(slope) != len(sectors):
            continue
        change, origin = np.array(slope), np.array(start)
        if np.abs(origin + sectors[0] * change - sectors).max() <= RESOLVED:
            return lambda t: replace(scene, vertex=Vertex(tuple((origin + t * change).tolist())))
    raise OptionError(
        "over = 'alpha' needs the sector angles of the families degree6 or degree8 (`origami-nlp example`)"
    )


def _images(scene: Scene, entry: int, facet: bool) -> list[int]:
    """Return the creases, or facets, that a symmetry of the scene makes of one."""
    n = scene.degree
    return sorted(
        {
            ((s - entry - facet) if mirrored else entry + s) % n
            for s, mirrored in scene.group.elements
        }
    )


def _over_places(scene: Scene, places: list[tuple[str, int]]) -> Callable[[float], Scene]:
    def at(t: float) -> Scene:
        k, rest = list(scene.stiffness), list(scene.rest_angles)
        sectors = np.array(scene.vertex.sector_angles)
        for what, entry in places:
            images = _images(scene, entry, what.startswith("vertex"))
            if what.startswith("vertex"):
                others = [i for i in range(len(sectors)) if i not in images]
                if scene.vertex.flat and not others:
                    raise OptionError(
                        f"{what}[{entry + 1}]: its images are all facets of the sheet"
                    )
                if scene.vertex.flat:  # the others give way alike
                    sectors[others] -= len(images) * (t - sectors[entry]) / len(others)
                sectors[images] = t
                continue
            for i in images:
                (k if what.endswith("stiffness") else rest)[i] = t
        vertex = Vertex(tuple(sectors.tolist()), scene.vertex.flat)
        return replace(scene, vertex=vertex, stiffness=tuple(k), rest_angles=tuple(rest))

    return at
