"""Ask today's code all questions of the oracle, and keep the answers: `python -m tests.oracle.make FOLDER [GROUP ...]`.

Answers that are kept are numbers and enums.  States are held against a program that shares nothing where there is one:
all must close by rotations alone; searches by SLSQP join the union of vertices within fold limits.
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
from tests.oracle import scenes
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
    if model.get("symmetry") != "none":
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


def searched(group: str, name: str, q: Any, ask: Asked, long: bool = False) -> Any:
    """A question about minima: the union over seeds and efforts, how many of three seeds find each."""
    asked = {"verb": "minima", **q}
    seeds = (SEEDS[:1] if name.startswith("resch") else SEEDS[:2]) if long else SEEDS
    answers = [ask({**asked, "seed": seed}) for seed in seeds]
    if "error" in answers[0]:
        return {"name": name, "group": group, "q": asked, "answer": answers[0]}
    union = joined(*(a.get("minima", []) for a in answers))
    seconds = float(np.median([a["seconds"] for a in answers]))
    if seconds < THOROUGH and not long:
        more = ask({**asked, "seed": 3, "effort": "thorough"})
        union = joined(union, more.get("minima", []))
    lost = [set(missing(union, a.get("minima", []))) for a in answers]
    bad = [e for e, phi in union if unclosed(q["stated"], phi) > CLOSED]
    if bad:
        print("does not close:", name, bad)
    share = [sum(k not in one for one in lost) for k in range(len(union))]
    answer = {
        "minima": union,
        "share": share,
        "seeds": len(seeds),
        "undecided": max(len(a.get("undecided", [])) for a in answers),
    }
    return {
        "name": name,
        "group": group,
        "q": asked,
        "answer": answer,
        "seconds": seconds,
        "peak": answers[0]["peak"],
    }


def simple(group: str, name: str, q: Any, ask: Asked, table: dict[str, Any]) -> Any:
    """A question with one answer."""
    answer = ask(resolved(q, table))
    seconds, peak = answer.pop("seconds"), answer.pop("peak")
    return {
        "name": name,
        "group": group,
        "q": q,
        "answer": answer,
        "seconds": seconds,
        "peak": peak,
    }


def groups() -> dict[str, Any]:
    """Questions by group: a name and what is stated."""
    of_minima = {
        f.__name__: ("minima", f)
        for f in (
            *(
                scenes.panels,
                scenes.random_vertices,
                scenes.cones_of_paper,
                scenes.symmetric_vertices,
            ),
            *(scenes.almost_special, scenes.stiffness_ratios, scenes.sheets, scenes.large_sheets),
        )
    }
    others = (scenes.escaped, scenes.located, scenes.designed, scenes.counted)
    return {
        **of_minima,
        "proved": ("proof", scenes.proved),
        **{f.__name__: ("", f) for f in others},
    }


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
    known = groups()
    folder.mkdir(parents=True, exist_ok=True)
    for word in words or known:
        group, _, file = word.partition("=")
        verb, stated = known.get(group, ("", lambda file=file: of_file(Path(file))))
        records, table = (
            [],
            {n: q["stated"] for _, f in groups().values() for n, q in f() if "stated" in q},
        )
        table |= stated_by_name(folder)
        with Asked(Path.cwd()) as ask:
            for name, q in stated():
                verb_of = verb or q.pop("verb")
                if verb_of == "minima":
                    record = searched(group, name, q, ask, group == "large_sheets")
                    listed = np.array([phi for _, phi in record["answer"].get("minima", [])])
                    found = slsqp(q["stated"])
                    # what only the other search has: a place to look
                    alone = [x for x in found if np.abs(listed - x).max(axis=1).min() > 1e-3]
                    record["slsqp"] = [len(found), len(alone)]
                    if alone:
                        print("only by SLSQP:", group, name, alone, flush=True)
                else:
                    record = simple(group, name, {"verb": verb_of, **q}, ask, table)
                records.append(record)
                print(f"{group}: {name}: {record.get('seconds', 0):.2f} s", flush=True)
                if len(records) % 10 == 0:
                    write(folder, group, records)
        write(folder, group, records)
        print(group, len(records), "questions", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
