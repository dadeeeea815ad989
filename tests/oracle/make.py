"""Ask today's code further questions, and keep the answers: `python -m tests.oracle.make FOLDER GROUP=FILE ...`.

A line of JSON a question: its ``name``, ``verb``, and what `ask` takes; folders of data only grow.  The first questions
were stated by ``scenes.py``, which the history keeps.  Answers that are kept are numbers and enums.  States are held
against a program that shares nothing where there is one: all must close by rotations alone, and of vertices within fold
limits a search by SLSQP says what only it has.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tests.independent import search_slsqp
from tests.oracle.engine import (
    Asked,
    angle_of,
    joined,
    missing,
    resolved,
    stated_by_name,
    unclosed,
)

SEEDS = (0, 1, 2)
CLOSED = 1e-7
THOROUGH = 0.5
"""Seconds of a default search up to which a thorough one joins the union."""


def rounded(data: Any) -> Any:
    """Data with twelve digits, and no digit of what rounding leaves."""
    if isinstance(data, float):
        return 0.0 if abs(data) < 1e-14 else float(f"{data:.12g}")
    if isinstance(data, dict):
        return {key: rounded(value) for key, value in data.items()}
    return [rounded(value) for value in data] if isinstance(data, list) else data


def slsqp(stated: Any) -> list[list[float]]:
    """Fold angles of minima that an independent search finds, to some 1e-5 rad; of small vertices in fold limits."""
    scene = stated.get("scene", {})
    if set(scene) != {"vertex", "creases", "model"} or len(scene["creases"]["stiffness"]) > 6:
        return []
    model, springs = scene["model"], scene["creases"]
    if set(springs) != {"stiffness", "rest_angles"} or model.get("contact") != "fold-limits":
        return []
    if model.get("symmetry") != "none" or not scene["vertex"].get("flat", True):
        return []
    sectors = np.array([angle_of(a) for a in scene["vertex"]["sector_angles"]])
    k, rest = (
        np.array(springs["stiffness"]),
        np.array([angle_of(a) for a in springs["rest_angles"]]),
    )
    limits = math.pi * np.array([[-1.0], [1.0]]) * np.ones(len(k))
    rng = np.random.default_rng(0)
    found = search_slsqp.minima(
        lambda phi: float(k @ (phi - rest) ** 2 / 2), sectors, limits, np.arange(len(k)), 10, rng
    )
    return [list(map(float, phi)) for phi in found]


def searched(group: str, name: str, q: Any, ask: Asked) -> Any:
    """A question about minima: the union over seeds and efforts, how many of three seeds find each."""
    answers = [ask({**q, "seed": seed}) for seed in SEEDS]
    if "error" in answers[0]:
        return {"name": name, "group": group, "q": q, "answer": answers[0]}
    union = joined(*(a.get("minima", []) for a in answers))
    seconds = float(np.median([a["seconds"] for a in answers]))
    if seconds < THOROUGH:
        more = ask({**q, "seed": 3, "effort": "thorough"})
        union = joined(union, more.get("minima", []))
    lost = [set(missing(union, a.get("minima", []))) for a in answers]
    bad = [e for e, phi in union if unclosed(q["stated"], phi) > CLOSED]
    if bad:
        print("does not close:", name, bad)
    share = [sum(k not in one for one in lost) for k in range(len(union))]
    answer = {
        "minima": union,
        "share": share,
        "undecided": max(len(a.get("undecided", [])) for a in answers),
    }
    spent = {"seconds": seconds, "peak": answers[0]["peak"]}
    return {"name": name, "group": group, "q": q, "answer": answer, **spent}


def simple(group: str, name: str, q: Any, ask: Asked, table: dict[str, Any]) -> Any:
    """A question with one answer."""
    answer = ask(resolved(q, table))
    spent = {key: answer.pop(key) for key in ("seconds", "peak")}
    return {"name": name, "group": group, "q": q, "answer": answer, **spent}


def of_file(file: Path) -> Iterator[tuple[str, Any]]:
    """Further questions from a file, a line of JSON each: name and question."""
    for line in file.read_text().splitlines():
        q = json.loads(line)
        yield q.pop("name"), q


def write(folder: Path, group: str, records: list[Any]) -> None:
    """Write a group, a line a question."""
    # what is asked stays to the last bit: states that are singular are others where they are rounded
    plain = [{**record, "answer": rounded(record["answer"])} for record in records]
    lines = ",\n".join(json.dumps(record, separators=(",", ":")) for record in plain)
    (folder / f"{group}.json").write_text(f"[\n{lines}\n]\n")


def main(folder: Path, words: list[str]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for word in words:
        group, _, file = word.partition("=")
        records, table = [], stated_by_name(folder)
        with Asked(Path.cwd()) as ask:
            for name, q in of_file(Path(file)):
                if q["verb"] == "minima":
                    record = searched(group, name, q, ask)
                    listed = np.array([phi for _, phi in record["answer"].get("minima", [])])
                    found = slsqp(q["stated"])
                    # what only the other search has: a place to look
                    alone = [x for x in found if np.abs(listed - x).max(axis=1).min() > 1e-3]
                    record["slsqp"] = [len(found), len(alone)]
                    if alone:
                        print("only by SLSQP:", group, name, alone, flush=True)
                else:
                    record = simple(group, name, q, ask, table)
                records.append(record)
                print(f"{group}: {name}: {record.get('seconds', 0):.2f} s", flush=True)
        write(folder, group, records)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
