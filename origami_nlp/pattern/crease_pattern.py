"""Interior vertices of a FOLD frame: sector angles, fold angles, flat-foldability.

Around a vertex the facets follow each other counter-clockwise: by azimuth in a flat crease pattern, by its
faces in a folded form.  There the fold angle of a crease is the angle from the normal of the facet before it
to the normal of the facet after it, about the crease, which is positive for a valley.  Facets joined by an
edge that is no crease (J, or F) are one facet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OrigamiError
from origami_nlp.numerics import CLOSURE_TOL, INPUT_TOL, NONZERO, PLACES
from origami_nlp.pattern.fold_faces import face_walks, oriented
from origami_nlp.pattern.fold_file import FOLDS, Frame
from origami_nlp.pattern.fold_notes import NOISE, listed
from origami_nlp.pattern.fold_springs import stated_sign, target_notes
from origami_nlp.pattern.polygons import fold_between, rings, sides_of
from origami_nlp.pattern.vertex import Vertex

AMPLIFIED = 5.0
"""Over the noise of places divided by the shortest crease, what alternate sectors round a vertex miss at most."""
VAGUE = 0.1
"""Angles [rad] that decimal places leave open: where it is more, they are not those of rounding."""


@dataclass(frozen=True)
class FoldVertex:
    """One vertex of a frame.

    Attributes
    ----------
    number
        In the file, from 0.
    edges
        Numbers in the file of its creases, counter-clockwise.
    sector_angles
        [N] [rad], from crease to crease.
    assignment
        A letter a crease.
    fold_angles
        [N] [rad] measured on a folded form, or `file_angles` of a crease pattern.
    file_angles
        [N] [rad] edges_foldAngle of the file: targets, or the folded state; NaN where not given.
    kawasaki
        |alternating sum of the sector angles| [rad], None for an odd degree.
    maekawa
        |mountains - valleys| - 2, None unless every crease is one or the other.
    reason
        Why it cannot be analysed; empty if it can.
    notes
        What was assumed.
    kawasaki_error
        How far the alternating sum may be off [rad], corners being known as they are: those of drawings to what their
        ends were joined over, others to their last decimal place where that says anything, all to the noise of a
        drawing, 1e-4 of the sheet.
    """

    ALSO = ("degree", "kawasaki", "maekawa")

    number: int
    edges: tuple[int, ...]
    sector_angles: tuple[float, ...]
    assignment: str
    fold_angles: tuple[float, ...]
    file_angles: tuple[float, ...]
    reason: str
    notes: tuple[str, ...] = ()
    kawasaki_error: float = 0.0

    @property
    def degree(self) -> int:
        """Number of creases."""
        return len(self.edges)

    @property
    def kawasaki(self) -> float | None:
        """|alternating sum of the sector angles| [rad], None for an odd degree."""
        a = np.array(self.sector_angles)
        off = abs(float(a[::2].sum() - a[1::2].sum()))
        return None if self.degree % 2 or math.isnan(off) else off

    @property
    def maekawa(self) -> int | None:
        """|mountains - valleys| - 2, None unless every crease is one or the other."""
        m, v = self.assignment.count("M"), self.assignment.count("V")
        return abs(m - v) - 2 if m + v == self.degree else None


def fold_vertices(frame: Frame) -> tuple[tuple[FoldVertex, ...], tuple[str, ...]]:
    """Return every interior vertex of a frame at which two or more creases meet.

    Parameters
    ----------
    frame
        Of `read_fold`.

    Returns
    -------
    tuple of FoldVertex
        In the order of the file.
    tuple of str
        Notes on the border.

    Raises
    ------
    OptionError
        If `frame` is none of `read_fold`.
    """
    check_type("frame", frame, Frame)
    found, notes = _look(frame, turned=False)
    # which side valleys open to is a matter of how the faces run; the assignments decide
    votes = sum(
        stated_sign(frame, e) * math.copysign(1.0, angle)
        for v in (found if frame.folded else ())
        for e, angle in zip(np.searchsorted(frame.numbers, v.edges), v.fold_angles, strict=True)
        if PLACES < abs(angle) < math.pi
    )
    if votes < 0:
        found, notes = _look(frame, turned=True)
        notes = (*notes, "faces run the other way round than the assignments say: turned over")
    return found, notes


def _look(frame: Frame, *, turned: bool) -> tuple[tuple[FoldVertex, ...], tuple[str, ...]]:
    """Measure the vertices with faces all around, by the faces of a folded form or by azimuth."""
    faces, against = face_walks(frame), 0
    if frame.folded:
        faces, against = oriented([f[::-1] if turned else f for f in frame.faces])
    notes = [f"{against} faces were turned over to orient all alike"] if against else []
    sides, edges_at = sides_of(faces), dict[int, list[int]]()
    for e, pair in enumerate(frame.edges.tolist()):
        for v in pair:
            edges_at.setdefault(v, []).append(e)
    if missing := sides.keys() - frame.edge_of.keys():
        notes.append(f"{len(missing)} sides of faces are no edges of the file")
    directed = [(f[i - 1], v) for f in faces for i, v in enumerate(f)]
    if len(set(directed)) < len(directed):
        notes.append("some faces overlap at a vertex or cannot be oriented alike")
    border = {e for s, e in frame.edge_of.items() if len(sides.get(s, ())) < 2}
    cut = {e for e, a in enumerate(frame.assignment) if a in "BC"}
    outside, known = ({*frame.edges[[*some]].ravel().tolist()} for some in (border | cut, cut))
    ends = sorted(v for v in outside if len(edges_at[v]) == 1)
    lost = [
        v for v in outside - known if sum(frame.assignment[e] not in "BCJ" for e in edges_at[v]) > 2
    ]
    drawn = sorted(frame.numbers[[*(border - cut)]].tolist())
    if ends and lost and not frame.folded:
        where = f"vertices {listed(ends)}, and {listed(sorted(lost))} on the outside"
        notes.append(f"creases end in the open ({where}): add the outline of the paper, edges B")
    elif drawn:
        notes.append(f"edges {listed(drawn)} are drawn as folds on the border: read as borders")
    closed = {ring[0][0]: [w for _, w in ring] for ring in rings(faces)}
    inner = sorted({v for face in faces for v in face} - outside)
    found = [_analyse(frame, v, edges_at[v], closed.get(v)) for v in inner if v in edges_at]
    return tuple(v for v in found if v is not None), tuple(notes)


def make_vertex(sectors: tuple[float, ...]) -> Vertex:
    """Make a vertex; an angle sum that is 2 pi but for noise is 2 pi.

    Parameters
    ----------
    sectors
        Sector angles, [N] [rad], counter-clockwise.

    Returns
    -------
    Vertex
        The vertex, not flat where the sum differs from 2 pi by more than noise.

    Raises
    ------
    VertexError
        If the angles make no vertex.
    """
    total = math.fsum(sectors)
    if abs(total - 2 * math.pi) > NOISE * len(sectors):
        return Vertex(sectors, flat=False)
    return Vertex(tuple(a * (2 * math.pi / total) for a in sectors))


# ---------------------------------------------------------------- one vertex


def _analyse(frame: Frame, v: int, edges: list[int], closed: list[int] | None) -> FoldVertex | None:
    """Measure one vertex; None where all its edges join facets.

    closed: the edges' other ends, counter-clockwise, where faces close up around it.
    """
    broken = "" if closed else "the faces around it do not close up"
    edge = {int(frame.edges[e].sum()) - v: e for e in edges}
    ring = closed or sorted(edge)
    first = ring.index(min(ring))
    ring = ring[first:] + ring[:first]
    letters = {w: frame.assignment[edge[w]] for w in ring if w in edge}
    folds = [k for k, w in enumerate(ring) if letters.get(w, "J") in FOLDS + "?"]
    if not folds:
        return None
    d = frame.coords[ring] - frame.coords[v]
    length = np.linalg.norm(d, axis=1)
    if not length.all():
        broken = "an edge has no length"
        length[length == 0.0] = math.nan
    d = d / length[:, None]
    following = np.roll(d, -1, axis=0)
    normals = np.cross(d, following)
    sectors = np.arctan2(np.linalg.norm(normals, axis=1), np.einsum("ij,ij->i", d, following))
    if not frame.folded:
        azimuth = np.arctan2(d[:, 1], d[:, 0])
        sectors = np.mod(np.roll(azimuth, -1) - azimuth, 2 * math.pi)
    if len(ring) == 1:
        sectors = np.array([2 * math.pi])
    notes = ["facets joined by J edges are one facet"] if "J" in letters.values() else []
    keep = [k for k in folds if letters[ring[k]] != "F" or frame.is_sprung(edge[ring[k]])]
    merged = merged_sectors(sectors, keep)
    if len(keep) < len(folds):
        few = len(keep) < 3 or merged.max() >= math.pi - INPUT_TOL
        notes.insert(0, "facets joined by F edges are one facet")
        if few:
            keep, merged = folds, merged_sectors(sectors, folds)
            notes[0] = "F edges are kept as creases, without them a facet would span 180 degrees"
    at = [edge[ring[k]] for k in keep]
    phi = stated = frame.fold_angles[at]
    if frame.folded and not broken:
        phi, unsure = _measured(d, normals, keep, frame, at)
        if unsure:
            notes.append("a fully folded crease, not assigned, is taken for a valley")
        notes += target_notes(frame, at, phi)
    reason = broken or _why_not(frame, at, merged)
    try:
        vertex = None if reason else make_vertex(tuple(merged.tolist()))
    except OrigamiError as error:
        vertex, reason = None, str(error)
    if vertex and not vertex.flat:
        excess = f"{math.degrees(vertex.excess):+.4g} degrees"
        notes.append(f"sector angles sum to 360 {excess}: not flat")
    signs = "".join(frame.assignment[e] for e in at)
    return FoldVertex(
        v,
        tuple(int(frame.numbers[e]) for e in at),
        tuple(merged.tolist()),
        signs,
        tuple(phi.tolist()),
        tuple(stated.tolist()),
        reason,
        tuple(notes),
        _kawasaki_error(frame, length[keep]),
    )


def _kawasaki_error(frame: Frame, lengths: np.ndarray) -> float:
    """Return how far the alternating sum of sectors may be off: each crease turns two of them, of opposite signs."""
    if frame.folded:
        return 0.0
    error = float(2.0 * (2.0 * (frame.error or frame.unit) / lengths).sum())
    # whole numbers on a small grid are exact, not rounded
    stated = error if frame.error or error <= VAGUE else 0.0
    return max(stated, misses_of_noise(frame, lengths, NOISE))


def misses_of_noise(frame: Frame, lengths: np.ndarray, noise: float) -> float:
    """Return what alternate sectors round a vertex miss at most [rad], of creases [d] whose ends are off.

    noise: by so much of the size of the frame.
    """
    return AMPLIFIED * noise * float(np.ptp(frame.coords, axis=0).max()) / float(lengths.min())


def merged_sectors(sectors: np.ndarray, keep: list[int]) -> np.ndarray:
    """Sum sectors between the rays that are kept."""
    if not keep:
        return np.array([2 * math.pi])
    return np.add.reduceat(np.roll(sectors, -keep[0]), [k - keep[0] for k in keep])


def _why_not(frame: Frame, at: list[int], sectors: np.ndarray) -> str:
    """Describe why a vertex is none of ours; or ''."""
    for e in (e for e in at if e in frame.conflicts):
        return f"edge {frame.numbers[e]} has conflicting assignments: keep one of the copies"
    if len(at) < 3:
        return f"{len(at)} crease{'s' if len(at) > 1 else ''}: a vertex needs at least 3"
    if sectors.max() < math.pi - CLOSURE_TOL:
        return ""
    facet = f"the facet after edge {frame.numbers[at[int(sectors.argmax())]]}"
    return f"{facet} spans {math.degrees(sectors.max()):.6g} degrees: split it with a crease (F)"


def _measured(
    d: np.ndarray, normals: np.ndarray, keep: list[int], frame: Frame, at: list[int]
) -> tuple[np.ndarray, bool]:
    """Fold angles from the facets' normals; where a crease is fully folded the file says to which side."""
    unit = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), NONZERO)
    phi, unsure = [], False
    for k, e in zip(keep, at, strict=True):
        angle = fold_between(d[k], unit[k - 1], unit[k])
        if math.pi - abs(angle) < PLACES:
            sign = stated_sign(frame, e)
            unsure |= sign == 0.0
            angle = math.copysign(math.pi, sign or 1.0)
        phi.append(angle)
    return np.array(phi), unsure
