"""Published candidate states of the paper's two vertex families, read strictly from JSON.

``{"records": [...]}`` (and ``"meta"``) or a list of records.  A record gives ``degree`` (6 or 8), ``alpha`` or
``alpha1`` (the sector angle alpha_1), ``ratio`` or ``rk`` (r_k) and ``phi``: all N fold angles, or the independent
ones (phi_1..phi_4 for degree 6, phi_1..phi_3 for degree 8).  Radians, numbers or text such as ``"pi/4"``; other keys
are the notes of the file.  Files are data: nothing in them is evaluated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from origami_nlp.errors import OrigamiError, SceneFileError
from origami_nlp.io import read_json
from origami_nlp.pattern import Scene, examples, format_angle, parse_angle, parse_angles

INDEPENDENT = {6: (0, 1, 2, 3, 2, 1), 8: (0, 1, 2, 1, 0, 1, 2, 1)}
"""For each degree, which independent fold angle every crease has (D1 and D2 of the paper)."""
PRINTED = 1e-6
"""Accuracy of published fold angles [rad], of seven digits: closure, symmetry and equality are judged to it."""
LARGEST = 50_000_000
"""Bytes of a file of candidates."""
_ALIASES = {"alpha1": "alpha", "rk": "ratio"}
_NEEDED = ("degree", "alpha", "ratio", "phi")
_NOTES = "branch kind alpha1_label alpha1_as_listed handle list closure_at_label_alpha".split()


@dataclass(frozen=True)
class Candidate:
    """One published state.

    number: position in the file, 1-based.  alpha, ratio: alpha_1 [rad] and r_k.
    independent: phi_1..phi_4 (degree 6) or phi_1..phi_3 (degree 8) [rad].
    """

    number: int
    degree: int
    alpha: float
    ratio: float
    independent: tuple[float, ...]

    @property
    def fold_angles(self) -> tuple[float, ...]:
        """All N fold angles [rad]."""
        return tuple(self.independent[i] for i in INDEPENDENT[self.degree])

    @property
    def panel(self) -> tuple[int, float, float]:
        """Degree, alpha_1 to 12 decimals and r_k: candidates of one panel share it."""
        return self.degree, round(self.alpha, 12), self.ratio

    @property
    def scene(self) -> Scene:
        """The paper's scene of the candidate, with full contact."""
        make = examples.degree6 if self.degree == 6 else examples.degree8
        return make(format_angle(self.alpha), self.ratio)


def read_candidates(source: str | Path) -> tuple[Candidate, ...]:
    """Read candidates from a JSON file.

    Raises
    ------
    SceneFileError
        If the file cannot be read or a record is malformed; the message names the record.
    """
    data = read_json(source, LARGEST, "candidates", SceneFileError)
    if isinstance(data, dict) and set(data) <= {"meta", "records"}:
        data = data.get("records")
    if not isinstance(data, list) or not data:
        raise SceneFileError('candidates must be a list of records, or a table with "records"')
    return tuple(_candidate(i, record) for i, record in enumerate(data, start=1))


def _candidate(number: int, record: Any) -> Candidate:
    where = f"record {number}"
    if not isinstance(record, Mapping):
        raise SceneFileError(f"{where} = {str(record)[:40]!r} must be a table")
    values = {_ALIASES.get(key, key): value for key, value in record.items() if key not in _NOTES}
    if len(values) < len(set(record) - set(_NOTES)) or set(values) != set(_NEEDED):
        told = ", ".join(str(key)[:40] for key in record)
        raise SceneFileError(f"{where} has {told}: it takes each of {', '.join(_NEEDED)} once")
    degree, ratio = values["degree"], values["ratio"]
    if isinstance(degree, bool) or degree not in INDEPENDENT:
        raise SceneFileError(f"{where}: degree = {degree!r} must be 6 or 8 (the paper's families)")
    try:
        alpha = parse_angle(values["alpha"], "alpha")
        phi = parse_angles(values["phi"], "phi")
        (examples.degree6 if degree == 6 else examples.degree8)(alpha, ratio)
    except OrigamiError as error:
        raise SceneFileError(f"{where}: {error}") from None
    orbit = INDEPENDENT[degree]
    size = max(orbit) + 1
    if len(phi) not in (size, degree):
        raise SceneFileError(f"{where}: phi has {len(phi)} entries: give all {degree} or {size}")
    for i, angle in enumerate(phi):
        if abs(angle) > math.pi + PRINTED or abs(angle - phi[orbit[i]]) > PRINTED:
            why = f"must be in [-pi, pi], and that of crease {orbit[i] + 1}"
            raise SceneFileError(f"{where}: phi[{i + 1}] = {angle:.6g} {why}")
    return Candidate(number, degree, alpha, float(ratio), phi[:size])
