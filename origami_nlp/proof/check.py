"""A proof that the list of minima of a sheet is complete, checked by an arithmetic that knows nothing of the first.

What is stated of meshes, and how it is decided: `check_mesh`, `check_quads`.  The proof of a vertex can be written and
read, and is not checked.

What is trusted.  This file, `*_certificate` and `check_*`, which share no code with the search; python-flint and FLINT
(`arb`: midpoint and radius, rounded outwards); Python, and NumPy where it suggests numbers that are then tested; the
machine.  Corners, stiffness and rest angles are the doubles of the file.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from origami_nlp.errors import OptionError
from origami_nlp.proof.certificate import Certificate, read_certificate
from origami_nlp.proof.mesh_certificate import MeshCertificate


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
        How many points have each index.
    open
        What the proof leaves open, a line each; empty: the list of minima is complete.
    nodes
        What was gone through, by kind.
    trusted
        What this rests on, a line each.
    """

    refused: str
    minima: tuple[int, ...]
    points: tuple[tuple[float, ...], ...]
    indices: dict[int, int]
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
        kinds = ", ".join(f"{i}: {c}" for i, c in sorted(self.indices.items()))
        about.append(f"critical points by index: {kinds}")
        for p in self.minima:
            angles = ", ".join(f"{math.degrees(a):.6g}" for a in self.points[p - 1])
            about.append(f"minimum: point {p}, ({angles}) deg")
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
            "critical_points": {str(i): c for i, c in self.indices.items()},
            "open": list(self.open),
            "nodes": self.nodes,
            "trusted": list(self.trusted),
        }


def check_proof(
    proof: str | Path | Certificate | MeshCertificate,
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
        If it is of a vertex, or python-flint is not there.
    """
    said = read_certificate(proof) if isinstance(proof, str | Path) else proof
    if isinstance(said, Certificate):
        raise OptionError("the proof is of a vertex: proofs of meshes are checked")
    try:  # by itself: the check shares no code with the search
        import flint
    except ImportError:
        raise OptionError(
            'checking a proof needs python-flint: pip install "origami_nlp[proof]"'
        ) from None
    from origami_nlp.proof.check_lists import BITS, Refused
    from origami_nlp.proof.check_mesh import MeshCheck
    from origami_nlp.proof.check_quads import QuadCheck

    progress = progress or (lambda done, total: None)
    check: MeshCheck | QuadCheck
    if said.generic:
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
    return Check(
        refused,
        () if refused else tuple(check.confirmed),
        tuple(m.fold_angles for m in said.minima),
        {0: len(check.confirmed), 1: check.maxima},
        () if refused else tuple(check.open),
        dict(sorted(check.counts.items())),
        (f"python-flint {flint.__version__} ({BITS} bits), Python, NumPy for suggestions", *about),
    )
