"""A scene posed: its variables and parameters, which contacts it has, and their names in words."""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any, Self

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.io import PrettyRepr, pick
from origami_nlp.numerics import SUMMED
from origami_nlp.pattern import Scene, dead_loads, limit_words
from origami_nlp.problem.compiled import Structure
from origami_nlp.problem.contact import Contact, FoldLimits, gap_weights
from origami_nlp.problem.gaps import Gap
from origami_nlp.problem.hinge_laws import HingeLaws
from origami_nlp.problem.model_reduction import enumerate_gaps, facet_of_ray
from origami_nlp.problem.parameters import Parameters


class Energies:
    """Energies of a problem in the units of its springs, from its `parameters`, which are over `scale`."""

    parameters: Any
    scale: float

    def energy(self, x: np.ndarray) -> float:
        """Elastic energy of a state, less the work of the load if there is one.

        Parameters
        ----------
        x
            The state, shape [n] [rad].

        Returns
        -------
        float
            In the scene's units.
        """
        return self.scale * float(self.parameters.energy(np.asarray(x)))

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Elastic energies of states, less the work of the load if there is one.

        Parameters
        ----------
        x
            States, shape [..., n] [rad].

        Returns
        -------
        numpy.ndarray
            Shape [...], in the scene's units.
        """
        return self.scale * self.parameters.energy(np.asarray(x))

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> float:
        """Energy of y less that of x, without cancellation for nearby states.

        Parameters
        ----------
        x, y
            States, shape [n] [rad].

        Returns
        -------
        float
            In the scene's units.
        """
        return self.scale * float(self.parameters.energy_change(x, y))

    def excess(self, x: np.ndarray) -> float:
        """Energy of a state above that of springs at rest under the load, over `scale`; inf under forces in space."""
        return float(self.parameters.excess(x))


class PosedProblem(Energies, PrettyRepr):
    """What of a scene is modelled, by name; printing it says what is modelled and what is not.

    Energies inside the problem are divided by `scale`, a power of two near the weighted mean
    stiffness, so that results scale exactly with the stiffness.

    Attributes
    ----------
    scene
        The scene.
    structure
        Form of the problem; scenes with equal structure share compiled functions and solvers.
    left_out
        What was not modelled, and why.
    parameters
        Sector angles, stiffness, rest angles and load of the variables.
    multiplicity
        How many creases each variable stands for, [n].
    fold_limits
        Of the variables: +-pi or stops; without contact +-2 pi, beyond which shapes repeat.
    """

    sparse = False
    redundant = False

    def __init__(self, scene: Scene) -> None:
        check_type("scene", scene, Scene)
        self.scene = scene
        # what `Model.refuses` said: geometry alone decides, and problems with other springs or loads share it
        self._answered: dict[tuple[bytes, float, bytes], str] = {}
        group = scene.group
        creases = [ray.crease for ray in group.rays if ray.crease is not None]
        gaps, pairs, self.left_out = enumerate_gaps(scene)
        of_creases = [scene.laws[c] for c in creases] if scene.laws else []
        self.structure = Structure(
            kind=group.kind,
            order=group.order,
            has_crease=tuple(ray.crease is not None for ray in group.rays),
            limits=scene.contact != "none",
            gaps=gaps,
            pairs=pairs,
            flat_sheet=scene.vertex.flat,
            winding=scene.winding or 1,
            dead=()
            if (dead := dead_loads(scene.loads, scene.fixed_facet)) is None
            else (dead.held, *dead.facets),
            laws=tuple(law is not None for law in of_creases),
        )
        crease_rays = [r for r, ray in enumerate(group.rays) if ray.crease is not None]
        position = {r: v for v, r in enumerate(crease_rays)}
        self.variable_of_crease = np.array([position[r] for r in group.orbit])
        self.multiplicity = np.bincount(self.variable_of_crease)
        first = np.unique(self.variable_of_crease, return_index=True)[1]
        reach = 1 if self.has_limits else 2  # without contact each further turn repeats the shape
        self.fold_limits = FoldLimits(*(reach * scene.limit_angles[:, first]))
        # creases of one orbit agree to a tolerance: the mean keeps the energy of symmetric states right
        k = np.bincount(self.variable_of_crease, scene.stiffness)
        rest = np.bincount(self.variable_of_crease, scene.wound_angles) / self.multiplicity
        # preload winds linear springs (`wound_angles`); beside laws it is a load
        beside = [m if law else 0.0 for m, law in zip(scene.preload, scene.laws, strict=False)]
        load = np.bincount(self.variable_of_crease, beside or np.zeros(scene.degree))
        self.scale = 2.0 ** round(math.log2(k.mean()))
        sectors = [ray.sector for ray in group.rays]
        if group.kind == "D":
            sectors = sectors[:-1]
        laws = HingeLaws.of(of_creases, self.multiplicity) if of_creases else None
        springs = Parameters(np.array(sectors), k, rest, load, dead, laws)
        self.parameters = springs.scaled(1 / self.scale)

    def varied(self, parameters: Parameters, sector_angles: np.ndarray | None = None) -> Self:
        """Return the same problem with other numbers; it shares the compiled functions.

        Parameters
        ----------
        parameters
            Of the problem, over the same `scale`.
        sector_angles
            Of the whole vertex, shape [N] [rad], where they change; special relations are not made exact.
        """
        other = object.__new__(type(self))
        vars(other).update(vars(self))
        for name in ("own_symmetries", "_chain"):  # they depend on the numbers
            vars(other).pop(name, None)
        other.parameters = parameters
        if sector_angles is not None:
            # unseen: a step may look beyond the angles that make a vertex before it comes back
            other.scene, vertex = copy.copy(self.scene), copy.copy(self.scene.vertex)
            object.__setattr__(vertex, "sector_angles", tuple(sector_angles.tolist()))
            object.__setattr__(other.scene, "vertex", vertex)
        return other

    @property
    def size(self) -> int:
        """Number of variables n."""
        return len(self.multiplicity)

    @property
    def equation_count(self) -> int:
        """Number of loop-closure equations."""
        s = self.structure
        # vec q = 0 without symmetry, H e2 = e2 with a mirror; a pie-shaped piece of n > 1 leaves one angle to be right
        one_turn = 3 if s.kind == "C" else 2
        return one_turn if s.order == s.winding else 1

    @property
    def dof(self) -> int:
        """Degrees of freedom at a regular state: variables less equations."""
        return self.size - self.equation_count

    @property
    def has_limits(self) -> bool:
        """Whether fold limits are imposed: |phi| <= pi, or stops."""
        return self.structure.limits

    @property
    def symmetry(self) -> str:
        """Name of the group that states of the problem keep."""
        return self.scene.group.name

    @cached_property
    def limits(self) -> tuple[Contact, ...]:
        """Both fold limits of every variable, where they are imposed."""
        return self.fold_limits.both if self.has_limits else ()

    @cached_property
    def walls(self) -> tuple[int, ...]:
        """Positions of the gaps that are one-sided by themselves: mirrors and the axis."""
        return tuple(i for i, gap in enumerate(self.structure.gaps) if gap.type != "facet-pair")

    @cached_property
    def every_gap(self) -> tuple[Contact, ...]:
        """Every gap, on its positive side."""
        return tuple(Contact("gap", i, 1) for i in range(len(self.structure.gaps)))

    @cached_property
    def gaps(self) -> tuple[Contact, ...]:
        """Every gap once (a crease on a facet belongs to two facet pairs), on its positive side."""
        same = self.structure.first_gaps
        return tuple(Contact("gap", i, 1) for i in range(len(same)) if same[i] == i)

    @cached_property
    def own_symmetries(self) -> tuple[tuple[np.ndarray, int], ...]:
        """Maps x -> sign x[order] [n] that the springs and sectors have without being imposed, the identity first.

        Turned about the vertex, reflected in a plane across the sheet, or reflected in the sheet (which changes the
        sign of every fold).  Only the identity where a symmetry is imposed already, or forces pull in space.
        """
        n, i = self.size, np.arange(self.size)
        p = self.parameters
        found = [(i, 1)]
        if not self.scene.group.is_trivial or not p.plain:
            return tuple(found)
        a = p.sectors
        for shift, mirrored, sign in itertools.product(range(n), (False, True), (1, -1)):
            # crease i goes to shift - i, and its sector, between creases i and i + 1, to that between shift - i - 1 and
            # shift - i
            order = (shift - i) % n if mirrored else (i + shift) % n
            sectors = a[(shift - i - 1) % n] if mirrored else a[order]
            if (shift, mirrored, sign) == (0, False, 1):
                continue
            same = np.abs(sectors - a).max() <= SUMMED
            if same and (p.stiffness[order] == p.stiffness).all():
                if (
                    (sign * p.rest[order] == p.rest).all()
                    and (sign * p.load[order] == p.load).all()
                    and self.fold_limits.same(order, sign)
                ):
                    found.append((order, sign))
        return tuple(found)

    @property
    def bound(self) -> float:
        """Largest |fold angle|: pi or less, or 2 pi without contact, where each further turn repeats the shape."""
        return float(np.abs([self.fold_limits.low, self.fold_limits.high]).max())

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
        """Return all N fold angles from the variables.

        Parameters
        ----------
        x
            States, shape [..., n] [rad].

        Returns
        -------
        numpy.ndarray
            Shape [..., N] [rad], valley positive.
        """
        return np.asarray(x)[..., self.variable_of_crease]

    def reduce(self, fold_angles: np.ndarray) -> np.ndarray:
        """Return the variables of a symmetric state: means over its orbits.

        Parameters
        ----------
        fold_angles
            States, shape [..., N] [rad].

        Returns
        -------
        numpy.ndarray
            Shape [..., n] [rad].
        """
        phi = np.asarray(fold_angles, dtype=float)
        out = np.zeros((*phi.shape[:-1], self.size))
        for crease, v in enumerate(self.variable_of_crease):
            # mean over the orbit: the projection onto symmetric fold angles
            out[..., v] += phi[..., crease]
        return out / self.multiplicity

    def check_time(self) -> None:
        """Do nothing: searches of one vertex look at the time themselves."""

    def doubt(self, x: np.ndarray) -> str:
        """Return why it is not known whether a state is admissible: it always is."""
        return ""

    def to_second_order(self, contacts: tuple[Contact, ...]) -> tuple[Contact, ...]:
        """Return contacts that stay open to second order as well: rays on facets do so."""
        return contacts

    @cached_property
    def root(self) -> np.ndarray:
        """The metric of all N fold angles: y = root x, root = sqrt(multiplicity), [n]."""
        return np.sqrt(self.multiplicity)

    def _to_plain(self) -> dict[str, Any]:
        left_out = [pick(item, "what", "why") for item in self.left_out]
        sizes = ("variables=size", "equalities=equation_count", "inequalities=inequality_count")
        return pick(self, *sizes, "contact_pairs", left_out=left_out)

    @property
    def contact_pairs(self) -> list[tuple[int, int]]:
        """Facet pairs (1-based) that may cross and are modelled."""
        return [(self.facet_of_ray(i), self.facet_of_ray(j)) for i, j in self.structure.pairs]

    @property
    def inequality_count(self) -> int:
        """Number of inequalities: fold limits, mirror and axis contacts, four rows a facet pair."""
        return (2 * self.size if self.has_limits else 0) + len(self.structure.gaps)

    def gap_name(self, gap: Gap) -> str:
        """Describe what a gap is."""
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

    def name(self, contact: Contact) -> str:
        """Describe which contact it is.

        Parameters
        ----------
        contact
            Of this problem.

        Returns
        -------
        str
            With the creases or facets that touch, 1-based.
        """
        if not contact.is_limit:
            return self.gap_name(self.structure.gaps[contact.index])
        creases = self.creases_of(contact.index)
        where = f"at crease{'s' * (len(creases) > 1)} " + ", ".join(map(str, creases))
        return f"phi = {contact.where} {where}"

    def weight(self, contact: Contact) -> int:
        """How many single contacts of the vertex it stands for: its multiplier over this is the moment at each."""
        if contact.is_limit:
            return int(self.multiplicity[contact.index])
        return self.structure.gaps[contact.index].weight

    def sides(self, contact: Contact) -> tuple[int, ...]:
        """Sides on which a contact may be open: both for a ray on a facet."""
        one = contact.is_limit or contact.index in self.walls
        return (contact.side,) if one else (1, -1)

    def weights(self, contacts: Sequence[Contact], multipliers: np.ndarray) -> np.ndarray:
        """Spread multipliers [..., r] of contacts over the gaps, [..., c], for the Hessian of a Lagrangian."""
        return gap_weights(len(self.structure.gaps), contacts, multipliers)

    def __repr__(self) -> str:
        who = self.scene.label or f"{self.scene.vertex!r}"
        counts = f"{self.size} fold angles, {self.equation_count} equalities"
        return f"Model({who}: {counts}, {self.inequality_count} inequalities, symmetry {self.scene.group.name})"

    def __str__(self) -> str:
        scene, lines = self.scene, []
        group, turn, w = scene.group, self.structure.turn, self.structure.winding
        often = f"{w} " if w > 1 else ""
        once = {
            ("C", 1): "vec(q) = 0, q = product of all folds",
            ("D", 1): "H e2 = e2: h_x = h_z = 0, H = folds of half the vertex",
        }
        several = {
            ("C", 1): "T = -1, T = product of the folds and sectors of a period",
            ("D", 1): "H n_k = n_1, H = folds of the wedge",
        }
        form = (once if w == 1 else several).get(
            (group.kind, turn),  # type: ignore[arg-type]
            f"n_1 . H n_k = -cos({often}pi/{group.order}), H = folds of the wedge"
            if group.kind == "D"
            else f"scalar of q Q(e3, 2 pi/{group.order}) = cos({often}pi/{group.order}), q = folds of a period",
        )
        winds = f", states that wind {w} times round its axis" * (w > 1)
        lines.append(
            f"Model of {self.scene.label or self.scene.vertex!r}, symmetry {group.name}{winds}"
        )
        lines.append(f"  variables     {self.size}: fold angles")
        for v in range(self.size):
            creases = ", ".join(str(c) for c in self.creases_of(v))
            lines.append(
                f"                  phi of crease{'s' if ',' in creases else ''} {creases}"
            )
        lines.append(f"  equalities    {self.equation_count}: {form}")
        lines.append(f"  inequalities  {self.inequality_count}")
        if self.has_limits:
            limits = f": {limit_words(scene.limits)}" if scene.limits else " |phi| <= pi"
            lines.append(f"                  {2 * self.size} fold limits{limits}")
        for gap in self.structure.gaps:
            if gap.type != "facet-pair":
                lines.append(f"                  {self.gap_name(gap)} (gap >= 0)")
        if pairs := [f"{i} and {j}" for i, j in self.contact_pairs]:
            each = " each" if len(pairs) > 1 else ""
            lines.append(
                f"                  facets {', '.join(pairs)}: a separating plane{each}, 4 rows "
                "(3 more variables and |n| = 1, only while a solve needs it)"
            )
        lines += [f"  load          {line}" for line in scene.load_lines]
        lines.append(
            f"  parameters    {self.parameters.vector.size}: sector angles, stiffness, rest angles, load"
        )
        lines.append(
            f"  geometry      special relations of sector angles, runs of up to {scene.relations.longest}"
        )
        lines += [f"                  {line}" for line in scene.relations.lines]
        lines.append("  left out")
        lines += [f"                  {item.what}: {item.why}" for item in self.left_out]
        return "\n".join(lines)
