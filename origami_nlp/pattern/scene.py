"""A scene: a vertex, its torsional springs, the symmetry to keep and the contact to respect."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np

from origami_nlp.arguments import check_angles, shown
from origami_nlp.errors import SceneError
from origami_nlp.files import Full, is_unicode, printable
from origami_nlp.numerics import RESOLVED, SUMMED, TYPED
from origami_nlp.pattern.angles import format_angle, parse_angles
from origami_nlp.pattern.relations import Relations, find_relations
from origami_nlp.pattern.symmetry import Symmetry, averaged, find_symmetry
from origami_nlp.pattern.vertex import Vertex

Contact = Literal["full", "fold-limits", "none"]
MOST_CREASES = 1_000
"""Of a scene; `model` then takes seconds."""
MOST_PAIRED = 400
"""Creases of a scene with full contact, 80,000 pairs of facets; `model` then takes seconds."""
LARGEST_RATIO = 1e8
"""Largest ratio of two stiffnesses.  At 1e12 the torque of a soft spring is below the rounding of a stiff one's: along
a line of states that only soft springs order, every point seems to balance, and a search never ends."""
SMALLEST, LARGEST = 1e-300, 1e300
"""Bounds of a stiffness, in any unit: energies beyond them overflow, or lose digits."""


@dataclass(frozen=True)
class Scene(Full):
    """Everything the user states.

    Parameters
    ----------
    vertex
        The crease pattern.
    stiffness
        Torsional stiffness k_i > 0 of each crease, shape [N] [N m/rad]; the largest at most 1e8 times the smallest.
    rest_angles
        Stress-free fold angles phi0_i in [-pi, pi], shape [N] [rad], valley > 0; numbers or
        strings.
    symmetry
        ``"none"``, ``"C<n>"``, ``"D<n>"``, or ``"auto"``: the largest group that geometry and
        mechanics share.  States keep this symmetry.
    contact
        ``"full"`` (facets never cross), ``"fold-limits"`` (adjacent facets only: |phi| <= pi) or
        ``"none"``.
    mirror
        For ``"D<n>"`` only: a crease (1-based) that lies on a mirror, where the vertex has several
        sets of mirrors to choose from.  Default: the mirror through the crease of lowest number.
    symmetry_tolerance
        Angles [rad] and relative stiffnesses that differ by less count as equal when the symmetry is looked
        for (raise it from 1e-9 for measured data).  The scene is made exactly symmetric by averaging over the
        group; `adjusted` says by how much.
    name
        A title for tables and figures.
    relations
        Special relations of the sector angles: which hold, which nearly hold and were made exact by moving
        sector angles (by at most 1e-7 rad, `relations.moved`), and which are different.  Decided here; an
        earlier decision for the same angles is kept.

    Attributes
    ----------
    group
        The symmetry that was found or asked for.
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

    vertex: Vertex
    stiffness: tuple[float, ...]
    rest_angles: tuple[float, ...]
    symmetry: str = "auto"
    contact: Contact = "full"
    mirror: int | None = None
    name: str | None = None
    symmetry_tolerance: float = TYPED
    relations: Relations = field(default=None, repr=False, compare=False)  # type: ignore[assignment]
    group: Symmetry = field(init=False, repr=False, compare=False)
    adjusted: float = field(init=False, repr=False, compare=False, default=0.0)

    def __post_init__(self) -> None:
        if not isinstance(self.vertex, Vertex):
            raise SceneError(f"vertex = {shown(self.vertex)} must be a Vertex")
        n = self.vertex.degree
        if n > MOST_CREASES:
            raise SceneError(
                f"vertex has {n} creases: at most {MOST_CREASES}, since its symmetries are looked for in N^2 steps"
            )
        if n > MOST_PAIRED and self.contact == "full":
            raise SceneError(
                f"vertex has {n} creases: with contact = 'full', which keeps every two facets apart, at most "
                f"{MOST_PAIRED}; use contact = 'fold-limits'"
            )
        stiffness = _numbers(self.stiffness, "stiffness", n)
        for i, k in enumerate(stiffness, start=1):
            if not (math.isfinite(k) and k > 0):
                raise SceneError(f"stiffness[{i}] = {k!r} must be positive and finite [N m/rad]")
        _check_range(stiffness)
        rest = parse_angles(self.rest_angles, "rest_angles")
        _same_length(rest, "rest_angles", n)
        for i, a in enumerate(rest, start=1):
            if abs(a) > math.pi * (1 + 1e-15):
                raise SceneError(
                    f"rest_angles[{i}] = {a:.6g} is outside [-pi, pi]: fold angles are radians, "
                    "valley positive"
                )
        if not isinstance(self.contact, str) or self.contact not in get_args(Contact):
            raise SceneError(
                f"contact = {shown(self.contact)} is unknown: use one of {', '.join(get_args(Contact))}"
            )
        for i, a in enumerate(self.vertex.sector_angles, start=1):
            if self.contact == "full" and a < RESOLVED:
                raise SceneError(
                    f"sector_angles[{i}] = {a:.6g} is narrower than {RESOLVED:g} rad: contact at so narrow a "
                    "facet is below the accuracy of contacts (1e-8); use contact = 'fold-limits', or merge its creases"
                )
        if self.name is not None and not isinstance(self.name, str):
            raise SceneError(f"name = {shown(self.name)} must be text")
        if self.name is not None and not is_unicode(self.name):
            raise SceneError(f"name = {self.name!r} holds half a surrogate pair: leave it out")
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "rest_angles", rest)
        if self.relations is None or self.relations.sector_angles != self.vertex.sector_angles:
            relations = find_relations(self.vertex.sector_angles)
            object.__setattr__(self, "relations", relations)
            if relations.moved:
                moved = Vertex(relations.sector_angles, self.vertex.flat)
                object.__setattr__(self, "vertex", moved)
        tolerance = self.symmetry_tolerance
        if isinstance(tolerance, bool) or not isinstance(tolerance, int | float):
            raise SceneError(f"symmetry_tolerance = {shown(tolerance)} must be a number [rad]")
        if not TYPED <= tolerance <= 0.1:
            raise SceneError(
                f"symmetry_tolerance = {shown(tolerance)} must lie between 1e-9 and 0.1 rad"
            )
        wanted = self.symmetry, self.mirror, tolerance
        group = find_symmetry(self.vertex, stiffness, rest, *wanted)
        object.__setattr__(self, "group", group)
        if not group.is_trivial:
            self._make_symmetric(*wanted)

    def _make_symmetric(self, *wanted: Any) -> None:
        """Average sector angles, stiffness and rest angles over the group, then cut the piece anew.

        Averaged values may share a larger group within the tolerance, or another mirror: what is kept is exactly
        symmetric.  What differs by no more than rounding stays as it is.
        """
        stated = self.vertex.sector_angles, self.rest_angles, self.stiffness
        while True:
            elements = self.group.elements
            sectors = averaged(self.vertex.sector_angles, elements, facets=True)
            rest = averaged(self.rest_angles, elements, facets=False)
            k = averaged(self.stiffness, elements, facets=False)
            if (
                _change(
                    (sectors, rest, k),
                    (self.vertex.sector_angles, self.rest_angles, self.stiffness),
                )
                <= SUMMED
            ):
                return
            object.__setattr__(self, "adjusted", _change((sectors, rest, k), stated))
            object.__setattr__(self, "vertex", Vertex(sectors, self.vertex.flat))
            found = find_relations(self.vertex.sector_angles)
            record = replace(
                self.relations, sector_angles=self.vertex.sector_angles, exact=found.exact
            )
            object.__setattr__(self, "relations", record)
            object.__setattr__(self, "stiffness", k)
            object.__setattr__(self, "rest_angles", rest)
            object.__setattr__(self, "group", find_symmetry(self.vertex, k, rest, *wanted))

    @property
    def label(self) -> str:
        """The name as it may be shown (`printable`), empty where there is none."""
        return printable(self.name or "")

    @property
    def degree(self) -> int:
        """Number of creases N."""
        return self.vertex.degree

    def energy(self, fold_angles: object) -> np.ndarray | float:
        """Elastic energy U = sum k_i/2 (phi_i - phi0_i)^2 (paper, eq. energy).

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
        k, rest = np.array(self.stiffness), np.array(self.rest_angles)
        energy = 0.5 * np.sum(k * (phi - rest) ** 2, axis=-1)
        return float(energy) if energy.ndim == 0 else energy

    def __repr__(self) -> str:
        who = self.label or f"{self.vertex!r}"
        return f"Scene({who}: degree {self.degree}, symmetry {self.group.name}, contact {self.contact})"

    def __str__(self) -> str:
        k = ", ".join(f"{v:.6g}" for v in self.stiffness)
        rest = ", ".join(format_angle(a) for a in self.rest_angles)
        title = f"{self.label}: " if self.label else ""
        return (
            f"Scene({title}{self.vertex},\n  stiffness=[{k}] N m/rad,\n  rest_angles=[{rest}] rad,"
            f"\n  symmetry={self.symmetry!r} -> {self.group.name}, contact={self.contact!r})"
        )


def _change(new: Sequence[Sequence[float]], old: Sequence[Sequence[float]]) -> float:
    """Return the largest change of sector angles and rest angles [rad] and, relatively, of stiffnesses."""
    angles = [np.abs(np.subtract(a, b)).max() for a, b in zip(new[:2], old[:2], strict=True)]
    return float(max(*angles, np.abs(np.divide(new[2], old[2]) - 1).max()))


def _check_range(stiffness: Sequence[float]) -> None:
    """Complain about stiffnesses that cannot be computed with, or not together."""
    soft, stiff = min(stiffness), max(stiffness)
    i, j = stiffness.index(soft) + 1, stiffness.index(stiff) + 1
    if soft < SMALLEST or stiff > LARGEST:
        wrong, k = (i, soft) if soft < SMALLEST else (j, stiff)
        raise SceneError(
            f"stiffness[{wrong}] = {k:.6g} is not within {SMALLEST:g} to {LARGEST:g}: use other units"
        )
    if stiff > LARGEST_RATIO * soft * (1 + TYPED):
        raise SceneError(
            f"stiffness[{j}] = {stiff:.6g} is more than {LARGEST_RATIO:g} times stiffness[{i}] = {soft:.6g}: "
            f"soft springs would be lost in rounding; bring the ratio to {LARGEST_RATIO:g} or less, or merge "
            "the facets at the stiff crease"
        )


def _same_length(values: Sequence[float], name: str, degree: int) -> None:
    if len(values) != degree:
        raise SceneError(
            f"{name} has {len(values)} entries, but the vertex has {degree} creases: give one each"
        )


def _numbers(values: object, name: str, degree: int) -> tuple[float, ...]:
    """Read `degree` floats, or complain about field `name`."""
    wrong = SceneError(f"{name} must be a list of numbers, one for each crease")
    if isinstance(values, str | bytes):
        raise wrong
    try:
        items = list(values)  # type: ignore[call-overload]
    except TypeError:
        raise wrong from None
    for i, v in enumerate(items, start=1):
        if isinstance(v, bool | str | bytes) or not np.isscalar(v):
            raise SceneError(f"{name}[{i}] = {v!r} is not a number")
    try:
        numbers = tuple(float(v) for v in items)
    except OverflowError:
        raise wrong from None
    _same_length(numbers, name, degree)
    return numbers
