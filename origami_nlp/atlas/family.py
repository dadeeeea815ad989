"""A family of scenes over one parameter, and the line of its programmes.

Names are those of sweep files: ``ratio``, ``alpha``, ``creases.stiffness[1]``, ``creases.rest_angles[1]``,
``creases.preload[1]``, ``vertex.sector_angles[1]``, where ``creases.`` and ``vertex.`` may be left out; several joined
by ``+`` take the same value.  ``torque[1]`` is added to the preload of a crease; ``loads`` is the factor of all forces
that the scene states, ``loads[1]`` that of one.  What a crease gets, its images under the symmetry get too.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from origami_nlp.errors import AngleError, OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.path import ParameterLine, line_between
from origami_nlp.pattern import Scene, Vertex, parse_angle
from origami_nlp.programme import Model, Parameters

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
UNITS = {
    "ratio": "",
    "alpha": "rad",
    "stiffness": "N m/rad",
    "rest_angles": "rad",
    "preload": "N m",
    "torque": "N m",
    "sector_angles": "rad",
    "loads": "",
}
"""Of what can be followed over."""
_PLACE = re.compile(
    r"(?:(?:creases\.)?(stiffness|rest_angles|preload|torque)|(?:vertex\.)?(sector_angles)|(loads))\[(\d{1,4})\]"
)
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
        ``"rad"``, ``"N m"``, ``"N m/rad"`` or ``""``.
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

    def drawn(self, t: float) -> float:
        """Return a value as axes have it: angles in degrees."""
        return math.degrees(t) if self.unit == "rad" else t

    @property
    def axis(self) -> str:
        """The name for an axis, with its unit."""
        unit = "deg" if self.unit == "rad" else self.unit
        return f"{self.name} [{unit}]" if unit else self.name

    def shown(self, t: float, digits: int = 6) -> str:
        """Return a value in words, angles in degrees."""
        if self.unit == "rad":
            return f"{math.degrees(t):.{digits}g} deg"
        return f"{t:.{digits}g} {self.unit}".rstrip()


def parse_over(text: str) -> Over:
    """Read ``NAME=FROM:TO``, angles in radians, as multiples of pi, or with ``deg``.

    Parameters
    ----------
    text
        Such as ``"ratio=0.01:100"``, ``"alpha=30deg:60deg"``, ``"rest_angles[1]=-pi:pi/2"`` or
        ``"torque[1]=-0.15:0"``.

    Returns
    -------
    Over
        The parameter and its range.

    Raises
    ------
    OptionError
        If it is not written so, an end is no number, or the range is empty.
    AngleError
        If an end of a range of angles is no angle.

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
    kinds = {_kind(part) for part in name.split("+")}
    if len(kinds) > 1:
        raise OptionError(f"over = {text!r}: what takes the same value must be of one kind")
    (kind,) = kinds
    log, unit = kind in ("ratio", "stiffness"), UNITS.get(kind, "rad")
    a, b = values
    if not a < b:
        raise OptionError(f"over = {text!r}: the range must run from a smaller to a larger value")
    if log and a <= 0:
        raise OptionError(f"over = {text!r}: {name} must be above 0")
    return Over(name, a, b, unit, log)


NEARBY = 1.3
"""A value without a range stands for the range from that share of it to that multiple; angles, and zero: 0.2 about."""


def _kind(name: str) -> str:
    """Return what a parameter is, a key of `UNITS`; the name itself where it is none."""
    match = _PLACE.fullmatch(name.strip())
    return next(v for v in match.groups()[:3] if v) if match else name.strip()


def parse_nearby(text: str) -> Over:
    """Read ``NAME=FROM:TO`` as `parse_over` does, or ``NAME=VALUE`` for a range around a value."""
    name, _, value = text.partition("=")
    if ":" in value or not value:
        return parse_over(text)
    t = _number(value, name.strip())
    if t and UNITS.get(_kind(name), "rad") != "rad":
        low, high = sorted((t / NEARBY, t * NEARBY))
        return parse_over(f"{name}={low!r}:{high!r}")
    return parse_over(f"{name}={t - 0.2!r}:{t + 0.2!r}")


def _number(text: str, name: str) -> float:
    match = _DEGREES.fullmatch(text.strip())
    if match:
        return math.radians(parse_angle(match[1], name))
    try:
        return parse_angle(text.strip(), name)
    except AngleError:
        if UNITS.get(_kind(name.partition("+")[0]), "rad") == "rad":
            raise
        raise OptionError(f"over: {name} = {text.strip()!r} must be a finite number") from None


@dataclass(frozen=True, eq=False)
class Family:
    """Scenes over one parameter t.

    Attributes
    ----------
    over
        The parameter and its range.
    scene_of
        Makes the scene at t; sector angles, rest angles, preload, forces and logarithms of stiffness must be linear in
        t (in ln t where `Over.log`).
    samples
        How many scenes are posed before it is followed, to see whether it is smooth.
    """

    over: Over
    scene_of: Callable[[float], Scene] = field(repr=False)
    samples: int = field(default=SAMPLES, repr=False)

    def scene(self, t: float) -> Scene:
        """Return the scene at t, named after it."""
        made = self.scene_of(t)
        label = f"{made.label}, " if made.label else ""
        return replace(made, name=f"{label}{self.over.name} = {t:.10g}")

    @cached_property
    def sampled(self) -> Callable[[float], Scene]:
        """`scene_of`, each scene made once: those that are posed here, and without their symmetry."""
        return lru_cache(maxsize=SAMPLES)(self.scene_of)

    @property
    def one_vertex(self) -> bool:
        """Whether all scenes along `line` are of one vertex."""
        return self.line.sector_angles is None

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
        where = np.linspace(low, high, self.samples)
        scenes = [self.sampled(over.t_of(float(s))) for s in where]
        names = [f"{over.name} = {over.t_of(float(s)):.6g}" for s in where]
        posed = posed_alike([Model(scene) for scene in scenes], over.name, names)
        self._check(posed, where)
        line = line_between(posed[0], posed[-1], high - low).from_here(-low)
        first, last = (np.array(scenes[k].vertex.sector_angles) for k in (0, -1))
        if (first != last).any():
            change = (last - first) / (high - low)
            line = replace(line, sector_angles=first - low * change, sector_change=change)
        return line

    def winding(self, s: float) -> float:
        """Return the energy that it took to wind preloaded springs at s, which states on the line do not count."""
        p, scale = self.line.at(s).parameters, self.line.programme.scale
        # k/2 (phi - phi0 - l/k)^2 = k/2 (phi - phi0)^2 - l phi + l phi0 + l^2 / (2 k)
        return scale * float(np.sum(p.load * (p.rest + 0.5 * p.load / p.stiffness)))

    def _check(self, posed: list[Model], where: np.ndarray) -> None:
        """Complain where the numbers of scenes are not linear in s."""
        # equal steps of s: numbers that are linear change by the same from scene to scene
        change = np.diff([linear_numbers(m.parameters) for m in posed], axis=0)
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


def linear_numbers(p: Parameters) -> np.ndarray:
    """Return the numbers that are linear along a line: in the order of `Parameters`, stiffness as its logarithm."""
    dead = [] if p.dead is None else [p.dead.vector]
    return np.concatenate([p.sectors, np.log(p.stiffness), p.rest, p.load, *dead])


def _posed_as(whole: Model, model: Model) -> Model:
    """Return a model with the structure and the scale of another, and preload as a load.

    A load is linear in the preload whatever the stiffness does; the angle to which it winds a spring is not.
    """
    p = model.parameters
    if model.scene.preload:
        rest = model.reduce(np.array(model.scene.rest_angles))
        load = model.reduce(np.array(model.scene.preload)) * model.multiplicity / model.scale
        p = replace(p, rest=rest, load=load)
    parameters = p.scaled(model.scale / whole.scale)
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
    base = replace(scene.of_one_winding, symmetry=scene.group.name)
    if over.name == "ratio":
        return Family(over, _over_ratio(base))
    if over.name == "alpha":
        return Family(over, _over_alpha(base))
    if over.name == "loads" and base.loads:
        return Family(over, _over_places(base, [("loads", k) for k in range(len(base.loads))]))
    places = []
    for name in over.name.split("+"):
        match = _PLACE.fullmatch(name.strip())
        most = len(base.loads) if match and match[3] else base.degree
        if match is None or not 1 <= int(match[4]) <= most:
            raise OptionError(
                f"over = {over.name!r} is no parameter of the scene: write ratio, alpha, stiffness[1], rest_angles[1], "
                f"preload[1], torque[1] or sector_angles[1], with entries 1 to {base.degree}"
                + (f", or loads, loads[1] to loads[{len(base.loads)}]" if base.loads else "")
            )
        places.append((_kind(name), int(match[4]) - 1))
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
    # k_m / k_v = r, their geometric mean unchanged (paper, section 3: k_m = 0.025 sqrt(r), k_v = 0.025 / sqrt(r))
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
        values = {
            "stiffness": list(scene.stiffness),
            "rest_angles": list(scene.rest_angles),
            "preload": list(scene.preload or (0.0,) * scene.degree),
        }
        sectors, loads = scene.vertex.sector_angles, list(scene.loads)
        for what, entry in places:
            if what == "sector_angles":
                sectors = _with_sector(scene, sectors, entry, t)
            elif what == "loads":
                x, y, z = scene.loads[entry].force or (0.0, 0.0, 0.0)
                loads[entry] = replace(loads[entry], force=(t * x, t * y, t * z))
            else:
                for i in _images(scene, entry, False):
                    given = scene.preload[i] if what == "torque" and scene.preload else 0.0
                    values["preload" if what == "torque" else what][i] = given + t
        vertex = scene.vertex
        if sectors != vertex.sector_angles:
            vertex = Vertex(sectors, vertex.flat)
        k, rest, preload = (tuple(v) for v in values.values())
        return replace(
            scene, vertex=vertex, stiffness=k, rest_angles=rest, preload=preload, loads=tuple(loads)
        )

    return at


def _with_sector(
    scene: Scene, sectors: tuple[float, ...], entry: int, t: float
) -> tuple[float, ...]:
    """Return sector angles with t at a facet and its images; where the sheet is flat the others give way alike."""
    images, out = _images(scene, entry, True), np.array(sectors)
    others = [i for i in range(len(out)) if i not in images]
    if scene.vertex.flat and not others:
        raise OptionError(
            f"vertex.sector_angles[{entry + 1}]: its images are all facets of the sheet"
        )
    if scene.vertex.flat:
        # the sum stays 2 pi
        out[others] -= len(images) * (t - out[entry]) / len(others)
    out[images] = t
    return tuple(out.tolist())
