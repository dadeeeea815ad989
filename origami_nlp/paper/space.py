"""The space X of all symmetric states that contact admits: components, holes, pinch points, handles.

X lies in the space of wedge fold angles, where phi = +pi and phi = -pi are different points; the paper's
coordinates are only one of its charts.  A point of X is a limit of embedded states (with a symmetric order of
touching layers).  X is made of surfaces, of handles (arcs of states that exist only while creases stay closed) and of
isolated states; surfaces can touch in single points (pinch points), the flat state above all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.chart import (
    Cells,
    Component,
    cells_of,
    handles,
    parts,
    several,
    spots,
)
from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import OUTSIDE
from origami_nlp.pattern import Scene, as_scene, format_angle

SIZE, SIZES = 64, (8, 1025)
"""Rings of the mesh around the flat state, by default and at least and most."""


def angle_word(angle: float) -> str:
    """Write a fold angle for people: a multiple of pi as such, others with four decimals."""
    text = format_angle(angle) if abs(angle) > OUTSIDE else "0"
    return text if "pi" in text or text == "0" else f"{angle:.4f}"


@dataclass(frozen=True, repr=False)
class PinchPoint(ShortRepr):
    """A state without which its neighbourhood in X falls apart.

    Attributes
    ----------
    kind
        ``"pinch point"`` (surfaces touch), ``"handle end"`` (a handle meets a surface) or ``"handle junction"``.
    fold_angles
        All N [rad].
    dimensions
        Of the pieces that meet there, largest first.
    contacts
        Closed there, in words.
    vertex
        Of the mesh.
    """

    kind: str = field(metadata=shown("where pieces meet"))
    fold_angles: tuple[float, ...] = field(metadata=shown("fold angles", spec=angle_word))
    dimensions: tuple[int, ...] = field(metadata=shown("dimensions", between=" + "))
    contacts: tuple[str, ...] = field(metadata=shown("contacts", between="; "))
    vertex: int = field(metadata={"plain": False})


@dataclass(frozen=True)
class Handle:
    """An arc of states around which there are no others (the paper's 1-handles).

    Attributes
    ----------
    contacts
        The states exist only while these stay closed.
    path
        Vertices of the mesh, from end to end.
    fold_angles
        [m, N] [rad].
    length
        In the space of wedge fold angles [rad].
    ends
        What each end is (``"free"`` or the kind of the pinch point there).
    """

    contacts: tuple[str, ...] = field(metadata=shown("handle", between="; "))
    path: np.ndarray = field(repr=False, metadata={"plain": False})
    fold_angles: np.ndarray = field(repr=False)
    length: float = field(metadata=shown("length", spec=".4f"))
    ends: tuple[str, str] = field(metadata=shown("ends", between=" to "))


@dataclass(frozen=True, repr=False)
class Space(Report):
    """The space X of admissible states of a scene: its pieces and how they hang together.

    Attributes
    ----------
    scene
        The scene.
    size
        Rings of the mesh it was computed with.
    components
        Connected components.
    holes
        First Betti number.
    pinch_points
        States without which their neighbourhood falls apart.
    handles
        Arcs of states around which there are no others.
    euler_characteristic
        V - E + F.
    mesh
        X as a complex of vertices, edges and triangles.

    Examples
    --------
    >>> import origami_nlp as o
    >>> space = o.find_space(o.examples.degree6("pi/3"), rings=8)
    >>> space.signature
    (1, 0, 1, 1, 4, 4)
    """

    scene: Scene
    size: int
    components: tuple[Component, ...]
    holes: int
    pinch_points: tuple[PinchPoint, ...]
    handles: tuple[Handle, ...]
    euler_characteristic: int
    mesh: Cells = field(metadata={"plain": False})

    SCHEMA, READS = "origami-nlp/landscape/2", False
    ROWS = "components"

    @property
    def signature(self) -> tuple[int, ...]:
        """(components, holes, Euler characteristic, pinch points, handle ends and junctions, handles)."""
        kinds = [p.kind for p in self.pinch_points]
        pinch = kinds.count("pinch point")
        counts = (len(self.components), self.holes, self.euler_characteristic)
        return (*counts, pinch, len(kinds) - pinch, len(self.handles))

    @property
    def corners(self) -> tuple[tuple[tuple[str, ...], int], ...]:
        """States of X where two contacts or more close, by their contacts, with how many vertices have them."""
        mesh, counts = self.mesh, Counter[tuple[str, ...]]()
        for v in np.flatnonzero(several(mesh.on)).tolist():
            names = []
            for name in mesh.contacts(int(mesh.on[v])):
                if name.endswith("+-pi"):  # with the sign of fold angles at +-pi
                    angle = mesh.fold_angles[v, int(name.split(" ")[0].removeprefix("phi_")) - 1]
                    name = name.replace("+-", "+" if angle > 0 else "-")
                names.append(name)
            counts[tuple(sorted(names))] += 1
        return tuple(sorted(counts.items()))

    def report_sections(self) -> Iterator[Section]:
        """Return components, pinch points and handles."""
        yield (
            f"{self.scene.label or 'scene'}: {len(self.components)} component(s), {self.holes} hole(s) "
            f"(mesh of {self.size} rings, {len(self.mesh.wedge)} vertices)"
        )
        for records in (self.components, self.pinch_points, self.handles):
            if records:
                yield record_table(records, "")


def find_space(scene: Scene, *, rings: int = SIZE) -> Space:
    """Analyse the admissible space of a scene with two symmetric degrees of freedom and full contact.

    Parameters
    ----------
    scene
        What is folded; its springs play no part.
    rings
        Rings of the mesh around the flat state, 8 to 1025; the mesh has about 8 rings^2 vertices.  A few more are
        taken where that mesh is too coarse (see `Space.size`).

    Returns
    -------
    Space
        Components, holes, pinch points and handles, with the mesh.

    Raises
    ------
    OptionError
        If the scene has no such space, or `rings` is out of range.
    MeshError
        If the mesh is too coarse to decide.

    Examples
    --------
    >>> import origami_nlp as o
    >>> space = o.find_space(o.examples.degree6("pi/3"), rings=8)
    >>> len(space.components), space.holes, space.euler_characteristic
    (1, 0, 1)
    """
    scene = as_scene(
        scene, "the admissible space", "find_motion follows a pattern of one degree of freedom"
    )
    cells = cells_of(scene, check_whole("rings", rings, *SIZES))
    complex_ = len(cells.wedge), cells.triangles, cells.extra_edges
    components = tuple(parts(*complex_))
    pinch = tuple(_pinch_point(cells, *spot) for spot in spots(*complex_))
    kinds = {p.vertex: p.kind for p in pinch}
    arcs = tuple(_handle(cells, path, kinds) for path in handles(*complex_))
    holes = sum(c.holes for c in components)
    euler = sum(c.euler_characteristic for c in components)
    return Space(scene, cells.cover.rings, components, holes, pinch, arcs, euler, cells)


def _pinch_point(mesh: Cells, v: int, dimensions: tuple[int, ...]) -> PinchPoint:
    kind = ("handle junction", "handle end", "pinch point")[min(dimensions.count(2), 2)]
    phi = tuple(mesh.fold_angles[v].tolist())
    return PinchPoint(kind, phi, dimensions, mesh.contacts(int(mesh.on[v])), v)


def _handle(mesh: Cells, path: np.ndarray, kinds: dict[int, str]) -> Handle:
    contacts = mesh.contacts(int(np.bitwise_and.reduce(mesh.on[path])))
    length = float(np.linalg.norm(np.diff(mesh.wedge[path], axis=0), axis=1).sum())
    first, last = (kinds.get(v, "free") for v in path[[0, -1]].tolist())
    ends = ("loop", "loop") if path[0] == path[-1] else (first, last)
    return Handle(contacts, path, mesh.fold_angles[path], length, ends)
