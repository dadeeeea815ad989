"""Is a folded form one of the sheet of its crease pattern: lengths, planes, angles, letters."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.numerics import NOISE, NONZERO, PLACES, area_vectors
from origami_nlp.pattern import (
    Frame,
    Pattern,
    Side,
    drawing_oddities,
    face_oddities,
    fold_between,
    fold_vertices,
    frame_pattern,
    listed,
    side,
    sides_of,
)
from origami_nlp.validity.faults import (
    ANGLES,
    FLAT,
    LENGTHS,
    LETTERS,
    MILLI,
    PLANES,
    ROUND,
    Fault,
    Findings,
)

ODD = ("border", "cuts", "turned over", "in points", "few digits", "folding flat")
"""Words of the notes of a pattern that are about the sheet, not its springs."""
MOST_SIDES = 40
"""Of a face up to which all its diagonals are measured; of larger ones those from every vertex to the next but one."""


def _lengths(x: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return distances [m] of pairs of vertices [m, 2]."""
    return np.asarray(np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1))


def _folds(x: np.ndarray, polygons: Sequence[tuple[int, ...]]) -> dict[Side, float]:
    """Return the fold angle [rad] at each side of two polygons of one sense, which need not be quite plane."""
    normals = dict[tuple[int, int], np.ndarray]()
    for q in polygons:
        n = area_vectors(x[list(q)])
        n = n / max(float(np.linalg.norm(n)), NONZERO)
        normals |= {(q[i - 1], v): n for i, v in enumerate(q)}
    return {
        (v, w): fold_between(x[w] - x[v], normals[w, v], n) if (x[w] != x[v]).any() else 0.0
        for (v, w), n in normals.items()
        if v < w and (w, v) in normals
    }


def check_sheet(f: Findings) -> Pattern | None:
    """Check that a frame is a sheet of plane faces; the pattern where it is one."""
    frame, name = f.frame, "edges stated once"
    if not frame.folded:
        for o in drawing_oddities(frame):
            f.fault("drawing", o.text, vertices=o.vertices, edges=o.edges)
        f.settle("drawing", f"{len(frame.edges)} edges")
    for e in sorted(int(frame.numbers[k]) for k in frame.conflicts):
        f.fault(name, f"edge {e} is stated twice with other letters or fold angles", edges=[e])
    f.settle_faults(name)
    if frame.faces:
        for o in (o for o in face_oddities(frame, frame.faces) if o.size is None):
            f.fault(PLANES, o.text, vertices=o.vertices, faces=o.faces)
        known = {face for one in f.of(PLANES) for face in one.faces}
        for k, face in enumerate(frame.faces):
            x = frame.coords[list(face)] - frame.coords[list(face)].mean(axis=0)
            off = float(np.abs(x @ np.linalg.svd(x)[2][-1]).max()) * (len(face) > 3)
            if off > f.lengths() and k not in known:
                text = f"face {k} is off a plane by {off / f.size:.1e} of the sheet"
                f.fault(PLANES, text, off, faces=[k])
        f.settle(PLANES, f"{len(frame.faces)} faces, to {f.lengths() / f.size:.0e} of the sheet")
    try:
        pattern = frame_pattern(frame)
        f.notes += [n for n in pattern.notes if any(word in n for word in ODD)]
        return pattern
    except OrigamiError as error:
        if not f.faults:
            f.fault("sheet", str(error))
            f.settle("sheet")
    return None


def is_same_sheet(folded: Frame, flat: Frame) -> bool:
    """Return whether two frames number vertices, edges and faces alike."""
    faces = {frozenset(face) for face in flat.faces}
    alike = not faces or faces == {frozenset(face) for face in folded.faces}
    same = folded.edge_of.keys() == flat.edge_of.keys()
    return len(folded.coords) == len(flat.coords) and same and alike


def check_isometry(f: Findings, flat: Frame | None, others: bool) -> bool:
    """Check that no edge and no diagonal of a face is longer or shorter; whether the form is that of a sheet at all.

    A scaled form is one, of another size.
    """
    if flat is None:
        if others:
            why = "the crease pattern of the file numbers its vertices, edges or faces otherwise"
            f.skip(LENGTHS, why, undecided=True)
        else:
            _check_developable(f)
        return True
    _check_cuts(f, flat)
    most, ends, at = f.lengths(flat), f.frame.edges, ""
    was, now = (_lengths(x, ends) for x in (flat.coords, f.frame.coords))
    wrong, by = np.abs(now - was) > most, now - was
    ratio = now / np.maximum(was, NONZERO)
    scale = float(np.median(ratio))
    even = bool(wrong.all() and np.abs(ratio / scale - 1).max(initial=0.0) <= most / f.size * 10)
    if even and len(ends):
        text = f"all lengths are {scale:.6g} times those of the crease pattern: the state is scaled"
        f.fault(LENGTHS, text, float(np.abs(by).max()), place=f.frame.coords.mean(axis=0))
    else:
        for k in np.flatnonzero(wrong).tolist():
            e, much = int(f.frame.numbers[k]), _more(by[k], was[k], "longer", "shorter")
            text = f"edge {e} is {much} than in the crease pattern"
            f.fault(LENGTHS, text, abs(by[k]), vertices=ends[k].tolist(), edges=[e])
        _sheared(f, flat, most, {side(*e) for e in ends[wrong].tolist()})
        faults = f.of(LENGTHS)
        moved = moved_vertices(faults)
        if faults and 2 * len(moved) <= len(faults):
            at = f", as where vert{'ices' if len(moved) > 1 else 'ex'} {listed(moved)} moved"
    ok = f.settle(LENGTHS, f"{len(ends)} edges, to {most / f.size:.0e} of the sheet{at}")
    return even or ok


def _check_cuts(f: Findings, flat: Frame) -> None:
    """Check that paper is cut where the crease pattern is."""
    name, sides = "cuts as in the crease pattern", sides_of(f.frame.faces)
    one, other = (
        {side(*ab) for ab, a in zip(x.edges.tolist(), x.assignment, strict=True) if a in "BC"}
        for x in (f.frame, flat)
    )
    for s in (s for s in sorted(one ^ other) if len(sides.get(s, ())) > 1):
        edge = int(f.frame.numbers[f.frame.edge_of[s]])
        here, there = ("cut", "not cut")[:: 1 if s in one else -1]
        text = f"edge {edge} is {here}, in the crease pattern it is {there}"
        f.fault(name, text, vertices=s, edges=[edge])
    f.settle_faults(name)


def moved_vertices(faults: Sequence[Fault]) -> list[int]:
    """Return few vertices at which all faults are that are at vertices: those that probably moved."""
    left = [set(one.vertices) for one in faults if one.vertices]
    found = []
    while left:
        many = Counter(v for one in left for v in one)
        found.append(max(many, key=lambda v: (many[v], -v)))
        left = [one for one in left if found[-1] not in one]
    return sorted(found)


def _sheared(f: Findings, flat: Frame, most: float, stretched: set[Side]) -> None:
    """Record faces whose sides are right and whose diagonals are not."""
    sides = sides_of(f.frame.faces)
    out = {k for s in stretched for k in sides.get(s, ())}
    for k, face in ((k, face) for k, face in enumerate(f.frame.faces) if k not in out):
        few = len(face) <= MOST_SIDES
        pairs = itertools.combinations(face, 2) if few else zip(face, face[2:], strict=False)
        ends = np.array([*pairs])
        was, now = (_lengths(x, ends) for x in (flat.coords, f.frame.coords))
        worst = int(np.abs(now - was).argmax())
        by, (a, b) = float(now[worst] - was[worst]), ends[worst].tolist()
        # a face that is bent is not sheared: its diagonals are then off by the square of that
        if abs(by) > 2 * most:
            apart = _more(by, was[worst], "further apart", "closer")
            text = f"face {k} has another shape: its vertices {a} and {b} are {apart}"
            f.fault(LENGTHS, text, abs(by), vertices=[a, b], faces=[k])


def _more(by: float, of: float, more: str, less: str) -> str:
    return f"{100 * abs(by) / max(of, NONZERO):.2g} % {more if by > 0 else less}"


def _check_developable(f: Findings) -> None:
    """Check that angles round every vertex sum to a full turn, where there is no crease pattern to compare with."""
    found = [v for v in fold_vertices(f.frame)[0] if not math.isnan(sum(v.sector_angles))]
    for v in found:
        off = math.fsum(v.sector_angles) - 2 * math.pi
        ends = f.frame.edges[np.isin(f.frame.numbers, v.edges)]
        shortest = max(float(_lengths(f.frame.coords, ends).min()), NONZERO)
        if abs(off) > 2 * len(v.edges) * f.lengths() / shortest + PLACES:
            whole = f"{math.degrees(off) + 360:.6g} degrees"
            text = f"angles round vertex {v.number} sum to {whole}: it is folded of no flat sheet"
            f.fault(ROUND, text, abs(off), vertices=[v.number])
    f.settle(ROUND, f"{len(found)} interior vertices; no crease pattern to compare lengths with")


def check_fold_angles(f: Findings, p: Pattern) -> None:
    """Check fold angles that the file states, and letters, against those of the coordinates."""
    noise, phi = _crease_noise(f, p), p.reference
    # facets that the coordinates of a moved vertex spoil; their angles are no fault of their own
    spoilt = {*moved_vertices([*f.of(LENGTHS), *f.of(PLANES)])}
    each = zip(p.polygons, p.facet_of.tolist(), strict=True)
    beside = np.isin(np.arange(p.facets), [facet for q, facet in each if spoilt & {*q}])
    out = beside[p.left] | beside[p.right]
    off = np.abs(p.file_angles - phi)
    off = np.where(np.abs(phi) == math.pi, np.abs(np.abs(p.file_angles) - math.pi), off)
    for c in np.flatnonzero((np.nan_to_num(off) > noise) & ~out).tolist():
        said, found = (f"{math.degrees(a[c]):.6g}" for a in (p.file_angles, phi))
        text = f"edge {p.numbers[c]}: edges_foldAngle is {said}, that of its coordinates {found}"
        f.fault(ANGLES, text, off[c], vertices=p.ends[c].tolist(), edges=[p.numbers[c]])
    if stated := (~np.isnan(p.file_angles)).sum():
        apart = f", {out.sum()} of them beside faces that are out of shape" if out.any() else ""
        f.settle(ANGLES, f"{stated} of {p.creases} creases{apart}")
    else:
        f.skip(ANGLES, "the file states no fold angles")
    check_letters(f, p, np.where(np.abs(phi) > noise, phi, 0.0))
    _check_joined(f, p)


def _check_joined(f: Findings, p: Pattern) -> None:
    """Check that sides within a facet are not folded."""
    creases, known = {side(*ends) for ends in p.ends.tolist()}, f.frame.edge_of
    sides = sides_of(p.polygons)
    for s, angle in _folds(p.corners, p.polygons).items():
        if s not in creases and abs(angle) > NOISE + 4 * f.lengths() / f.size:
            edges = [int(f.frame.numbers[known[s]])] if s in known else []
            what = f"edge {edges[0]}" if edges else f"the side {s[0]}-{s[1]} of two faces"
            folded = f"is folded by {math.degrees(abs(angle)):.6g} degrees: facets are rigid"
            faces = sides[s] if f.frame.faces else []
            text = f"{what} is no crease (F, J or none) and {folded}"
            f.fault(FLAT, text, abs(angle), vertices=s, edges=edges, faces=faces)
    f.settle(FLAT, "edges F and J, and sides that are no edges")


def measured_on(sheet: Pattern, folded: Frame) -> Pattern:
    """Return a crease pattern with the coordinates of a folded form, and the fold angles that its faces have there.

    Faces need not be plane: it is for measuring alone.
    """
    angle = _folds(folded.coords, sheet.polygons)
    phi = np.array([angle[side(*ends)] for ends in sheet.ends.tolist()])
    flat = math.pi - np.abs(phi) < NOISE
    phi[flat] = np.copysign(math.pi, np.where(sheet.signs == 0, phi, sheet.signs))[flat]
    return replace(sheet, corners=folded.coords, reference=phi)


def check_letters(f: Findings, p: Pattern, measured: np.ndarray) -> None:
    """Check letters against the signs of fold angles, measured ones [n] and those of the file."""
    for c, sign in enumerate(p.signs.tolist()):
        shown = measured[c] if abs(measured[c]) < math.pi else 0.0
        for phi, what in ((shown, "is folded by"), (p.file_angles[c], "has edges_foldAngle")):
            if sign * phi < -PLACES:
                letter = f"edge {p.numbers[c]} is a {'mountain' if sign < 0 else 'valley'}"
                text = f"{letter} and {what} {math.degrees(phi):+.6g} degrees"
                f.fault(LETTERS, text, abs(phi), edges=[p.numbers[c]])
                break
    if given := int((p.signs != 0).sum()):
        f.settle(LETTERS, f"{given} of {p.creases} creases")
    else:
        f.skip(LETTERS, "no edge is a mountain or a valley")


def is_coarse(phi: np.ndarray) -> bool:
    """Return whether angles [rad] have three decimals of a degree, or less."""
    milli = np.degrees(phi[~np.isnan(phi)]) / MILLI
    return bool((np.abs(milli - np.round(milli)) <= PLACES).all())


def _crease_noise(f: Findings, p: Pattern) -> np.ndarray:
    """Return by how much each measured fold angle may be off [rad]: places over the widths of the facets."""
    widths = np.full(p.creases, np.inf)
    sides = sides_of(p.polygons)
    for c, ends in enumerate(p.ends.tolist()):
        for k in sides[side(*ends)]:
            out = p.corners[list(p.polygons[k])] - p.corners[ends[0]]
            out = out - np.outer(out @ p.directions[c], p.directions[c])
            widths[c] = min(widths[c], float(np.linalg.norm(out, axis=1).max()))
    digits = math.radians(MILLI) if is_coarse(p.file_angles) else PLACES
    return 4 * f.lengths() / np.maximum(widths, NONZERO) + digits
