"""Scenes over two parameters, and the lines of problems across their plane."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from origami_nlp.continuation import Line, ParameterLine
from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.paths.alike import linear_numbers, same_problem, sector_line
from origami_nlp.paths.family import Family, family_of
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.pattern import LAW_NUMBER, DeadLoads, Scene
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Parameters

GRID = 7
"""Scenes along each parameter that are posed before anything is followed."""


@dataclass(frozen=True, eq=False)
class Plane:
    """Scenes that differ from one in two parameters.

    Attributes
    ----------
    scene
        Where the other numbers come from.
    parameters
        Both parameters with their ranges.
    """

    scene: Scene
    parameters: tuple[ParameterRange, ParameterRange]

    def __post_init__(self) -> None:
        for parameter in self.parameters:
            if LAW_NUMBER.fullmatch(parameter.name):
                raise OptionError(
                    f"{parameter.name}: a number within a hinge law is followed over alone; of two parameters "
                    "law_scale[1] and law_shift[1] can be"
                )

    def family(self, value: float, axis: int = 0) -> Family:
        """Return the scenes over the first parameter (axis 0) or the second at one value of the other."""
        along, other = self.parameters[axis], self.parameters[1 - axis]
        made = family_of(family_of(self.scene, other).scene_of(value), along)
        return replace(made, like=self._like)

    @cached_property
    def _like(self) -> PatternProblem:
        """Whose scale and numbers of contacts all problems of the plane take."""
        return pose(self.scene)

    @cached_property
    def corner(self) -> np.ndarray:
        """Values that are followed (logarithms of ratios) at the lower ends, [2]."""
        return np.array([parameter.ends[0] for parameter in self.parameters])

    @cached_property
    def size(self) -> np.ndarray:
        """Lengths of both ranges, [2]."""
        return np.array([parameter.ends[1] for parameter in self.parameters]) - self.corner

    def values(self, point: np.ndarray) -> tuple[float, float]:
        """Return both parameters in their units at a point [2] of the plane of s."""
        a, b = (
            parameter.t_of(float(s)) for parameter, s in zip(self.parameters, point, strict=True)
        )
        return a, b

    @cached_property
    def _posed(self) -> tuple[PatternProblem, np.ndarray, np.ndarray]:
        """A problem, the numbers of the lower corner, and their change with s, [2, .]."""
        shares = np.linspace(0.0, 1.0, GRID)
        scenes = [self._scene(self.corner + self.size * (a, b)) for a in shares for b in shares]
        made = [(scene, pose(scene)) for scene in scenes]
        made[0][1].numbered_as(self._like)
        alike = same_problem(made, self.parameters[0].name, [scene.label for scene in scenes])
        posed = np.array([linear_numbers(m.parameters) for m in alike]).reshape(GRID, GRID, -1)
        first = (posed[-1, 0] - posed[0, 0]) / self.size[0]
        second = (posed[0, -1] - posed[0, 0]) / self.size[1]
        i, j = (self.size[k] * shares for k in (0, 1))
        # what two edges of the plane say of its inside
        flat_plane = posed[0, 0] + i[:, None, None] * first + j[None, :, None] * second
        if np.abs(flat_plane - posed).max() > RESOLVED:
            raise OptionError(
                f"the scenes over {self.parameters[0].name} and {self.parameters[1].name} do not change smoothly"
            )
        return alike[0], posed[0, 0], np.array([first, second])

    def _scene(self, point: np.ndarray) -> Scene:
        t, u = self.values(point)
        return self.family(u).scene(t)

    def line(self, point: np.ndarray, direction: np.ndarray, weight: float) -> Line:
        """Return the problems along a direction [2] from a point [2] of the plane of s."""
        whole, origin, slopes = self._posed
        m = whole.parameters
        none = np.zeros(0) if m.dead is None else m.dead.vector
        lengths = [len(v) for v in (m.sectors, m.stiffness, m.rest, m.load, none)]
        cut = np.cumsum(lengths)[:-1]
        # logarithms of stiffness among them: log-linear along every line
        at = origin + (point - self.corner) @ slopes
        sectors, log_k, rest, load, dead = np.split(at, cut)
        d_sectors, d_k, d_rest, d_load, d_dead = np.split(direction @ slopes, cut)
        k, laws, d_laws = np.exp(log_k), m.laws, m.laws
        if m.laws is not None:  # in the places of their springs, see `linear_numbers`
            has = m.laws.weight != 0
            laws = replace(m.laws, weight=np.where(has, k, 0.0), shift=np.where(has, rest, 0.0))
            d_laws = replace(m.laws, weight=has * d_k, shift=has * d_rest)
            k, rest = np.where(has, m.stiffness, k), np.where(has, m.rest, rest)
            d_k, d_rest = np.where(has, 0.0, d_k), np.where(has, 0.0, d_rest)
        if (sectors != m.sectors).any():
            whole = whole.shaped(sectors)
        line = ParameterLine(
            whole,
            Parameters(sectors, k, rest, load, _forces(m.dead, dead), laws),
            Parameters(d_sectors, d_k, d_rest, d_load, _forces(m.dead, d_dead), d_laws),
            weight,
        )
        return sector_line(line, sectors, d_sectors, 0.0, 1.0)


def _forces(like: DeadLoads | None, vector: np.ndarray) -> DeadLoads | None:
    """Return forces with the points and values of a vector, see `DeadLoads.vector`."""
    if like is None:
        return None
    table = vector.reshape(-1, 5)
    return replace(like, points=table[:, :2], forces=table[:, 2:])
