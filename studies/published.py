"""Published candidate states of the paper's two vertex families: JSON or CSV, read strictly.

A record gives degree (6 or 8), the sector angle alpha_1, the stiffness ratio r_k and fold angles: all N of
them, or the independent ones (phi_1..phi_4 for degree 6, phi_1..phi_3 for degree 8).  Radians, numbers or
text such as ``"pi/4"``.

- JSON: ``{"records": [...]}`` or a list of records; keys ``degree``, ``alpha`` or ``alpha1``, ``ratio`` or
  ``rk``, ``phi``; optional ``branch``, ``kind`` (kept as notes) and ``alpha1_label``, ``alpha1_as_listed``,
  ``handle``, ``list``, ``closure_at_label_alpha`` (ignored).
- CSV: columns ``degree``, ``alpha``, ``ratio``, ``phi_1`` .. ``phi_N``; unused angles stay empty.

Files are data: nothing in them is evaluated.
"""

from __future__ import annotations

import csv
import io
import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from origami_nlp.errors import OrigamiError, SceneFileError
from origami_nlp.pattern import Scene, examples, format_angle, parse_angle, parse_angles

INDEPENDENT = {6: (0, 1, 2, 3, 2, 1), 8: (0, 1, 2, 1, 0, 1, 2, 1)}
"""For each degree, which independent fold angle every crease has (D1 and D2 of the paper)."""
LARGEST = 50_000_000
"""Largest file [bytes]."""
PRINTED = 1e-6
"""Accuracy of published fold angles [rad], of seven digits: closure, symmetry and equality are judged to it."""
_ALIASES = {"alpha1": "alpha", "rk": "ratio"}
_NEEDED = ("degree", "alpha", "ratio", "phi")
_NOTES = ("branch", "kind")
_IGNORED = ("alpha1_label", "alpha1_as_listed", "handle", "list", "closure_at_label_alpha")


@dataclass(frozen=True)
class Candidate:
    """One published state.

    number: position in the file, 1-based.  alpha, ratio: alpha_1 [rad] and r_k.
    independent: phi_1..phi_4 (degree 6) or phi_1..phi_3 (degree 8) [rad].
    branch, kind: notes of the file, as text; empty if absent.
    """

    number: int
    degree: int
    alpha: float
    ratio: float
    independent: tuple[float, ...]
    branch: str = ""
    kind: str = ""

    @property
    def fold_angles(self) -> tuple[float, ...]:
        """All N fold angles [rad]."""
        return tuple(self.independent[i] for i in INDEPENDENT[self.degree])

    @property
    def panel(self) -> tuple[int, float, float]:
        """Degree, alpha_1 to 12 decimals and r_k: candidates of one panel share it."""
        return self.degree, round(self.alpha, 12), self.ratio

    def scene(self, alpha: float | None = None) -> Scene:
        """Make the paper's scene of the candidate, with full contact; `alpha` overrides alpha_1."""
        make = examples.degree6 if self.degree == 6 else examples.degree8
        return make(format_angle(self.alpha if alpha is None else alpha), self.ratio)


def read_candidates(source: str | Path) -> tuple[Candidate, ...]:
    """Read candidates from a ``.json`` or ``.csv`` file, or JSON from standard input for ``"-"``.

    Raises
    ------
    SceneFileError
        If the file cannot be read or a record is malformed; the message names the record.
    """
    name = str(source)
    try:
        if name == "-":
            raw = sys.stdin.buffer.read(LARGEST + 1)
        else:
            with open(source, "rb") as file:
                raw = file.read(LARGEST + 1)
    except OSError as error:
        raise SceneFileError(f"cannot read candidates {name!r}: {error.strerror}") from None
    if len(raw) > LARGEST:
        raise SceneFileError(f"candidates {name!r}: larger than 50 MB")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SceneFileError(f"candidates {name!r} is not UTF-8 text: {error.reason}") from None
    if name.lower().endswith(".csv"):
        return parse_csv(text)
    if name == "-" or name.lower().endswith(".json"):
        return parse_json(text)
    raise SceneFileError(f"candidates {name!r}: the name must end in .json or .csv")


def parse_json(text: str) -> tuple[Candidate, ...]:
    """Read candidates from JSON text."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        first = (str(error).splitlines() or ["nested too deeply"])[0]
        raise SceneFileError(f"candidates are not valid JSON: {first}") from None
    if isinstance(data, dict):
        unknown = sorted(set(data) - {"meta", "records"})
        if unknown or "records" not in data:
            raise SceneFileError(
                'candidates must be a list, or a table with "records" (and "meta"): found '
                + (", ".join(map(repr, sorted(data)[:5])) or "nothing")
            )
        data = data["records"]
    if not isinstance(data, list):
        raise SceneFileError(f"candidates must be a list of records, not {type(data).__name__}")
    if not data:
        raise SceneFileError("candidates: the file has no record")
    return tuple(_candidate(i, record) for i, record in enumerate(data, start=1))


def parse_csv(text: str) -> tuple[Candidate, ...]:
    """Read candidates from CSV text with a header line."""
    try:
        rows = [row for row in csv.reader(io.StringIO(text), strict=True) if any(row)]
    except csv.Error as error:
        raise SceneFileError(f"candidates are not valid CSV: {error}") from None
    if len(rows) < 2:
        raise SceneFileError("candidates: the file needs a header and at least one record")
    header = [_ALIASES.get(cell.strip(), cell.strip()) for cell in rows[0]]
    angles = [name for name in header if name.startswith("phi_")]
    wanted = [f"phi_{i}" for i in range(1, len(angles) + 1)]
    unknown = [n for n in header if n not in (*angles, *_NEEDED[:3], *_NOTES)]
    if unknown or len(set(header)) != len(header) or angles != wanted or len(angles) < 3:
        what = f"unknown column {unknown[0]!r}" if unknown else f"header {','.join(rows[0])!r}"
        raise SceneFileError(
            f"candidates: {what}: use degree, alpha, ratio, phi_1 .. phi_N (optional branch, kind)"
        )
    out = []
    for i, row in enumerate(rows[1:], start=1):
        if len(row) != len(header):
            raise SceneFileError(f"record {i} has {len(row)} cells, the header {len(header)}")
        cells = {name: cell.strip() for name, cell in zip(header, row, strict=True)}
        phi = [cells.pop(name) for name in angles]
        while phi and not phi[-1]:
            phi.pop()
        record: dict[str, Any] = {**cells, "phi": phi}
        record["degree"] = _whole(i, cells.get("degree", ""))
        record["ratio"] = _real(i, cells.get("ratio", ""))
        out.append(_candidate(i, record))
    return tuple(out)


def _candidate(number: int, record: Any) -> Candidate:
    where = f"record {number}"
    if not isinstance(record, Mapping):
        raise SceneFileError(f"{where} = {str(record)[:40]!r} must be a table")
    values: dict[str, Any] = {}
    for key, value in record.items():
        name = _ALIASES.get(key, key)
        if name not in (*_NEEDED, *_NOTES, *_IGNORED):
            raise SceneFileError(f"{where}: unknown key {key!r}: it takes {', '.join(_NEEDED)}")
        if name in values:
            raise SceneFileError(f"{where}: {name!r} is given twice")
        values[name] = value
    missing = [name for name in _NEEDED if name not in values]
    if missing:
        raise SceneFileError(f"{where}: missing {', '.join(missing)}")
    degree, ratio = values["degree"], values["ratio"]
    if isinstance(degree, bool) or degree not in INDEPENDENT:
        raise SceneFileError(f"{where}: degree = {degree!r} must be 6 or 8 (the paper's families)")
    try:
        alpha = parse_angle(values["alpha"], f"{where}: alpha")
        phi = parse_angles(values["phi"], f"{where}: phi")
        make = examples.degree6 if degree == 6 else examples.degree8
        make(alpha, ratio)
    except SceneFileError:
        raise
    except OrigamiError as error:
        text = str(error)
        raise SceneFileError(text if text.startswith(where) else f"{where}: {text}") from None
    orbit = INDEPENDENT[degree]
    size = max(orbit) + 1
    if len(phi) not in (size, degree):
        raise SceneFileError(
            f"{where}: phi has {len(phi)} entries: give all {degree} fold angles or the first {size}"
        )
    for i, angle in enumerate(phi, start=1):
        if abs(angle) > math.pi + PRINTED:
            raise SceneFileError(f"{where}: phi[{i}] = {angle:.6g} is outside [-pi, pi] (radians)")
    for i, angle in enumerate(phi):
        if abs(angle - phi[orbit[i]]) > PRINTED:
            raise SceneFileError(
                f"{where}: phi[{i + 1}] = {angle:.6g} differs from phi[{orbit[i] + 1}] = "
                f"{phi[orbit[i]]:.6g}: the family keeps them equal"
            )
    branch = "" if values.get("branch") is None else str(values["branch"])[:40]
    kind = "" if values.get("kind") is None else str(values["kind"])[:40]
    return Candidate(number, degree, alpha, float(ratio), phi[:size], branch, kind)


def _whole(number: int, text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise SceneFileError(f"record {number}: degree = {text[:40]!r} must be 6 or 8")
    return int(text)


def _real(number: int, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise SceneFileError(
            f"record {number}: ratio = {text[:40]!r} must be a positive number"
        ) from None
