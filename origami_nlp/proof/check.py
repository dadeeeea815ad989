"""A proof that a list of minima is complete, checked by a second arithmetic that knows nothing of the first.

The statement.  A flat vertex within fold limits |x_i| <= pi, or stops before, as it is, or among all states that keep a
symmetry, however often they wind round its axis (then x are the angles of its piece).  Every local minimum of U = sum
k_i/2 (x_i - rest_i)^2, or of hinge laws, among the closed states lies on the stratum of its pinned creases s_i = +-1
(x_i = s_i pi, or its stop), where Fritz John's condition holds on the free ones: the piece closes (the whole vertex
with q = +1), and all minors of m + 1 rows of [G | C] vanish, G_i = k_i (x_i - rest_i), or the torque of a law, C_i the
slopes of the m closure equations; creases whose axes coincide all over a stratum have torques that agree up to the same
sign.  No regularity is assumed.

What is checked.  (a) The tree covers all 3^n strata; every box that is dropped, and every part that a contraction
removes, holds no such state.  (b) Each point claimed exists, is the only one within its radius, and is of the kind
claimed; leaves that rest on it lie within that radius.  (c) Leaves at the flat state lie where the flat lemma is shown
anew.  (d) What the proof leaves open is reported.  (e) The minima claimed are those of (b).  (f) With symmetry there is
a tree for every way in which the whole vertex closes, from the product of all its folds (`check_whole`).

Proofs of strips and of meshes have statements of their own: `check_strips`, `check_mesh`.

What is trusted.  This file, `certificate` and `check_*`, which share no code with the search; the reading of a scene,
with its symmetry; python-flint and FLINT (`arb`: midpoint and radius, rounded outwards); Python, and NumPy where it
suggests numbers that are then tested; the machine.  Sectors stand for all within two units in the last place that close
flat, symmetrically where a symmetry is kept; sums of sectors that are multiples of pi (or pi/2, across a mirror) to
within that are such.  Stiffness and rest angles are the doubles of the file; of a hinge law slopes are those of its
pieces, and the torque goes on from piece to piece (`check_laws`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from origami_nlp.errors import OptionError
from origami_nlp.proof.certificate import KINDS, Certificate, read_certificate
from origami_nlp.proof.mesh_certificate import MeshCertificate
from origami_nlp.proof.strip_certificate import StripCertificate

if TYPE_CHECKING:
    from origami_nlp.proof.check_points import Located


@dataclass(frozen=True)
class Check:
    """What came of a check.

    Attributes
    ----------
    refused
        The first claim that was not confirmed, with its place; empty: all were.
    minima
        Numbers (from 1) of the points that are minima.
    points
        Fold angles of all points, shape [P, N].
    indices
        How many points have each index; None: unclear.
    open
        What the proof leaves open, a line each; empty: the list of minima is complete.
    nodes
        How many nodes of each kind were checked.
    trusted
        What this rests on, a line each.
    """

    refused: str
    minima: tuple[int, ...]
    points: tuple[tuple[float, ...], ...]
    indices: dict[int | None, int]
    open: tuple[str, ...]
    nodes: dict[str, int]
    trusted: tuple[str, ...]

    @property
    def lines(self) -> list[str]:
        """All of it, as the command prints it."""
        if self.refused:
            return [f"refused: {self.refused}"]
        count = f"{len(self.minima)} {'minimum' if len(self.minima) == 1 else 'minima'}"
        boxes = f"{sum(self.indices.values())} critical points, {sum(self.nodes.values()):,} nodes"
        head = "checked: complete" if not self.open else "checked, but not all is decided"
        about = [f"{head} - {count}, {boxes}"]
        kinds = sorted(self.indices.items(), key=lambda item: (item[0] is None, item[0]))
        about.append(
            "critical points by index: "
            + (", ".join(f"{'unclear' if i is None else i}: {c}" for i, c in kinds) or "none")
        )
        about += [f"minimum: point {p}, {degrees(self.points[p - 1])}" for p in self.minima]
        about += [f"open: {line}" for line in self.open]
        return about + [f"trusted: {line}" for line in self.trusted]

    def to_dict(self) -> dict[str, object]:
        """Return all of it as plain data, for JSON."""
        return {
            "schema": "origami-nlp/proof/1",
            "checked": not self.refused,
            "refused": self.refused or None,
            "complete": not (self.refused or self.open),
            "minima": [list(self.points[p - 1]) for p in self.minima],
            "critical_points": {
                "unclear" if i is None else str(i): c for i, c in self.indices.items()
            },
            "open": list(self.open),
            "nodes": self.nodes,
            "trusted": list(self.trusted),
        }


def check_proof(
    proof: str | Path | Certificate | StripCertificate | MeshCertificate,
    progress: Callable[[int, int], object] | None = None,
) -> Check:
    """Check a proof from its file: every claim, by ball arithmetic of its own.

    Parameters
    ----------
    proof
        The file, ``"-"`` for standard input, or a certificate that was read.
    progress
        Called with the nodes that are checked and their number.

    Returns
    -------
    Check
        What was confirmed, or the first claim that was not.

    Raises
    ------
    CertificateError
        If the file cannot be read or is no proof.
    OptionError
        If python-flint is not there.
    """
    certificate = read_certificate(proof) if isinstance(proof, str | Path) else proof
    try:  # by itself: the check shares no code with the search
        import flint
    except ImportError:
        raise OptionError(
            'checking a proof needs python-flint: pip install "origami_nlp[proof]"'
        ) from None
    if isinstance(certificate, StripCertificate | MeshCertificate):
        return _check_sheet(certificate, progress or (lambda done, total: None))
    from origami_nlp.proof.check_replay import COARSE, FINE, Refused, Replay

    every = (certificate, *certificate.others)
    replays = [Replay(one, progress or (lambda done, total: None)) for one in every]
    refused = ""
    # the first refusal ends the check: nothing is confirmed in part
    for one, replay in zip(every, replays, strict=True):
        try:
            replay.run()
        except Refused as problem:
            refused = _winding(one) + str(problem)
            break
    trusted = (
        f"python-flint {flint.__version__} ({COARSE} bits for boxes, {FINE} for points), Python, NumPy for suggestions",
        "sector angles: all vertices within 2 units in the last place of these, that close flat; "
        "sums that are multiples of pi to that precision are taken as such",
        "the statement: a minimum closes with q = +1, and its torques are those of one moment (det [G | C] = 0)",
    )
    found = [one for replay in replays for one in replay.found]
    left = [
        _winding(one) + line
        for one, replay in zip(every, replays, strict=True)
        if not refused
        for line in _open(one, replay.found, replay.flat_falls)
    ]
    return Check(
        refused,
        tuple(i for i, one in enumerate(found, start=1) if one.is_minimum),
        tuple(p.x for one in every for p in one.points),
        dict(Counter(one.index for one in found)),
        tuple(left),
        {KINDS[k]: c for k, c in sorted(sum((r.counts for r in replays), Counter[int]()).items())},
        trusted,
    )


def _check_sheet(
    said: StripCertificate | MeshCertificate, progress: Callable[[int, int], object]
) -> Check:
    import flint

    from origami_nlp.proof.check_lists import BITS
    from origami_nlp.proof.check_mesh import MeshCheck
    from origami_nlp.proof.check_points import Refused
    from origami_nlp.proof.check_quads import QuadCheck
    from origami_nlp.proof.check_strips import StripCheck

    check: StripCheck | MeshCheck | QuadCheck
    if isinstance(said, StripCertificate):
        check = StripCheck(said, progress)
        about = [
            "the statement: round a flat vertex of degree four 1 - cos of opposite folds have one ratio (Rodrigues)"
        ]
        if said.contact:
            about.append(
                "facets round a vertex that closes with q = +1 do not cross, being convex (shown in `docs`, not here)"
            )
    elif said.generic:
        check = QuadCheck(said, progress)
        about = [
            f"the sheet: its equal sectors are equal, exactly (the file: {said.deviation:.2g} rad)",
            "the statement: cotangents of half the folds round a flat vertex of degree four, from the product of four "
            "quaternions",
        ]
    else:
        check = MeshCheck(said, progress)
        about = [
            f"the sheet: vertices fold flat and equal sectors are equal, exactly (the file: {said.deviation:.2g} rad)",
            "the statement: round such a vertex opposite folds are equal up to sign, and tangents of half the others "
            "proportional, or creases in one line are at +-180 degrees, or those across are 0",
        ]
    refused = ""
    try:
        check.run()
    except Refused as problem:
        refused = str(problem)
    # of a strip all that are listed, or it is refused
    found = (
        check.confirmed
        if isinstance(check, MeshCheck | QuadCheck)
        else range(1, len(said.minima) + 1)
    )
    return Check(
        refused,
        () if refused else tuple(found),
        tuple(m.fold_angles for m in said.minima),
        {0: len(found), 1: check.maxima},
        () if refused else tuple(check.open),
        dict(sorted(check.counts.items())),
        (f"python-flint {flint.__version__} ({BITS} bits), Python, NumPy for suggestions", *about),
    )


def _winding(certificate: Certificate) -> str:
    """Name the states that a certificate is about, where they wind more than once."""
    winding = certificate.scene.winding or 1
    return f"winding {winding}: " if winding > 1 else ""


def degrees(angles: Sequence[float]) -> str:
    """Fold angles in degrees, as text.

    Parameters
    ----------
    angles
        Fold angles [rad].

    Returns
    -------
    str
        Such as ``(12.3, -180) deg``.
    """
    return "(" + ", ".join(f"{math.degrees(a):.6g}" for a in angles) + ") deg"


def _open(certificate: Certificate, found: Sequence[Located], flat_falls: bool) -> Iterator[str]:
    """Describe what the proof leaves open."""
    for name in ("singular", "undecided"):
        for number, left in enumerate(getattr(certificate, name), start=1):
            middle = [0.5 * (a + b) for a, b in zip(left.lower, left.upper, strict=True)]
            size = max(b - a for a, b in zip(left.lower, left.upper, strict=True))
            yield f"{name} box {number}, {size:.2g} rad wide around {degrees(middle)}: {left.reason}"
    for number, (point, one) in enumerate(zip(certificate.points, found, strict=True), start=1):
        if one.is_minimum is None:
            yield f"point {number}, {degrees(point.x)}: whether it is a minimum"
        elif one.is_minimum and point.is_minimum is None:
            yield f"point {number}, {degrees(point.x)}: a minimum, which the proof does not say"
    if not flat_falls:
        yield "the flat state: whether it is a minimum"
