"""A proof as a file: what it claims, and the tree that shows it, in JSON that another program can read.

Schema ``origami-nlp/proof/1``. ``scene``: the tables of a scene file, and ``exact``, the same numbers as hexadecimal
doubles; the two must agree. ``others``: documents of the same schema for states that wind more often. ``points``,
``singular``, ``undecided``: lists of objects with the names below. ``tree``: ``nodes`` and arrays, each base64 of zlib
of its little-endian numbers with their bytes gathered by significance (all first bytes, all second bytes, ...). Nothing
in a file is evaluated.
"""

from __future__ import annotations

import base64
import json
import math
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.errors import CertificateError, OrigamiError
from origami_nlp.files import read_limited, write_json
from origami_nlp.pattern import Scene, scene_from_dict, scene_to_dict

SCHEMA = "origami-nlp/proof/1"
LARGEST = 1_000_000_000
"""Bytes of a file, and of an array of its tree."""
KINDS = (
    *("split", "contract", "narrow", "closed", "none"),
    *("minor", "twin", "flat", "root", "singular", "undecided"),
)
"""Kinds of nodes, by their number in a file: two halves; a smaller box, what is cut off holding no closed state, or no
critical one; no closed state; no critical state; a minor, or a twin row, that does not vanish; near the flat state; in
the box of a point, or in one that is left open."""
SPLIT, CONTRACT, NARROW, CLOSED, NONE, MINOR, TWIN, FLAT, ROOT, SINGULAR, UNDECIDED = range(
    len(KINDS)
)


@dataclass(frozen=True)
class Point:
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

    x: tuple[float, ...]
    stratum: tuple[int, ...]
    moment: tuple[float, ...]
    radius: float
    unique_radius: float
    index: int | None
    pinned_signs: tuple[int, ...]
    energy: float
    is_minimum: bool | None


@dataclass(frozen=True)
class Left:
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

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    stratum: tuple[int, ...]
    reason: str


@dataclass(frozen=True, eq=False)
class Nodes:
    """A tree in preorder, the trees of all strata one after the other, (0, +1, -1)^N in lexicographic order.

    Attributes
    ----------
    kind
        Positions in `KINDS`, uint8 [M].
    number
        Of a split its axis; of a closed leaf a hint; of a minor the four creases as bits; of twins a, b: a N + b;
        of other leaves which point or box; int32 [M].
    boxes
        Ends of the boxes of contract and narrow nodes, in order, float64 [C, 2, N] [rad].
    """

    kind: np.ndarray
    number: np.ndarray
    boxes: np.ndarray


@dataclass(frozen=True, eq=False)
class Certificate:
    """What a proof claims of a scene, and its tree.

    Attributes
    ----------
    scene
        The scene.
    r0
        Radius [rad] around the flat state where leaves rest on the flat lemma.
    points
        Critical points.
    singular, undecided
        What is left open: states of dependent axes, and all else.
    nodes
        The tree.
    others
        The same for states that wind more than once round the axis of their symmetry, each with a scene that says how
        often.
    """

    scene: Scene
    r0: float
    points: tuple[Point, ...]
    singular: tuple[Left, ...]
    undecided: tuple[Left, ...]
    nodes: Nodes
    others: tuple[Certificate, ...] = ()


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
    scene, nodes = certificate.scene, certificate.nodes
    lists = ("points", "singular", "undecided")
    counts = np.bincount(nodes.kind, minlength=len(KINDS)).tolist()
    return {
        "schema": SCHEMA,
        "scene": scene_to_dict(scene),
        "exact": {name: [v.hex() for v in values] for name, values in _exact(scene).items()},
        "r0": certificate.r0,
        **{name: [asdict(one) for one in getattr(certificate, name)] for name in lists},
        **(
            {"others": [certificate_to_dict(o) for o in certificate.others]}
            if certificate.others
            else {}
        ),
        "counts": dict(zip(KINDS, counts, strict=True)),
        "tree": {
            "nodes": len(nodes.kind),
            "kind": _packed(nodes.kind, "u1"),
            "number": _packed(nodes.number, "<i4"),
            "boxes": _packed(nodes.boxes, "<f8"),
        },
    }


def write_certificate(certificate: Certificate, target: str | Path) -> None:
    """Write a certificate to a file, whole or not at all.

    Parameters
    ----------
    certificate
        The certificate.
    target
        The file, or ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If it cannot be written.
    """
    write_json(certificate_to_dict(certificate), target)


def read_certificate(source: str | Path) -> Certificate:
    """Read a certificate from a file.

    Parameters
    ----------
    source
        The file, or ``"-"`` for standard input.

    Returns
    -------
    Certificate
        The certificate: well formed, nothing in it is checked.

    Raises
    ------
    CertificateError
        If it cannot be read or is none.
    """
    raw = read_limited(source, LARGEST, "proof", CertificateError)
    try:
        data = json.loads(raw, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as problem:
        raise CertificateError(f"proof {str(source)!r} is not valid JSON: {problem}") from None
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
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise CertificateError(f"schema is not {SCHEMA!r}: this is no proof")
    try:
        scene = scene_from_dict(_entry(data, "scene", dict))
    except CertificateError:
        raise
    except (OrigamiError, TypeError) as problem:
        raise CertificateError(f"scene of the proof: {problem}") from None
    exact = _entry(data, "exact", dict)
    for name, values in _exact(scene).items():
        if exact.get(name) != [v.hex() for v in values]:
            raise CertificateError(f"exact.{name} is not what the scene of the proof says")
    n = len(set(scene.group.orbit))  # variables: one for each orbit of creases
    r0 = _number(data, "r0")
    points = tuple(_point(p, f"points[{i}]", n) for i, p in _objects(data, "points"))
    singular, undecided = (
        tuple(_left(c, f"{name}[{i}]", n) for i, c in _objects(data, name))
        for name in ("singular", "undecided")
    )
    others: tuple[Certificate, ...] = ()
    if "others" in data:
        others = tuple(certificate_from_dict(one) for _, one in _objects(data, "others"))
    tree = _nodes(_entry(data, "tree", dict), n)
    return Certificate(scene, r0, points, singular, undecided, tree, others)


def _exact(scene: Scene) -> dict[str, tuple[float, ...]]:
    return {
        "sector_angles": scene.vertex.sector_angles,
        "stiffness": scene.stiffness,
        "rest_angles": scene.wound_angles,
    }


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is no number")


def _entry(data: Mapping[str, Any], name: str, kind: type) -> Any:
    value = data.get(name)
    if not isinstance(value, kind):
        raise CertificateError(f"{name} of the proof is missing, or not what it should be")
    return value


def _objects(data: Mapping[str, Any], name: str) -> list[tuple[int, dict[str, Any]]]:
    items = _entry(data, name, list)
    if not all(isinstance(item, dict) for item in items):
        raise CertificateError(f"{name} of the proof must be a list of objects")
    return list(enumerate(items, start=1))


def _number(data: Mapping[str, Any], name: str, where: str = "") -> float:
    value = data.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not _finite(value):
        raise CertificateError(f"{where}{name} of the proof must be a finite number")
    return float(value)


def _finite(value: float) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond all doubles
        return False


def _numbers(
    data: Mapping[str, Any], name: str, where: str, length: int | None
) -> tuple[float, ...]:
    """Read so many numbers; None: at most three."""
    values = data.get(name)
    lengths = (1, 2, 3) if length is None else (length,)
    if not isinstance(values, list) or len(values) not in lengths:
        raise CertificateError(f"{where}.{name} of the proof must be {lengths[-1]} numbers")
    return tuple(_number({name: v}, name, f"{where}.") for v in values)


def _signs(data: Mapping[str, Any], name: str, where: str, length: int) -> tuple[int, ...]:
    values = _numbers(data, name, where, length)
    if not set(values) <= {-1.0, 0.0, 1.0}:
        raise CertificateError(f"{where}.{name} of the proof must be -1, 0 or 1 for each crease")
    return tuple(int(v) for v in values)


def _optional(data: Mapping[str, Any], name: str, where: str, kind: type) -> Any:
    value = data.get(name)
    if value is not None and type(value) is not kind:
        raise CertificateError(f"{where}.{name} of the proof must be null, or {kind.__name__}")
    return value


def _point(data: dict[str, Any], where: str, n: int) -> Point:
    return Point(
        x=_numbers(data, "x", where, n),
        stratum=_signs(data, "stratum", where, n),
        moment=_numbers(data, "moment", where, None),
        radius=_number(data, "radius", f"{where}."),
        unique_radius=_number(data, "unique_radius", f"{where}."),
        index=_optional(data, "index", where, int),
        pinned_signs=_signs(data, "pinned_signs", where, n),
        energy=_number(data, "energy", f"{where}."),
        is_minimum=_optional(data, "is_minimum", where, bool),
    )


def _left(data: dict[str, Any], where: str, n: int) -> Left:
    reason = data.get("reason")
    if not isinstance(reason, str):
        raise CertificateError(f"{where}.reason of the proof must be text")
    lower, upper = (_numbers(data, name, where, n) for name in ("lower", "upper"))
    return Left(lower, upper, _signs(data, "stratum", where, n), reason)


def _nodes(tree: dict[str, Any], n: int) -> Nodes:
    count = tree.get("nodes")
    if type(count) is not int or not 0 < count < LARGEST:
        raise CertificateError("tree.nodes of the proof must be a positive number")
    kind, number = _unpacked(tree, "kind", "u1", count), _unpacked(tree, "number", "<i4", count)
    if kind.max() >= len(KINDS):
        raise CertificateError(f"tree.kind of the proof holds {kind.max()}: no such kind of node")
    boxes = _unpacked(tree, "boxes", "<f8", int(np.isin(kind, (CONTRACT, NARROW)).sum()) * 2 * n)
    if not np.isfinite(boxes).all():
        raise CertificateError("tree.boxes of the proof holds what is no number")
    return Nodes(kind, number, boxes.reshape(-1, 2, n))


def _packed(values: np.ndarray, dtype: str) -> str:
    array = np.ascontiguousarray(values, dtype=dtype).reshape(-1)
    by_byte = array.view(np.uint8).reshape(-1, array.itemsize).T
    return base64.b64encode(zlib.compress(by_byte.tobytes(), 9)).decode()


def _unpacked(tree: dict[str, Any], name: str, dtype: str, count: int) -> np.ndarray:
    text, size = tree.get(name), np.dtype(dtype).itemsize
    try:
        packed = base64.b64decode(text, validate=True)  # type: ignore[arg-type]
        stream = zlib.decompressobj()
        raw = stream.decompress(packed, count * size + 1)  # no more than there should be
        whole = stream.eof and not stream.unused_data and len(raw) == count * size
    except (TypeError, ValueError, zlib.error):
        whole = False
    if not whole:
        raise CertificateError(f"tree.{name} of the proof is damaged or cut short")
    gathered = np.frombuffer(raw, np.uint8).reshape(size, count).T
    return np.ascontiguousarray(gathered).reshape(-1).view(dtype)
