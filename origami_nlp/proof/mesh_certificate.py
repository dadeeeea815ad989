"""The proof of a mesh whose vertices fold flat as a file: the sheet, its springs and the list, in plain JSON.

Schema ``origami-nlp/mesh-proof/1``.  Corners, stiffness and rest angles are the doubles of the pattern.  What is
claimed is the list; the check finds all closed states and their minima again.  Nothing in a file is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from origami_nlp.errors import CertificateError
from origami_nlp.io import Finite, from_plain, to_plain
from origami_nlp.proof.sheet_certificate import (
    CertifiedState,
    OpenInterval,
    StatedSheet,
    check_sheet,
)

MESH_SCHEMA = "origami-nlp/mesh-proof/1"


@dataclass(frozen=True)
class MeshCertificate(StatedSheet):
    """What the proof of a mesh claims of a sheet.

    Attributes
    ----------
    deviation
        By how much these corners differ at most from a sheet whose vertices fold flat, and whose equal sectors are
        equal, exactly, which is meant [rad].
    minima
        All of them, within fold limits; angles that are 0 or +-pi are so exactly.
    undecided
        What is left open.
    generic
        Whether vertices need not fold flat: then the deviation is of equal sectors alone.
    """

    deviation: Finite
    minima: tuple[CertifiedState, ...]
    undecided: tuple[OpenInterval, ...]
    generic: bool = field(default=False, metadata={"omit": True})


def mesh_to_dict(certificate: MeshCertificate) -> dict[str, Any]:
    """Return a certificate as plain data."""
    return {"schema": MESH_SCHEMA, **to_plain(certificate)}


def mesh_from_dict(data: dict[str, Any]) -> MeshCertificate:
    """Return the certificate that `mesh_to_dict` wrote: well formed, nothing in it is checked."""
    own = {key: value for key, value in data.items() if key != "schema"}
    said = from_plain(MeshCertificate, own, "proof", CertificateError)
    check_sheet(said, said.minima)
    return said
