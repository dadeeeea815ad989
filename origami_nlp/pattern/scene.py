"""A scene: a vertex, its torsional springs, the symmetry to keep and the contact to respect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, get_args

import numpy as np

from origami_nlp.arguments import check_angles, check_number, check_whole, shown
from origami_nlp.errors import OptionError, SceneError, SymmetryError
from origami_nlp.io import PrettyRepr, cut, is_unicode
from origami_nlp.numerics import INPUT_TOL, NARROW, SUMMED, energy_or_zero
from origami_nlp.pattern.fold_limits import (
    Contact,
    Limits,
    limit_words,
    read_limits,
    read_panels,
)
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinges_stated import (
    energy_with_laws,
    law_numbers,
    read_hinges,
    seen_laws,
)
from origami_nlp.pattern.loads import Load, dead_loads, read_loads
from origami_nlp.pattern.numbers_read import (
    format_angle,
    read_preload,
    read_rest_angles,
)
from origami_nlp.pattern.one_vertex import one_vertex
from origami_nlp.pattern.origami import Origami
from origami_nlp.pattern.relations import Relations, find_relations
from origami_nlp.pattern.sheet import Pattern
from origami_nlp.pattern.symmetry import (
    Symmetry,
    averaged,
    check_winding,
    find_symmetry,
    windings_of,
)
from origami_nlp.pattern.vertex import Vertex

MOST_CREASES = 1_000
"""Of a scene; `model` then takes seconds."""
MOST_PAIRED = 400
"""Creases of a scene with full contact, 80,000 pairs of facets; `model` then takes seconds."""


@dataclass(frozen=True)
class Scene(PrettyRepr, Origami):
    """Everything the user states of one vertex: creases, springs, symmetry, contact, loads.

    Parameters
    ----------
    vertex
        The crease pattern.
    stiffness
        Torsional stiffness k_i > 0 of each crease, shape [N] [N m/rad], or one for all; the largest at most 1e8 times
        the smallest.
    rest_angles
        Stress-free fold angles phi0_i in [-pi, pi], shape [N] [rad], valley > 0; numbers or strings.
    symmetry
        ``"none"``, ``"C<n>"``, ``"D<n>"``, or ``"auto"``: the largest group that geometry and mechanics share.  States
        keep this symmetry.
    contact
        ``"full"`` (facets never cross), ``"fold-limits"`` (adjacent facets only: |phi| <= pi) or ``"none"``.
    mirror
        For ``"D<n>"``: a crease (1-based) on a mirror, where there are several sets of mirrors; default: that of lowest
        number.
    symmetry_tolerance
        Angles [rad] and relative stiffnesses that differ by less count as equal for the symmetry (raise it from 1e-9
        for measured data), and are averaged over the group; `adjusted` says by how much.
    name
        A title for tables and figures.
    preload
        Torque m_i that each crease has beside k_i (phi0_i - phi_i), shape [N] [N m], towards valley > 0; default: none.
        The spring is wound to `wound_angles`, at most 1,000 rad; a hinge law keeps its energy, less m_i phi_i.
    loads
        Dead loads: each a `Load`, or a table that states one; with `fixed_facet`, for states without symmetry.
    fixed_facet
        Number (1-based) of the facet that is fixed where forces pull: what they do to the states depends on it.
    winding
        How often states of C_n or D_n, n > 2, wind round the axis of their symmetry: an odd number up to n.  Default: a
        search looks at all of `windings`, anything else at states that wind once.
    limits
        Fold limits of each crease [rad], pairs (low, high) within +-pi, shape [N, 2], or one pair for all: stops before
        facets meet.  Default: +-pi.  A rest angle may lie beyond; it then presses the crease against its stop.
    panels
        Thickness of the panels and width of the taper beside their hinges [mm], which narrow the limits
        (`tapered_limit`): kinematics are those of paper, all hinges in the middle surface.  None: paper.
    laws
        A `HingeLaw` for each crease, or None for its linear spring, [N]; () where all are linear.  Where there is a law
        `stiffness` is its mean size and `rest_angles` its lowest angle, whatever is stated.
    source
        What was read, as it was typed: a file, or an example; reports are titled by it.
    relations
        Special relations of the sector angles that hold, or nearly held and were made exact (by at most 1e-7 rad,
        `relations.moved`).  Decided here unless given.

    Attributes
    ----------
    group
        The symmetry that was found or asked for.
    wound_angles
        Angles at which the springs have no torque, phi0_i + m_i/k_i, shape [N] [rad].
    adjusted
        Largest change of an angle [rad] or relative change of a stiffness that symmetry asked for.

    Raises
    ------
    SceneError
        If a value does not fit; the message names the field, the value and the fix.
    SymmetryError
        If geometry and mechanics do not share the symmetry asked for.
    AngleError
        If a rest angle is no angle.

    Examples
    --------
    >>> from origami_nlp import Scene, Vertex
    >>> scene = Scene(Vertex(("pi/2",) * 4), stiffness=(1, 1, 1, 1), rest_angles=("pi/2", 0, "pi/2", 0))
    >>> scene.group.name, round(scene.energy([0, 0, 0, 0]), 6)
    ('D2', 2.467401)
    """

    PLAIN = ("scene_to_dict", "scene_from_dict")

    vertex: Vertex
    stiffness: tuple[float, ...]
    rest_angles: tuple[float, ...]
    symmetry: str = "auto"
    contact: Contact = "full"
    mirror: int | None = None
    name: str | None = None
    symmetry_tolerance: float = INPUT_TOL
    preload: tuple[float, ...] = ()
    loads: tuple[Load, ...] = ()
    fixed_facet: int | None = None
    winding: int | None = None
    limits: Limits = ()
    panels: tuple[float, float] | None = None
    laws: tuple[HingeLaw | None, ...] = ()
    source: str = field(default="", repr=False, compare=False)
    relations: Relations = field(default=None, repr=False, compare=False)  # type: ignore[assignment]
    group: Symmetry = field(init=False, repr=False, compare=False)
    adjusted: float = field(init=False, repr=False, compare=False, default=0.0)

    def __post_init__(self) -> None:
        if not isinstance(self.vertex, Vertex):
            raise SceneError(f"vertex = {shown(self.vertex)} must be a Vertex")
        n = self.vertex.degree
        if not isinstance(self.contact, str) or self.contact not in get_args(Contact):
            known = ", ".join(get_args(Contact))
            raise SceneError(f"contact = {shown(self.contact)} is unknown: use one of {known}")
        if n > (MOST_PAIRED if self.contact == "full" else MOST_CREASES):
            most = f"at most {MOST_CREASES}, and {MOST_PAIRED} with contact = 'full'"
            raise SceneError(f"vertex has {n} creases: {most}; use contact = 'fold-limits'")
        self.check_wide()
        if self.name is not None and not (isinstance(self.name, str) and is_unicode(self.name)):
            raise SceneError(f"name = {shown(self.name)} must be text, without half surrogates")
        check_number("symmetry_tolerance", self.symmetry_tolerance, INPUT_TOL, 0.1, SceneError)
        self._set(panels=read_panels(self.panels))
        rest = read_rest_angles(self.rest_angles, n)
        stated = self.stiffness, rest, self.limits, self.laws
        stiffness, rest, limits, laws = read_hinges(n, *stated, self.contact, self.panels)
        self._set(stiffness=stiffness, rest_angles=rest, limits=limits, laws=laws)
        self._set(loads=read_loads(self.loads, self.vertex.sector_angles))
        self._set(preload=read_preload(self.preload, stiffness, rest))
        if self.fixed_facet is not None or self.loads:
            what = "fixed_facet, which facet is held where forces pull,"
            check_whole(what, self.fixed_facet, 1, self.degree, SceneError)
        # relations are looked for in the vertex as stated, unless they are known
        if self.relations is None or self.relations.sector_angles != self.vertex.sector_angles:
            found = find_relations(self.vertex.sector_angles)
            self._set(relations=found)
            if found.moved:
                self._set(vertex=self.vertex.with_angles(found.sector_angles))
        self._set(group=self._find_symmetry())
        if not self.group.is_trivial:
            self._make_symmetric()
        check_winding(self.winding, self.group, self.contact)

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def windings(self) -> tuple[int, ...]:
        """How often its states may wind round the axis of their symmetry: `windings_of`, or the one asked for."""
        return (self.winding,) if self.winding else windings_of(self.group, self.contact)

    @property
    def of_one_winding(self) -> Scene:
        """The scene with one winding: the one asked for, else 1."""
        return replace(self, winding=1) if len(self.windings) > 1 else self

    @property
    def of_each_winding(self) -> tuple[Scene, ...]:
        """The scenes, one for each of `windings`, that together have its states; the scene itself comes first."""
        return (self, *(replace(self, winding=w) for w in self.windings[1:]))

    def _find_symmetry(self) -> Symmetry:
        """Find the symmetry that geometry and mechanics share; forces keep none."""
        wanted = self.symmetry
        if self.loads:
            if wanted not in ("auto", "none"):
                what = f"symmetry = {shown(wanted)} is not shared by loads: use none or auto"
                raise SymmetryError(what)
            wanted = "none"
        angles = [self.rest_angles, self.wound_angles, *self.limit_angles, *law_numbers(self.laws)]
        how = wanted, self.mirror, self.symmetry_tolerance
        return find_symmetry(self.vertex, self.stiffness, angles, *how)

    def _make_symmetric(self) -> None:
        """Average what is equal only up to `symmetry_tolerance`, until the group finds nothing left to average."""
        stated = self._numbers
        while True:
            elements = self.group.elements
            sectors = averaged(self.vertex.sector_angles, elements, facets=True)
            own = self.rest_angles, self.stiffness, self.preload, *self.limit_angles
            rest, k, preload, *stops = (
                averaged(values, elements, facets=False) if len(values) else () for values in own
            )
            wound = np.divide(preload, k) if preload else ()
            made = [sectors, rest, wound, *(stops if self.limits else ()), k]
            if _change(made, self._numbers) <= SUMMED:
                return
            vertex = self.vertex.with_angles(sectors)
            exact = find_relations(vertex.sector_angles).exact
            found = replace(self.relations, sector_angles=vertex.sector_angles, exact=exact)
            limits = read_limits(tuple(zip(*stops, strict=True)), len(k)) if self.limits else ()
            self._set(adjusted=_change(made, stated), vertex=vertex, relations=found, limits=limits)
            self._set(stiffness=k, rest_angles=rest, preload=preload)
            self._set(group=self._find_symmetry())

    @property
    def _numbers(self) -> tuple[Any, ...]:
        """Sector angles, rest angles, angles by which preload winds the springs, stated limits, stiffness."""
        wound = np.divide(self.preload, self.stiffness) if self.preload else ()
        limits = self.limit_angles if self.limits else ()
        return self.vertex.sector_angles, self.rest_angles, wound, *limits, self.stiffness

    @property
    def wound_angles(self) -> tuple[float, ...]:
        """Angles at which the springs have no torque, phi0_i + m_i/k_i, shape [N] [rad]."""
        if not self.preload:
            return self.rest_angles
        return tuple(np.add(self.rest_angles, np.divide(self.preload, self.stiffness)).tolist())

    @property
    def without_symmetry(self) -> Scene:
        """The same vertex, springs and contact without imposed symmetry."""
        return replace(self, symmetry="none", mirror=None, winding=None)

    @property
    def kind_words(self) -> str:
        """What it is called where it has no name."""
        angles = cut([f"{a:.6g}" for a in np.degrees(self.vertex.sector_angles)])
        return f"vertex with sector angles {angles} deg"

    @property
    def paper(self) -> Pattern:
        """The sheet, its crease i between corners 0 and i (1-based), with springs at their `wound_angles`."""
        paper = one_vertex(self.vertex, self.stiffness, self.wound_angles, self.label)
        limits = tuple(map(tuple, self.limit_angles.T.tolist())) if self.limits else ()
        return replace(paper, limits=limits, laws=self.laws)

    @property
    def degree(self) -> int:
        """Number of creases N."""
        return self.vertex.degree

    @property
    def creases(self) -> int:
        """The same."""
        return self.vertex.degree

    @property
    def rest(self) -> np.ndarray:
        """Rest angles as an array, [N] [rad]."""
        return np.array(self.rest_angles)

    @property
    def is_flat(self) -> bool:
        """Whether the paper lies flat."""
        return self.vertex.flat

    @property
    def is_symmetric(self) -> bool:
        """Whether states are asked to keep a symmetry."""
        return not self.group.is_trivial

    def relabelled(self, creases: np.ndarray, sign: float) -> Scene:
        """Return a scene without symmetry and loads under other labels of its creases.

        Parameters
        ----------
        creases
            Which comes first, second, ..., one way round or the other, [N].
        sign
            Of fold angles: -1 where the paper is turned over.

        Returns
        -------
        Scene
            The same vertex.
        """
        backward = (creases[1] - creases[0]) % self.degree != 1
        sectors = np.array(self.vertex.sector_angles)[creases - backward]
        vertex = Vertex(tuple(sectors.tolist()), self.vertex.flat)
        limits = self.limit_angles[:, creases]
        limits = -limits[::-1] if sign < 0 else limits
        turned = (
            tuple((sign * np.array(values)[creases] + 0.0).tolist()) if len(values) else ()
            for values in (self.rest_angles, self.preload)
        )
        rest, preload = turned
        return Scene(
            vertex,
            tuple(np.array(self.stiffness)[creases].tolist()),
            rest,
            symmetry="none",
            contact=self.contact,
            preload=preload,
            limits=tuple(map(tuple, limits.T.tolist())) if self.limits else (),
            laws=seen_laws(tuple(self.laws[i] for i in creases if self.laws), sign < 0),
            relations=replace(self.relations, sector_angles=vertex.sector_angles, moved=0.0),
        )

    def check_wide(self) -> None:
        """Raise an error where a facet is too narrow for the contact that is asked for.

        Raises
        ------
        SceneError
            With the sector and its angle.
        """
        narrow = min(self.vertex.sector_angles)
        if self.contact == "full" and narrow < NARROW:
            where = f"sector_angles[{self.vertex.sector_angles.index(narrow) + 1}] = {narrow:.6g}"
            cure = "use contact = 'fold-limits', or merge its creases"
            raise SceneError(f"{where} is narrower than {NARROW:g} rad, as contact needs: {cure}")

    def check_no_forces(self, what: str) -> None:
        """Raise an error where forces pull in space, which `what` does not know.

        Parameters
        ----------
        what
            Of the scene, in words.

        Raises
        ------
        OptionError
            If the scene has such loads.
        """
        if self.loads:
            why = f"not decided with dead loads ({self.loads[0].words}), but with preload"
            raise OptionError(f"{what}: {why}")

    @property
    def load_lines(self) -> list[str]:
        """What reports say of preload and forces."""
        lines = []
        if self.preload:
            each = enumerate(zip(self.preload, self.wound_angles, strict=True), start=1)
            at = [f"crease {i} {m:g} N m (spring wound to {w:.6g} rad)" for i, (m, w) in each if m]
            law = ", of a law U - preload phi" * any(self.laws)
            lines = [f"preload: {', '.join(at)}", f"U = sum k/2 (phi - phi0 - preload/k)^2{law}"]
        if self.loads:
            lines += [load.words for load in self.loads]
            axes = f"x along crease {self.fixed_facet}, z its normal"
            lines.append(
                f"facet {self.fixed_facet} is fixed: {axes}; energies less force . position"
            )
        return lines

    def energy(self, fold_angles: object) -> np.ndarray | float:
        """Energy U = sum k_i/2 (phi_i - phi0_i)^2 (paper, eq. 3.1), phi0 the `wound_angles`, less the work of loads.

        With preload m this is sum k_i/2 (phi_i - rest_i)^2 - m_i (phi_i - rest_i) + m_i^2/(2 k_i): what it takes to
        wind the springs counts, so that the elastic energy is never negative.  Forces f at points p add -sum f . p,
        p in the frame of the fixed facet.

        Parameters
        ----------
        fold_angles
            States, shape [..., N] [rad], valley positive.

        Returns
        -------
        float or numpy.ndarray
            Shape [...], in the units of the stiffness times rad^2 (J for N m/rad); a float for one state.

        Raises
        ------
        AngleError
            If `fold_angles` are not numbers [rad], N a state (NaN is allowed: its energy is NaN).
        """
        phi = check_angles("fold_angles", fold_angles, self.degree, finite=False)
        k, rest = np.array(self.stiffness), np.array(self.wound_angles)
        energy = energy_or_zero(energy_with_laws(phi, k, rest, self.laws, self.preload), k)
        if (dead := dead_loads(self.loads, self.fixed_facet)) is not None:
            energy = energy + dead.energy(np.array(self.vertex.sector_angles), phi)
        return float(energy) if energy.ndim == 0 else energy

    def torque(self, fold_angles: np.ndarray) -> np.ndarray:
        """Torques dU/dphi of the hinges, without forces.

        Parameters
        ----------
        fold_angles
            States [..., N] [rad].

        Returns
        -------
        numpy.ndarray
            [..., N] [N m].
        """
        phi = np.asarray(fold_angles, float)
        out = np.array(self.stiffness) * (phi - self.wound_angles)
        for i, law in enumerate(self.laws):
            if law is not None:
                out[..., i] = law.torque(phi[..., i]) - (self.preload[i] if self.preload else 0.0)
        return out

    def __repr__(self) -> str:
        who = self.label or f"{self.vertex!r}"
        return f"Scene({who}: degree {self.degree}, symmetry {self.group.name}, contact {self.contact})"

    def __str__(self) -> str:
        k, preload = (", ".join(f"{v:.6g}" for v in own) for own in (self.stiffness, self.preload))
        rest = ", ".join(format_angle(a) for a in self.rest_angles)
        parts = [f"{self.vertex}", f"stiffness=[{k}] N m/rad", f"rest_angles=[{rest}] rad"]
        parts += [f"preload=[{preload}] N m"] * bool(preload)
        parts += [f"law of crease {i}: {law}" for i, law in enumerate(self.laws, start=1) if law]
        parts += [f"limits: {limit_words(self.limits)}"] * bool(self.limits)
        parts += [f"load: {load.words}, facet {self.fixed_facet} fixed" for load in self.loads]
        parts += [f"symmetry={self.symmetry!r} -> {self.group.name}, contact={self.contact!r}"]
        return f"Scene({self.label and self.label + ': '}" + ",\n  ".join(parts) + ")"


def _change(new: Sequence[Any], old: Sequence[Any]) -> float:
    """Return the largest change of angles [rad] and, relatively, of the stiffnesses, which come last."""
    pairs = zip(new[:-1], old[:-1], strict=True)
    angles = [np.abs(np.subtract(a, b)).max(initial=0.0) for a, b in pairs]
    return float(max(*angles, np.abs(np.divide(new[-1], old[-1]) - 1).max()))
