"""Is a folded form one of the sheet of its crease pattern: lengths, planes, angles, letters, closure, crossings."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.numerics import NOISE, NONZERO, PLACES
from origami_nlp.pattern import (
    Frame,
    Pattern,
    drawing_oddities,
    face_oddities,
    fold_vertices,
    frame_pattern,
    listed,
)
from origami_nlp.validity.faults import MILLI, Fault, Findings

PLANES = "plane faces"
ODD = ("border", "cuts", "turned over", "in points", "few digits")
"""Words of the notes of a pattern that are about the sheet, not its springs."""
MOST_SIDES = 40
"""Of a face up to which all its diagonals are measured; of larger ones those from every vertex to the next but one."""


def check_sheet(f: Findings) -> Pattern | None:
    """Check that a frame is a sheet of plane faces; the pattern where it is one."""
    frame = f.frame
    if not frame.folded:
        for o in drawing_oddities(frame):
            f.fault("drawing", o.text, vertices=o.vertices, edges=o.edges)
        f.settle("drawing", f"{len(frame.edges)} edges")
    name = "edges stated once"
    for e in sorted(int(frame.numbers[k]) for k in frame.conflicts):
        text = f"edge {e} is stated twice with different assignments or fold angles"
        f.fault(name, text, edges=[e])
    if frame.conflicts:
        f.settle(name)
    if frame.faces:
        off = f.lengths() / f.size
        for o in face_oddities(frame, frame.faces):
            f.fault(PLANES, o.text, vertices=o.vertices, faces=o.faces, size=o.size)
        known = {face for one in f.of(PLANES) for face in one.faces}
        _bent(f, known, off * f.size)
        f.settle(PLANES, f"{len(frame.faces)} faces, to {off:.0e} of the sheet")
    try:
        pattern = frame_pattern(frame)
        f.notes += [n for n in pattern.notes if any(word in n for word in ODD)]
        return pattern
    except OrigamiError as error:
        if not f.faults:
            f.fault("sheet", str(error))
            f.settle("sheet")
    return None


def _bent(f: Findings, known: set[int], most: float) -> None:
    """Record faces that are off a plane by more than the digits of the file, but less than the reader refuses."""
    for k, face in enumerate(f.frame.faces):
        x = f.frame.coords[list(face)]
        x = x - x.mean(axis=0)
        normal = np.linalg.svd(x, full_matrices=False)[2][-1] if len(face) > 3 else np.zeros(3)
        off = float(np.abs(x @ normal).max())
        if off > most and k not in known:
            f.fault(
                PLANES,
                f"face {k} is off a plane by {off / f.size:.1e} of the sheet",
                faces=[k],
                size=off,
                unit="length",
            )


def is_same_sheet(folded: Frame, flat: Frame) -> bool:
    """Return whether two frames number vertices, edges and faces alike."""
    one, other = (
        {(min(a, b), max(a, b)) for a, b in frame.edges.tolist()} for frame in (folded, flat)
    )
    faces = {frozenset(face) for face in flat.faces}
    alike = not faces or faces == {frozenset(face) for face in folded.faces}
    return len(folded.coords) == len(flat.coords) and one == other and alike


def check_isometry(f: Findings, flat: Frame | None, others: bool) -> bool:
    """Check that no edge and no diagonal of a face is longer or shorter; whether the form is that of a sheet at all.

    A scaled form is one, of another size.
    """
    name = "lengths as in the crease pattern"
    if flat is None:
        if others:
            why = "the crease pattern of the file numbers its vertices, edges or faces otherwise"
            f.skip(name, why, undecided=True)
        else:
            _check_developable(f)
        return True
    _check_cuts(f, flat)
    most = f.lengths(flat)
    ends = f.frame.edges
    was, now = (
        np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1) for x in (flat.coords, f.frame.coords)
    )
    wrong = np.flatnonzero(np.abs(now - was) > most)
    ratio = now / np.maximum(was, NONZERO)
    scale = float(np.median(ratio))
    even = len(wrong) == len(ends) and np.abs(ratio / scale - 1).max() <= most / f.size * 10
    if even and len(ends):
        f.fault(
            name,
            f"all lengths are {scale:.6g} times those of the crease pattern: the state is scaled",
            place=f.frame.coords.mean(axis=0),
            size=abs(scale - 1),
        )
    else:
        for k in wrong.tolist():
            e, by = int(f.frame.numbers[k]), now[k] - was[k]
            more = "longer" if by > 0 else "shorter"
            share = _percent(abs(by) / max(was[k], NONZERO))
            f.fault(
                name,
                f"edge {e} is {share} {more} than in the crease pattern",
                vertices=ends[k].tolist(),
                edges=[e],
                size=abs(by),
                unit="length",
            )
        stretched = {frozenset(ends[k].tolist()) for k in wrong.tolist()}
        _sheared(f, flat, most, name, stretched)
    faults = f.of(name)
    moved = moved_vertices(faults)
    at = ""
    if 2 * len(moved) <= len(faults) and not even:
        at = f", as where vert{'ices' if len(moved) > 1 else 'ex'} {listed(moved)} moved"
    f.settle(name, f"{len(ends)} edges, to {most / f.size:.0e} of the sheet{at}")
    return even or not faults


def _check_cuts(f: Findings, flat: Frame) -> None:
    """Check that paper is cut where the crease pattern is: by edges B or C with faces on both sides."""
    sides = Counter(
        (min(a, b), max(a, b))
        for face in f.frame.faces
        for a, b in zip(face, (*face[1:], face[0]), strict=True)
    )

    def cuts(frame: Frame) -> set[tuple[int, int]]:
        lines = zip(frame.edges.tolist(), frame.assignment, strict=True)
        return {(min(a, b), max(a, b)) for (a, b), letter in lines if letter in "BC"}

    name, one, other = "cuts as in the crease pattern", cuts(f.frame), cuts(flat)
    number = dict(zip(map(tuple, np.sort(f.frame.edges).tolist()), f.frame.numbers, strict=True))
    for s in sorted(one ^ other):
        if sides[s] > 1:
            here, there = ("a cut" if s in one else "no cut"), ("one" if s in other else "none")
            text = f"edge {number[s]} is {here}, in the crease pattern it is {there}"
            f.fault(name, text, vertices=s, edges=[number[s]])
    if f.of(name):
        f.settle(name)


def moved_vertices(faults: Sequence[Fault]) -> list[int]:
    """Return few vertices at which all faults are that are at vertices: those that probably moved."""
    left = [set(one.vertices) for one in faults if one.vertices]
    found = []
    while left:
        many = Counter(v for one in left for v in one)
        found.append(max(many, key=lambda v: (many[v], -v)))
        left = [one for one in left if found[-1] not in one]
    return sorted(found)


def _sheared(
    f: Findings, flat: Frame, most: float, name: str, stretched: set[frozenset[int]]
) -> None:
    """Record faces whose sides are right and whose diagonals are not."""
    for k, face in enumerate(f.frame.faces):
        sides = {frozenset((face[i - 1], v)) for i, v in enumerate(face)}
        if sides & stretched:
            continue
        few = len(face) <= MOST_SIDES
        pairs = itertools.combinations(face, 2) if few else zip(face, face[2:], strict=False)
        a, b = np.array([*pairs]).T
        was, now = (np.linalg.norm(x[a] - x[b], axis=1) for x in (flat.coords, f.frame.coords))
        worst = int(np.abs(now - was).argmax())
        off = abs(float(now[worst] - was[worst]))
        # a face that is bent is not sheared: its diagonals are then off by the square of that
        if off > 2 * most:
            apart = "further apart" if now[worst] > was[worst] else "closer"
            f.fault(
                name,
                f"face {k} has another shape: its vertices {a[worst]} and {b[worst]} are "
                f"{_percent(off / max(was[worst], NONZERO))} {apart}",
                vertices=[int(a[worst]), int(b[worst])],
                faces=[k],
                size=off,
                unit="length",
            )


def _check_developable(f: Findings) -> None:
    """Check that angles round every vertex sum to a full turn, where there is no crease pattern to compare with."""
    name = "flat round every vertex"
    found = [v for v in fold_vertices(f.frame)[0] if not math.isnan(sum(v.sector_angles))]
    for v in found:
        off = math.fsum(v.sector_angles) - 2 * math.pi
        if abs(off) > _angle_noise(f, v.number, v.edges):
            f.fault(
                name,
                f"angles round vertex {v.number} sum to {math.degrees(off) + 360:.6g} degrees: it is folded of no "
                "flat sheet",
                vertices=[v.number],
                size=abs(off),
                unit="rad",
            )
    f.settle(name, f"{len(found)} interior vertices; no crease pattern to compare lengths with")


def _angle_noise(f: Findings, vertex: int, edges: tuple[int, ...]) -> float:
    """Return by how much an angle sum may be off where places are off by so much."""
    number = {int(n): k for k, n in enumerate(f.frame.numbers)}
    ends = f.frame.edges[[number[e] for e in edges]]
    x = f.frame.coords
    shortest = float(np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1).min())
    return 2 * len(edges) * f.lengths() / max(shortest, NONZERO) + PLACES


def check_fold_angles(f: Findings, pattern: Pattern) -> None:
    """Check fold angles that the file states, and letters, against those of the coordinates."""
    p = pattern
    noise = _crease_noise(f, p)
    # beside faces that are out of shape the angles follow from that
    spoilt = {
        *moved_vertices([one for one in f.faults if one.unit == "length" or one.test == PLANES])
    }
    beside = np.zeros(p.facets, bool)
    for q, facet in zip(p.polygons, p.facet_of, strict=True):
        beside[facet] |= bool(spoilt & {*q})
    out = beside[p.left] | beside[p.right]
    off = np.abs(p.file_angles - p.reference)
    # at +-pi the coordinates have no sign
    off = np.where(np.abs(p.reference) == math.pi, np.abs(np.abs(p.file_angles) - math.pi), off)
    name = "fold angles as in the coordinates"
    if np.isnan(p.file_angles).all():
        f.skip(name, "the file states no fold angles")
    else:
        wrong = np.flatnonzero((np.nan_to_num(off) > noise) & ~out)
        for c in wrong.tolist():
            f.fault(
                name,
                f"edge {p.numbers[c]}: edges_foldAngle is {math.degrees(p.file_angles[c]):.6g}, its coordinates are "
                f"folded by {math.degrees(p.reference[c]):.6g} degrees",
                vertices=p.ends[c].tolist(),
                edges=[p.numbers[c]],
                place=p.corners[p.ends[c]].mean(axis=0),
                size=off[c],
                unit="rad",
            )
        stated = int((~np.isnan(p.file_angles)).sum())
        apart = f", {out.sum()} of them beside faces that are out of shape" if out.any() else ""
        f.settle(name, f"{stated} of {p.creases} creases{apart}")
    check_letters(f, p, np.where(np.abs(p.reference) > noise, p.reference, 0.0))
    _flat_edges(f, p)
    f.settle("flat edges are flat", "edges F and J, and sides that are no edges")


def measured_on(sheet: Pattern, folded: Frame) -> Pattern:
    """Return a crease pattern with the coordinates of a folded form, and the fold angles that its faces have there.

    Faces need not be plane: it is for measuring alone.
    """
    x = folded.coords
    normals = {}
    for q in sheet.polygons:
        at = x[list(q)] - x[q[0]]
        n = np.cross(at, np.roll(at, -1, axis=0)).sum(axis=0)
        for i, v in enumerate(q):
            normals[q[i - 1], v] = n / max(float(np.linalg.norm(n)), NONZERO)
    phi = np.zeros(sheet.creases)
    for c, (v, w) in enumerate(sheet.ends.tolist()):
        right, left, d = normals[w, v], normals[v, w], x[w] - x[v]
        phi[c] = math.atan2(
            float(d @ np.cross(right, left)) / max(float(np.linalg.norm(d)), NONZERO),
            float(right @ left),
        )
        if math.pi - abs(phi[c]) < NOISE:
            phi[c] = math.copysign(math.pi, sheet.signs[c] or phi[c])
    return replace(sheet, corners=x, reference=phi)


def check_letters(f: Findings, p: Pattern, measured: np.ndarray) -> None:
    """Check letters against the signs of fold angles, measured ones [n] and those of the file."""
    name = "mountains and valleys as folded"
    for c in range(p.creases):
        stated = p.file_angles[c]
        for phi, what in ((measured[c], "is folded by"), (stated, "has edges_foldAngle")):
            # fully folded, coordinates have no sign
            if p.signs[c] * phi < -PLACES and (what != "is folded by" or abs(phi) < math.pi):
                letter = "a mountain" if p.signs[c] < 0 else "a valley"
                f.fault(
                    name,
                    f"edge {p.numbers[c]} is {letter} and {what} {math.degrees(phi):+.6g} degrees",
                    edges=[p.numbers[c]],
                    place=p.corners[p.ends[c]].mean(axis=0),
                    size=abs(phi),
                    unit="rad",
                )
                break
    given = int((p.signs != 0).sum())
    if not given:
        f.skip(name, "no edge is a mountain or a valley")
    else:
        f.settle(name, f"{given} of {p.creases} creases")


def _crease_noise(f: Findings, p: Pattern) -> np.ndarray:
    """Return by how much each measured fold angle may be off [rad]: places over the widths of the facets."""
    widths = np.full(p.creases, np.inf)
    at = {(a, b): c for c, (a, b) in enumerate(p.ends.tolist())}
    for q in p.polygons:
        x = p.corners[list(q)]
        for i, v in enumerate(q):
            c = at.get((min(q[i - 1], v), max(q[i - 1], v)))
            if c is not None:
                way = p.directions[c]
                out = x - x[i]
                wide = np.linalg.norm(out - np.outer(out @ way, way), axis=1).max()
                widths[c] = min(widths[c], float(wide))
    digits = np.abs(np.degrees(p.file_angles) / MILLI - np.round(np.degrees(p.file_angles) / MILLI))
    coarse = np.nanmax(digits, initial=0.0) <= PLACES  # three decimals of a degree, or less
    return 4 * f.lengths() / np.maximum(widths, NONZERO) + (
        math.radians(MILLI) if coarse else PLACES
    )


def _flat_edges(f: Findings, p: Pattern) -> None:
    """Record sides within a facet at which its pieces of paper are at an angle."""
    normals = []
    for q in p.polygons:
        x = p.corners[list(q)]
        n = np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)
        normals.append(n / max(float(np.linalg.norm(n)), NONZERO))
    sides: dict[tuple[int, int], list[int]] = {}
    for k, q in enumerate(p.polygons):
        for i, v in enumerate(q):
            sides.setdefault((min(q[i - 1], v), max(q[i - 1], v)), []).append(k)
    number = {
        (min(a, b), max(a, b)): int(e)
        for (a, b), e in zip(f.frame.edges.tolist(), f.frame.numbers, strict=True)
    }
    creases = {(a, b) for a, b in p.ends.tolist()}
    for s, faces in sides.items():
        if len(faces) != 2 or s in creases:
            continue
        one, other = (normals[k] for k in faces)
        angle = math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other))
        if angle > NOISE + 4 * f.lengths() / f.size:
            edge = number.get(s)
            what = f"edge {edge}" if edge is not None else f"the side {s[0]}-{s[1]} of two faces"
            f.fault(
                "flat edges are flat",
                f"{what} is no crease (F, J or none) and is folded by {math.degrees(angle):.6g} degrees: facets are "
                "rigid",
                vertices=s,
                edges=[] if edge is None else [edge],
                faces=faces if f.frame.faces else [],
                size=angle,
                unit="rad",
            )


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"
