"""A scene posed as a nonlinear programme: what is modelled, what is left out, and its numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.pattern import Scene
from origami_nlp.programme.choose import enumerate_gaps, facet_of_ray
from origami_nlp.programme.compiled import Functions, Structure, compile_structure
from origami_nlp.programme.gaps import Gap


@dataclass(frozen=True)
class Local:
    """Values and first derivatives at one state x; energies are divided by `Model.scale`.

    gradient: of the energy, [n].  closure, closure_jacobian: [m], [m, n].
    gaps, gaps_jacobian: of `Structure.gaps`, facet pairs without sign, [c], [c, n].
    """

    gradient: np.ndarray
    closure: np.ndarray
    closure_jacobian: np.ndarray
    gaps: np.ndarray
    gaps_jacobian: np.ndarray


class Model:
    """The nonlinear programme of a scene; printing it says what is modelled and what is not.

    Energies inside the programme are divided by `scale`, a power of two near the weighted mean
    stiffness, so that results scale exactly with the stiffness.

    Attributes
    ----------
    scene
        The scene.
    structure
        Form of the programme; scenes with equal structure share compiled functions and solvers.
    left_out
        What was not modelled, and why.
    parameters
        Values of the programme's parameters: sector angles, weighted stiffness / scale, rest
        angles.
    """

    def __init__(self, scene: Scene) -> None:
        check_type("scene", scene, Scene)
        self.scene = scene
        group = scene.group
        gaps, pairs, self.left_out = enumerate_gaps(scene)
        self.structure = Structure(
            kind=group.kind,
            order=group.order,
            has_crease=tuple(ray.crease is not None for ray in group.rays),
            limits=scene.contact != "none",
            gaps=gaps,
            pairs=pairs,
            flat_sheet=scene.vertex.flat,
        )
        crease_rays = [r for r, ray in enumerate(group.rays) if ray.crease is not None]
        position = {r: v for v, r in enumerate(crease_rays)}
        self.variable_of_crease = np.array([position[r] for r in group.orbit])
        self.multiplicity = np.bincount(self.variable_of_crease)
        # creases of one orbit agree to a tolerance: the mean keeps the energy of symmetric states right
        k = np.bincount(self.variable_of_crease, scene.stiffness)
        rest = np.bincount(self.variable_of_crease, scene.rest_angles) / self.multiplicity
        self.scale = 2.0 ** round(math.log2(k.mean()))
        sectors = [ray.sector for ray in group.rays]
        if group.kind == "D":
            sectors = sectors[:-1]
        self.parameters = np.concatenate([sectors, k / self.scale, rest])

    def __getstate__(self) -> dict[str, object]:
        """Leave compiled functions behind: they do not travel, and are made again where they are needed."""
        return {key: value for key, value in self.__dict__.items() if key != "functions"}

    @property
    def size(self) -> int:
        """Number of variables n."""
        return len(self.multiplicity)

    @property
    def equation_count(self) -> int:
        """Number of loop-closure equations."""
        return {("C", 1): 3, ("D", 1): 2}.get((self.structure.kind, self.structure.order), 1)

    @property
    def freedom(self) -> int:
        """Degrees of freedom at a regular state: variables less equations."""
        return self.size - self.equation_count

    @cached_property
    def functions(self) -> Functions:
        """Symbols and compiled functions, shared by all scenes of the same structure."""
        return compile_structure(self.structure)

    @property
    def softness(self) -> float:
        """Softest spring over the mean one: how small a torque still matters."""
        k = self.parameters[-2 * self.size : -self.size]
        return float(k.min() / k.mean())

    @property
    def step_noise(self) -> float:
        """Length of a Newton step [rad] that is only rounding: 1e-10, more with very soft springs."""
        return max(1e-10, 1e-15 / self.softness)

    @property
    def bound(self) -> float:
        """Largest |fold angle|: pi, or 2 pi without contact, where each further turn repeats the shape."""
        return math.pi if self.structure.limits else 2 * math.pi

    def creases_of(self, variable: int) -> tuple[int, ...]:
        """Return the creases (1-based) whose fold angle is variable number `variable` (0-based)."""
        return tuple((np.flatnonzero(self.variable_of_crease == variable) + 1).tolist())

    def crease_of_ray(self, r: int) -> int:
        """Return the crease (1-based) on ray r of the piece; for C_n also of its images."""
        crease = self.scene.group.rays[r % len(self.scene.group.rays)].crease
        if self.structure.kind == "C":
            return r + 1
        assert crease is not None
        return crease + 1

    def facet_of_ray(self, r: int) -> int:
        """Return the facet (1-based) that starts at, or for a mirror ray contains, ray r."""
        return facet_of_ray(self.scene, r) + 1

    def expand(self, x: np.ndarray) -> np.ndarray:
        """Return all N fold angles from the variables, shapes [..., n] -> [..., N]."""
        return np.asarray(x)[..., self.variable_of_crease]

    def reduce(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return the variables of a symmetric state, shapes [..., N] -> [..., n] (means of orbits)."""
        phi = np.asarray(fold_angles, dtype=float)
        out = np.zeros((*phi.shape[:-1], self.size))
        for crease, v in enumerate(self.variable_of_crease):
            out[..., v] += phi[..., crease]
        return out / self.multiplicity

    def energy(self, x: np.ndarray) -> float:
        """Elastic energy in the scene's units."""
        n = self.size
        k, rest = self.parameters[-2 * n : -n], self.parameters[-n:]
        return float(0.5 * self.scale * np.sum(k * (np.asarray(x) - rest) ** 2))

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> float:
        """Energy of y less that of x, in the scene's units, without cancellation for nearby states."""
        n = self.size
        k, rest = self.parameters[-2 * n : -n], self.parameters[-n:]
        return float(self.scale * np.sum(k * (y - x) * ((x - rest) + 0.5 * (y - x))))

    def local(self, x: np.ndarray) -> Local:
        """Evaluate values and first derivatives at x."""
        grad, g, jac, gaps, jac_gaps = self.functions.evaluators["local"](x, self.parameters)
        n = self.size
        return Local(
            grad.ravel(), g.ravel(), jac.reshape(-1, n), gaps.ravel(), jac_gaps.reshape(-1, n)
        )

    def closure(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate the loop-closure equations and their Jacobian at x."""
        g, jac = self.functions.evaluators["closure"](x, self.parameters)
        return g.ravel(), jac

    def hessian(
        self, x: np.ndarray, lam: np.ndarray, mu: np.ndarray, weight: float = 1.0
    ) -> np.ndarray:
        """Evaluate the Hessian of weight U + lam . closure + mu . gaps at x."""
        return self.functions.evaluators["hessian"](x, self.parameters, weight, lam, mu)[0]

    def rays(self, x: np.ndarray) -> np.ndarray:
        """Return the deformed rays of the piece at x, shape [rays, 3]."""
        return self.functions.evaluators["rays"](x, self.parameters)[0].T

    def on_sheet(self, x: np.ndarray) -> bool:
        """Tell whether x is on the sheet q = +1 (q = -1 closes too but is no sheet of paper)."""
        return bool(self.functions.evaluators["sheet"](x, self.parameters)[0][0, 0] > 0)

    @property
    def contact_pairs(self) -> list[tuple[int, int]]:
        """Facet pairs (1-based) that may cross and are modelled."""
        return [(self.facet_of_ray(i), self.facet_of_ray(j)) for i, j in self.structure.pairs]

    @property
    def inequality_count(self) -> int:
        """Number of inequalities: fold limits, mirror and axis contacts, four rows a facet pair."""
        return (2 * self.size if self.structure.limits else 0) + len(self.structure.gaps)

    def gap_name(self, gap: Gap) -> str:
        """Say in words what a gap is."""
        if gap.type == "facet-pair":
            k, j = gap.rays
            on = f"on facet {self.facet_of_ray(j)}"
            if self.scene.group.rays[k % len(self.scene.group.rays)].crease is None:
                return f"mirror ray of facet {self.facet_of_ray(k)} {on}"
            return f"crease {self.crease_of_ray(k)} {on}"
        r, _ = gap.rays
        ray = self.scene.group.rays[r]
        who = f"facet {self.facet_of_ray(r)}" if ray.crease is None else f"crease {ray.crease + 1}"
        return f"{who} on the axis" if gap.type == "axis" else f"{who} on its mirror image"

    def __repr__(self) -> str:
        scene, lines = self.scene, []
        group = scene.group
        form = {
            ("C", 1): "vec(q) = 0, q = product of all folds",
            ("D", 1): "H e2 = e2: h_x = h_z = 0, H = folds of half the vertex",
        }.get(
            (group.kind, group.order),
            f"n_1 . H n_k = -cos(pi/{group.order}), H = folds of the wedge"
            if group.kind == "D"
            else f"scalar of q Q(e3, 2 pi/{group.order}) = cos(pi/{group.order}), q = folds of a period",
        )
        lines.append(f"Model of {self.scene.label or self.scene.vertex!r}, symmetry {group.name}")
        lines.append(f"  variables     {self.size}: fold angles")
        for v in range(self.size):
            creases = ", ".join(str(c) for c in self.creases_of(v))
            lines.append(
                f"                  phi of crease{'s' if ',' in creases else ''} {creases}"
            )
        lines.append(f"  equalities    {self.equation_count}: {form}")
        lines.append(f"  inequalities  {self.inequality_count}")
        if self.structure.limits:
            lines.append(f"                  {2 * self.size} fold limits |phi| <= pi")
        for gap in self.structure.gaps:
            if gap.type != "facet-pair":
                lines.append(f"                  {self.gap_name(gap)} (gap >= 0)")
        for i, j in self.contact_pairs:
            lines.append(
                f"                  facets {i} and {j}: a separating plane, 4 rows "
                "(3 more variables and |n| = 1, only while a solve needs it)"
            )
        lines.append(
            f"  parameters    {len(self.parameters)}: sector angles, stiffness, rest angles"
        )
        lines.append(
            f"  geometry      special relations of sector angles, runs of up to {scene.relations.longest}"
        )
        lines += [f"                  {line}" for line in scene.relations.lines]
        lines.append("  left out")
        lines += [f"                  {item.what}: {item.why}" for item in self.left_out]
        return "\n".join(lines)
