"""What drives a load path: a torque on creases, or a factor of the forces that a scene states."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.path import ParameterLine, load_line
from origami_nlp.pattern import Scene, dead_loads
from origami_nlp.programme import Model, Parameters


@dataclass(frozen=True)
class Driver:
    """A torque t on a crease and its images under the symmetry of the scene, or t times the scene's own forces.

    Attributes
    ----------
    scene
        As stated.
    crease
        Number (1-based) of the crease; None for the forces.
    """

    scene: Scene
    crease: int | None

    def __post_init__(self) -> None:
        n = self.scene.degree
        if self.crease is None:
            if not self.scene.loads:
                raise OptionError(
                    "crease = None: the scene has no [[loads]] with forces to be multiplied"
                )
        elif (
            isinstance(self.crease, bool)
            or not isinstance(self.crease, int)
            or not 1 <= self.crease <= n
        ):
            raise OptionError(f"crease = {self.crease!r} must be the number of a crease, 1 to {n}")

    @property
    def creases(self) -> tuple[int, ...]:
        """Creases (1-based) on each of which the torque acts; empty for forces."""
        if self.crease is None:
            return ()
        orbit = self.scene.group.orbit
        return tuple(i + 1 for i, o in enumerate(orbit) if o == orbit[self.crease - 1])

    @property
    def name(self) -> str:
        """What t is."""
        if self.crease is None:
            return "factor of the loads"
        numbers = ", ".join(map(str, self.creases))
        return (
            f"torque on each of creases {numbers}"
            if len(self.creases) > 1
            else f"torque on crease {numbers}"
        )

    @property
    def unit(self) -> str:
        """Of t."""
        return "" if self.crease is None else "N m"

    @property
    def farthest(self) -> float:
        """A t beyond which springs no longer matter: what would turn all of them once round."""
        total = 2 * math.pi * sum(self.scene.stiffness)
        arms = [
            float(np.linalg.norm(load.force or 0.0)) * load.place[0] for load in self.scene.loads
        ]
        if self.crease is not None:
            return total
        if not any(arms):
            raise OptionError("crease = None: all forces of the scene are zero")
        return total / sum(arms)

    @property
    def coordinate(self) -> str:
        """What the load works on, with its unit."""
        if self.crease is None:
            return "position of the loads along their forces [m]"
        return f"fold angle of crease {self.crease} [rad]"

    @property
    def unloaded(self) -> Scene:
        """The scene without what drives the path."""
        return self.scene if self.crease is not None else replace(self.scene, loads=())

    def conjugate(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return what the load works on at states [..., N]: an angle [rad], or where forces are along themselves [m].

        Several forces: sum f . p over the root of the sum of their squares.
        """
        phi = np.asarray(fold_angles, dtype=float)
        if self.crease is not None:
            return phi[..., self.crease - 1]
        dead = dead_loads(self.scene.loads, self.scene.held_facet)
        assert dead is not None
        work = -dead.energy(np.array(self.scene.vertex.sector_angles), phi)
        return work / float(np.linalg.norm(dead.forces))

    def line(self, scene: Scene) -> ParameterLine:
        """Return the programmes of `scene`, which is the driver's with its symmetry or without, over t."""
        model = Model(scene)
        p = model.parameters
        if self.crease is not None:
            loaded = model.variable_of_crease[np.array(self.creases) - 1]
            return load_line(model, np.bincount(loaded, minlength=model.size) / model.scale)
        assert p.dead is not None
        still = replace(p.dead, points=np.zeros_like(p.dead.points))
        zeros = [np.zeros_like(v) for v in (p.sectors, p.stiffness, p.rest, p.load)]
        change = Parameters(zeros[0], zeros[1], zeros[2], zeros[3], still)
        return ParameterLine(model, replace(p, dead=p.dead.times(0.0)), change)

    def scene_at(self, t: float) -> Scene:
        """Return the scene under the load t; its energy may differ from the path's by a constant."""
        name = f"{self.scene.label + ', ' if self.scene.label else ''}{self.name} = {t:.10g}"
        if self.crease is None:
            forces = [[t * f for f in load.force or ()] for load in self.scene.loads]
            pairs = zip(self.scene.loads, forces, strict=True)
            loads = tuple(replace(load, force=(f[0], f[1], f[2])) for load, f in pairs)
            return replace(self.scene, loads=loads, name=name)
        preload = np.array(self.scene.preload or np.zeros(self.scene.degree))
        preload[np.array(self.creases) - 1] += t
        return replace(self.scene, preload=tuple(preload.tolist()), name=name)
