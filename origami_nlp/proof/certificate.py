"""A proof as a file: what it claims, in JSON that another program can read.

Schema ``origami-nlp/proof/1``. ``scene``: the tables of a scene file, and ``exact``, the same numbers as hexadecimal
doubles; the two must agree. ``others``: documents of the same form for states that wind more often. ``points``,
``singular``, ``undecided``: lists of objects with the names below. Nothing in a file is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

from origami_nlp.errors import CertificateError
from origami_nlp.io import Finite, check_schema, from_plain, read_json, to_plain, write_json
from origami_nlp.pattern import Scene
from origami_nlp.proof.mesh_certificate import (
    MESH_SCHEMA,
    MeshCertificate,
    mesh_from_dict,
    mesh_to_dict,
)

SCHEMA = "origami-nlp/proof/1"
LARGEST = 1_000_000_000
"""Bytes of a file."""

Sign: TypeAlias = Literal[-1, 0, 1]


@dataclass(frozen=True)
class CertifiedPoint:
    """A critical point that is claimed: it exists, and is alone in its box.

    Attributes
    ----------
    x
        Fold angles, shape [N] [rad].
    stratum
        Sign of each pinned crease, 0 where free, shape [N].
    moment
        m with k_i (x_i - rest_i) = m . c_i at free creases, shape [number of closure equations].
    radius
        The true one is within so much of `x` (largest difference) [rad].
    unique_radius
        No other of its stratum is within so much of `x` [rad].
    index
        Negative directions of the energy's Hessian on the stratum; None: not claimed.
    pinned_signs
        At pinned creases, -1 if it pushes against its limit, +1 if it would leave, 0 if not claimed; 0 at free ones.
    energy
        U.
    is_minimum
        True, False, or None: not claimed.
    """

    x: tuple[Finite, ...]
    stratum: tuple[Sign, ...]
    moment: tuple[Finite, ...]
    radius: Finite
    unique_radius: Finite
    index: int | None
    pinned_signs: tuple[Sign, ...]
    energy: Finite
    is_minimum: bool | None


@dataclass(frozen=True)
class UndecidedBox:
    """A box that the proof leaves open.

    Attributes
    ----------
    lower, upper
        Its ends, shape [N] [rad].
    stratum
        Sign of each pinned crease, 0 where free.
    reason
        In words.
    """

    lower: tuple[Finite, ...]
    upper: tuple[Finite, ...]
    stratum: tuple[Sign, ...]
    reason: str


@dataclass(frozen=True)
class Certificate:
    """What a proof claims of a scene.

    Attributes
    ----------
    scene
        The scene.
    r0
        Radius [rad] around the flat state within which there is no other critical point; 0.0 where that is not claimed.
    points
        Critical points.
    singular, undecided
        What is left open: states of dependent axes, and all else.
    others
        The same for states that wind more than once round the axis of their symmetry, each with a scene that says how
        often.
    """

    scene: Scene
    r0: float
    points: tuple[CertifiedPoint, ...]
    singular: tuple[UndecidedBox, ...]
    undecided: tuple[UndecidedBox, ...]
    others: tuple[Certificate, ...] = ()


@dataclass(frozen=True)
class _Document:
    """What a file holds, but its schema."""

    scene: Scene
    exact: dict[str, tuple[str, ...]]
    r0: Finite
    points: tuple[CertifiedPoint, ...]
    singular: tuple[UndecidedBox, ...]
    undecided: tuple[UndecidedBox, ...]
    others: tuple[_Document, ...] = field(default=(), metadata={"omit": True})


def certificate_to_dict(certificate: Certificate) -> dict[str, Any]:
    """Write a certificate as plain data.

    Parameters
    ----------
    certificate
        The certificate.

    Returns
    -------
    dict
        Of schema ``origami-nlp/proof/1``.
    """
    return {"schema": SCHEMA, **to_plain(_document(certificate))}


def _document(certificate: Certificate) -> _Document:
    return _Document(
        certificate.scene,
        _exact(certificate.scene),
        certificate.r0,
        certificate.points,
        certificate.singular,
        certificate.undecided,
        tuple(map(_document, certificate.others)),
    )


def write_certificate(certificate: Certificate | MeshCertificate, target: str | Path) -> None:
    """Write a certificate to a file, whole or not at all.

    Parameters
    ----------
    certificate
        Of a vertex or of a mesh.
    target
        The file, or ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If it cannot be written.
    """
    if isinstance(certificate, MeshCertificate):
        write_json(mesh_to_dict(certificate), target)
    else:
        write_json(certificate_to_dict(certificate), target)


def read_certificate(source: str | Path) -> Certificate | MeshCertificate:
    """Read a certificate from a file.

    Parameters
    ----------
    source
        The file, or ``"-"`` for standard input.

    Returns
    -------
    Certificate or MeshCertificate
        Of a vertex or of a mesh: well formed, nothing in it is checked.

    Raises
    ------
    CertificateError
        If it cannot be read or is not one.
    """
    data = read_json(source, LARGEST, "proof", CertificateError)
    if isinstance(data, dict) and data.get("schema") == MESH_SCHEMA:
        return mesh_from_dict(data)
    return certificate_from_dict(data)


def certificate_from_dict(data: Any) -> Certificate:
    """Make a certificate of plain data.

    Parameters
    ----------
    data
        As `certificate_to_dict` writes it.

    Returns
    -------
    Certificate
        The certificate.

    Raises
    ------
    CertificateError
        If an entry is missing or does not fit; the message names it.
    """
    check_schema(data, SCHEMA, "proof", CertificateError)
    own = {key: value for key, value in data.items() if key != "schema"}
    return _certificate(from_plain(_Document, own, "proof", CertificateError))


def _certificate(said: _Document) -> Certificate:
    for name, values in _exact(said.scene).items():
        if said.exact.get(name) != values:
            raise CertificateError(f"exact.{name} is not what the scene of the proof says")
    n = len(set(said.scene.group.orbit))  # variables: one for each orbit of creases
    for name in ("points", "singular", "undecided"):
        for i, one in enumerate(getattr(said, name), start=1):
            for key in ("x", "stratum", "pinned_signs", "lower", "upper"):
                if len(getattr(one, key, range(n))) != n:
                    raise CertificateError(f"{name}[{i}].{key} of the proof must be {n} numbers")
            if not 1 <= len(getattr(one, "moment", "m")) <= 3:
                raise CertificateError(f"{name}[{i}].moment of the proof must be 3 numbers")
    others = tuple(map(_certificate, said.others))
    return Certificate(said.scene, said.r0, said.points, said.singular, said.undecided, others)


def _exact(scene: Scene) -> dict[str, tuple[str, ...]]:
    numbers = {
        "sector_angles": scene.vertex.sector_angles,
        "stiffness": scene.stiffness,
        "rest_angles": scene.wound_angles,
    }
    if scene.limits:
        numbers["limits"] = tuple(float(a) for a in scene.limit_angles.T.ravel())
    for i, law in enumerate(scene.laws, start=1):
        if law is not None:
            numbers[f"laws[{i}]"] = tuple(
                float(v) for v in (*law.breaks, *sum(law.coefficients, ()))
            )
    if scene.laws and scene.preload:
        numbers["preload"] = scene.preload
    return {name: tuple(v.hex() for v in values) for name, values in numbers.items()}
