"""The list of a proof, found again by a second program: a sheet in doubles along curves, a vertex in boxes of balls."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np

from origami_nlp.pattern import Scene
from origami_nlp.proof.certificate import Certificate, StatedSheet, read_certificate
from origami_nlp.proof.sheet_check import NoSheet, sheet_minima
from origami_nlp.proof.vertex_check import BESIDE, VertexSearch

NEAR = 1e-5
"""By which a state may be listed off, beyond its radius [rad]."""
BOXES = 1_000_000
"""Of a vertex, all its windings: five minutes."""
SECOND = "a second program in {}, which found the list again; lemmas are those of the prover"


@dataclass(frozen=True)
class Check:
    """What came of a check.

    Attributes
    ----------
    refused
        What is listed and was not found, or found and is not listed, the first; empty: the lists are the same.
    minima
        How many were found again.
    open
        What the proof leaves open, or the check, a line each; empty: the list is complete.
    by
        What found it.
    """

    refused: str
    minima: int
    open: tuple[str, ...]
    by: str

    @property
    def lines(self) -> list[str]:
        """All of it, as the command prints it."""
        if self.refused:
            return [f"refused: {self.refused}"]
        many = f"{self.minima} {'minimum' if self.minima == 1 else 'minima'}"
        head = "checked" if not self.open else "checked, but not all is decided"
        return [f"{head}: {many} found again", *(f"open: {o}" for o in self.open), f"by {self.by}"]

    def to_dict(self) -> dict[str, object]:
        """Return all of it as plain data, for JSON."""
        return {
            "schema": "origami-nlp/check/1",
            "checked": not self.refused,
            "refused": self.refused or None,
            "complete": not (self.refused or self.open),
            "minima": self.minima,
            "open": list(self.open),
            "by": self.by,
        }


def check_proof(proof: str | Path | Certificate) -> Check:
    """Find the list of a proof again, by a second program.

    Parameters
    ----------
    proof
        The file, ``"-"`` for standard input, or a certificate that was read.

    Returns
    -------
    Check
        Whether the lists are the same.

    Raises
    ------
    CertificateError
        If the file cannot be read or is no proof.
    """
    said = read_certificate(proof) if isinstance(proof, str | Path) else proof
    found = _of_sheet(said.sheet) if said.sheet else _of_vertex(said, cast("Scene", said.scene))
    refused, left = found.refused, list(found.minima)
    for number, one in enumerate(said.minima, start=1):
        far = [float(np.abs(x - one.fold_angles).max()) for x in left]
        if not one.radius <= NEAR:
            refused = refused or f"minimum {number} is listed to within {one.radius:.3g} rad"
        elif not far or min(far) > NEAR + one.radius:
            refused = refused or f"minimum {number} was not found again"
        else:
            del left[int(np.argmin(far))]
    low, high = said.regions
    for phi in left:
        if not ((low - NEAR <= phi) & (phi <= high + NEAR)).all(axis=1).any():
            refused = refused or f"a minimum is not listed: {_angles(phi)}"
    reasons = (*(one.reason for one in said.undecided), *found.open)
    return Check(refused, len(found.minima), reasons, SECOND.format(found.arithmetic))


class _Found(NamedTuple):
    """Minima, why the proof is refused, what stays open, in which arithmetic."""

    minima: list[np.ndarray]
    refused: str
    open: list[str]
    arithmetic: str


def _of_sheet(sheet: StatedSheet) -> _Found:
    found: list[np.ndarray] = []
    with np.errstate(all="ignore"):
        try:
            for phi in sheet_minima(sheet):
                if not any(np.abs(phi - x).max() < NEAR for x in found):
                    found.append(phi)
        except NoSheet as problem:
            return _Found([], str(problem), [], "doubles")
    return _Found(found, "", [], "doubles")


def _of_vertex(said: Certificate, scene: Scene) -> _Found:
    if scene.contact != "fold-limits" or scene.laws or scene.loads or not scene.is_flat:
        return _Found([], "no vertex of linear springs within fold limits", [], "balls")
    low, high = said.regions
    listed = np.array([one.fold_angles for one in said.minima]).reshape(-1, 1, scene.degree)
    beside = ((low - BESIDE <= listed) & (listed <= high + BESIDE)).all(axis=2).any(axis=0)
    wider = np.where(beside, 0.0, BESIDE)[:, None]
    left_open, found = np.stack([low - wider, high + wider], axis=1), _Found([], "", [], "balls")
    boxes = 0
    if scene.is_symmetric:
        near = np.full((1, 2, scene.degree), BESIDE) * [[[-1], [1]]]
        left_open = np.concatenate([left_open, near])
        found.open.append(f"within {BESIDE:g} rad of the flat state the check does not look")
    for winding in scene.windings:
        search = VertexSearch(scene, winding, left_open, BOXES - boxes)
        boxes += search.boxes
        found.minima.extend(search.minima)
        if boxes >= BOXES:
            found.open.append(f"the check ended after {boxes} boxes")
        elif search.rest:
            why = f"a minimum is not excluded: {_angles(search.rest[0].mean(axis=0))}"
            return found._replace(refused=why)
    return found


def _angles(phi: np.ndarray) -> str:
    return f"fold angles ({', '.join(f'{a:.6g}' for a in np.degrees(phi).tolist())}) deg"
