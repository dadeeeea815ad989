"""An archive of states, counts, certificates and curves behind the published results: JSON, CSV, dictionary, checksums.

Everything is found anew but for counts of large sheets, which are those of the recorded run `docs/counts.json`.
Numbers are rounded to what every machine gives alike: angles to 1e-6 degrees, energies to nine digits.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.actuation import actuate
from origami_nlp.io import write_whole
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern import Pattern, Scene, examples, format_scene, parse_scene
from origami_nlp.problem import Model
from origami_nlp.proof import Certificate, ProofOptions, certificate_of, prove, write_certificate
from origami_nlp.validity import layer_orders
from origami_nlp.verbs import find_minima
from origami_nlp.version import __version__
from studies.counts import sheet
from studies.most_states import branch

COUNTS = Path(__file__).resolve().parents[1] / "docs" / "counts.json"
"""The recorded run of `python -m studies counts`."""
BOXES = COUNTS.with_name("at_most_four.json")
"""Boxes of vertices with four stable states at most, each proved (tests/independent/one_maximum)."""
VERTICES: dict[str, tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...], str]] = {
    "six": ((62, 100, 119, 79), (0.02, 0.0186, 0.0129, 0.0135), (-180, -141, 180, 180), "full"),
    "six-limits": (
        (62, 100, 119, 79),
        (0.02, 0.0186, 0.0129, 0.0135),
        (-180, -141, 180, 180),
        "fold-limits",
    ),
    "flat-foldable": ((88, 82, 92, 98), (0.02,) * 4, (110, 110, -170, -170), "full"),
    "miura": ((84, 96, 96, 84), (0.02,) * 4, (170, 60, -140, 40), "full"),
    "cross": ((90, 90, 90, 90), (0.02, 0.01, 0.02, 0.01), (100, -70, -40, -50), "full"),
}
"""Sectors [deg], stiffness [N m/rad], rest angles [deg] and contact of vertices with as many states as are known."""
SHEETS = (("metasheet", 2), ("metasheet", 3), ("miura", 2), ("miura", 3))
TWISTS = (20, 40, 44.9, 45.1, 50, 70)
"""Angles of pleats [deg] at which it is asked which branches can be folded flat."""
PLACES = np.sin(np.linspace(-0.5, 0.5, 41)[1:-1] * np.pi)
"""Of curves, in the parameter t of the closed form."""
DICTIONARY = (
    ("states.csv", "scene", "", "name of the scene: scenes/NAME.toml or NAME.json"),
    ("states.csv", "state", "", "number by energy, from 1"),
    ("states.csv", "energy", "J", "of the springs"),
    ("states.csv", "kind", "", "interior, contact-pinned, contact-touching or degenerate"),
    ("states.csv", "fold_angles", "deg", "in the order of creases, valley positive"),
    ("states.csv", "certificate", "", "why it is a strict minimum"),
    ("lists.csv", "scene", "", "name of the scene"),
    ("lists.csv", "states", "", "stable states that were found"),
    ("lists.csv", "complete", "", "proved: no other exists; searched: there may be more"),
    ("counts.csv", "family", "", "metasheet, miura or twists"),
    ("counts.csv", "size", "", "n of n x n"),
    ("counts.csv", "creases", "", "of the sheet"),
    ("counts.csv", "vertices", "", "interior ones"),
    ("counts.csv", "contact", "", "full: facets must not cross; fold-limits: they may"),
    ("counts.csv", "states", "", "stable states that were found"),
    ("counts.csv", "certified", "", "of these, with a certificate"),
    ("counts.csv", "undecided", "", "states found that were not decided"),
    (
        "counts.csv",
        "complete",
        "",
        "as in lists.csv; proved by curves: a mesh that folds flat, and checked",
    ),
    (
        "counts.csv",
        "enumerated",
        "",
        "whether all flat-folded states, from where curves leave, were gone through",
    ),
    ("counts.csv", "left_out", "", "what the time did not suffice for"),
    ("branches.csv", "sheet", "", "which sheet"),
    ("branches.csv", "branches", "", "of the flat state, that closed states follow"),
    ("branches.csv", "unique", "", "whether torques exist that start one of them alone"),
    ("branches.csv", "fewest", "", "creases on which such torques are, at least; empty: none"),
    ("twists.csv", "alpha", "deg", "angle of pleats of the square twist"),
    ("twists.csv", "branches", "", "of the flat state"),
    ("twists.csv", "foldable", "", "of these, whose flat-folded end has an order of layers"),
    ("curves.csv", "scene", "", "name of the vertex"),
    ("curves.csv", "branch", "", "1 or 2: the branch of closed states"),
    ("curves.csv", "t", "", "parameter of the closed form: 0 flat, -1 and 1 at the fold limit"),
    ("curves.csv", "fold_angles", "deg", "of the closed state"),
    ("curves.csv", "energy", "J", "of the springs"),
    ("waterbombs.csv", "creases", "", "2n equal sectors, mountains and valleys in turn"),
    ("waterbombs.csv", "curve", "", "1 or 2: the two curves through the flat state"),
    ("waterbombs.csv", "mountain", "deg", "fold of all mountains"),
    ("waterbombs.csv", "valley", "deg", "fold of all valleys"),
    ("at_most_four.csv", "width", "deg", "of a box of sectors"),
    ("at_most_four.csv", "first", "deg", "sector between the leading creases, at least"),
    ("at_most_four.csv", "second", "deg", "the next sector, at least"),
    (
        "at_most_four.csv",
        "fourth",
        "deg",
        "the last sector, at least; the third is what is left of 360",
    ),
)
"""File, column, unit and meaning of each column of each table."""
Report = Callable[[str], object]


def write_archive(folder: Path, report: Report = lambda _: None) -> list[Path]:
    """Write the archive.

    Parameters
    ----------
    folder
        There must be one.
    report
        Called with the name of each file.

    Returns
    -------
    list of Path
        What was written, checksums last.
    """
    written: list[Path] = []

    def write(name: str, content: str) -> None:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        write_whole(path, content.encode())
        written.append(path)
        report(name)

    states: list[list[object]] = []
    lists: list[list[object]] = []
    for name, stated in scenes():
        result = find_minima(stated, prove=True, escape=False)
        if isinstance(stated, Scene):
            write(f"scenes/{name}.toml", format_scene(stated))
        else:
            write(f"scenes/{name}.json", _json(_plain(stated)))
        states += _states(name, result)
        found = result.completeness
        complete = "proved" if found is not None and found.status == "proved" else "searched"
        lists.append([name, len(result.minima), complete])
        if isinstance(stated, Scene) and stated.contact == "fold-limits" and complete == "proved":
            assert found is not None
            proof = folder / "certificates" / f"{name}.json"
            proof.parent.mkdir(exist_ok=True)
            write_certificate(_certificate(stated, found.boxes), proof)
            written.append(proof)
            report(f"certificates/{name}.json")
    tables = {
        "states": states,
        "lists": lists,
        "counts": [list(row.values()) for row in json.loads(COUNTS.read_text())["counts"]],
        "branches": list(_branches()),
        "twists": list(_twists()),
        "curves": list(_curves()),
        "waterbombs": list(_waterbombs()),
        "at_most_four": list(_boxes()),
    }
    for name, rows in tables.items():
        write(f"{name}.csv", _csv([c for f, c, *_ in DICTIONARY if f == f"{name}.csv"], rows))
    write(
        "dictionary.csv", _csv(["file", "column", "unit", "meaning"], [list(d) for d in DICTIONARY])
    )
    about = {
        "title": "Stable states of rigid origami: published results obtained again",
        "version": __version__,
        "made_by": "python -m studies archive DIR",
        "files": sorted(str(p.relative_to(folder)) for p in written),
    }
    write("archive.json", _json(about))
    sums = sorted(
        f"{hashlib.sha256(p.read_bytes()).hexdigest()}  {p.relative_to(folder).as_posix()}\n"
        for p in written
    )
    write("SHA256SUMS", "".join(sums))
    return written


def scenes() -> Iterator[tuple[str, Scene | Pattern]]:
    """Yield names and what is folded: vertices, then sheets."""
    for name, (sectors, stiffness, rest, contact) in VERTICES.items():
        lines = [
            "[vertex]",
            f"sector_angles_deg = {list(sectors)}",
            "[creases]",
            f"stiffness = {list(stiffness)}",
            f"rest_angles_deg = {list(rest)}",
            "[model]",
            'symmetry = "none"',
            f'contact = "{contact}"',
        ]
        yield name, parse_scene("\n".join(lines))
    for family, size in SHEETS:
        yield f"{family}-{size}x{size}", sheet(family, size)


def _plain(pattern: Pattern) -> dict[str, Any]:
    return {
        "corners": np.round(pattern.corners, 12).tolist(),
        "facets": [list(p) for p in pattern.polygons],
        "creases": pattern.ends.tolist(),
        "stiffness": pattern.stiffness.tolist(),
        "rest_angles_deg": np.round(np.degrees(pattern.rest), 9).tolist(),
    }


def _states(name: str, result: MinimaResult) -> Iterator[list[object]]:
    for k, state in enumerate(result.minima, start=1):
        yield [name, k, _digits(state.energy), state.kind, _degrees(state.phi), state.certificate]


def _certificate(scene: Scene, boxes: int) -> Certificate:
    """The proof that the list is complete, as `origami-nlp check-proof` takes it."""
    proofs = [
        prove(Model(one), record=True, options=ProofOptions(boxes=boxes))
        for one in scene.of_each_winding
    ]
    return certificate_of(scene, *proofs)


def _branches() -> Iterator[list[object]]:
    for family, size in SHEETS:
        seen = actuate(sheet(family, size))
        few = min((len(d.creases) for d in seen.driven), default="")
        yield [f"{family}:{size}x{size}", len(seen.branches), seen.can_be_unique, few]


def _twists() -> Iterator[list[object]]:
    for alpha in TWISTS:
        twist = examples.pattern("squaretwist", alpha=np.radians(alpha))
        signs = [np.sign(b.velocities[:, 0]) for b in actuate(twist).branches]
        yield [alpha, len(signs), sum(layer_orders(twist, np.pi * s).count > 0 for s in signs)]


def _curves() -> Iterator[list[object]]:
    """Closed states and energies of the generic vertex with six states, by the closed form."""
    sectors, stiffness, rest, _ = VERTICES["six"]
    for mode in (1, 2):
        found = branch(np.radians(sectors), mode, PLACES)
        assert found is not None
        for t, phi in zip(PLACES.tolist(), found[0].T, strict=True):
            energy = float(np.array(stiffness) @ (phi - np.radians(rest)) ** 2) / 2
            yield ["six", mode, f"{t:.9f}", _degrees(phi), _digits(energy)]


def _waterbombs() -> Iterator[list[object]]:
    """Closed states of waterbomb bases with all symmetries, by tan(v/4) = -(1 +- sin a)/cos a tan(m/4)."""
    for n, curve in product((3, 4, 6), (1, 2)):
        ratio = (1 + (-1) ** (curve + 1) * np.sin(np.pi / n)) / np.cos(np.pi / n)
        most = min(1.0, 1 / ratio)
        for share in np.linspace(-1, 1, 21):
            mountain = 4 * np.arctan(most * share)
            yield [
                2 * n,
                curve,
                *_degrees([mountain, -4 * np.arctan(ratio * most * share)]).split(),
            ]


def _boxes() -> Iterator[list[object]]:
    stated = json.loads(BOXES.read_text())
    width = Fraction(stated["width"])
    for box in stated["boxes"]:
        yield [float(width), *(float(k * width) for k in box)]


def _degrees(phi: np.ndarray | list[float]) -> str:
    return " ".join(f"{round(d, 6) + 0.0:.6f}" for d in np.degrees(phi))


def _digits(energy: float) -> str:
    return f"{energy:.9g}"


def _csv(head: list[str], rows: list[list[object]]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([head, *rows])
    return out.getvalue()


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, sort_keys=True) + "\n"
