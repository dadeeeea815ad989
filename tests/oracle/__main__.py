"""What is known, held against what the package answers now: `python -m tests.oracle [--quick | --long] [GROUP ...]`.

Prints a row a group: questions, states found of those that must be, missing, false (a state that must be refused is
listed or called a minimum), not decided, differing, and processor time over that of the commit that made the data.
``--against FOLDER``: a checkout with an oracle of its own is asked the same in turn, so that times compare; without,
times are those recorded.  ``--sample N``: N questions spread over all; ``--families``: what each family of starts led
to, and what no other did; ``--out FILE``: what differs, in JSON.
The exit code is 1 where a state is false, more than 1 % of must-find is missing, an event or a number differs.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from tests.oracle.engine import SAME, Asked, missing, resolved, same, stated_by_name, unclosed

DATA = Path(__file__).parent / "data"
QUICK, WHOLE = 75.0, 10.0
"""Seconds of the recorded time of all quick questions; longest one that is not only asked for with ``--long``."""
EVENTS, MOMENTS, EIGENVALUES = 1e-9, 1e-7, 1e-9
"""Relative differences that numbers may have: places of events, moments of contacts, eigenvalues."""
SHARE = 0.99
LOWER = ("saddle", "not stationary")
FAULTS = (
    # creases 2 and 6 lie on each other: of two rows that close together it lists one, whose moment is unique then
    ("state of symmetric 12, D1, full", "moment"),
)
"""What the first commit answers wrong, or less fully: told, but the exit code is about what came after it."""


@dataclass
class Row:
    """What came out of a group of questions."""

    questions: int = 0
    found: int = 0
    missing: int = 0
    false: int = 0
    undecided: int = 0
    differing: int = 0
    seconds: float = 0.0
    before: float = 0.0
    slowest: tuple[float, str] = (0.0, "")
    told: list[Any] = field(default_factory=list)
    families: dict[str, list[int]] = field(default_factory=dict)

    def tell(self, name: str, what: str, *data: Any) -> None:
        """Keep what differs."""
        self.told.append({"name": name, "what": what, "data": data})


def near(a: Any, b: Any, share: float) -> bool:
    """Whether two numbers, or lists of them, are equal up to a relative difference; anything else to the letter."""
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(near(a[k], b[k], share) for k in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(near(x, y, share) for x, y in zip(a, b, strict=True))
    if isinstance(a, float) or isinstance(b, float):
        numbers = isinstance(a, float | int) and isinstance(b, float | int)
        return numbers and math.isclose(a, b, rel_tol=share, abs_tol=share)
    return bool(a == b)


def minima(row: Row, record: Any, answer: Any, refused: list[Any]) -> None:
    """States that a search owes: those that each of its seeds had at the first commit."""
    known, share = record["answer"].get("minima", []), record["answer"].get("share", [])
    listed = answer.get("minima", [])
    lost = missing(known, listed)
    seeds = record["answer"].get("seeds", 3)
    owed = [k for k in lost if share[k] == seeds]
    row.found += share.count(seeds) - len(owed)
    row.missing += len(owed)
    for k in owed:
        row.tell(record["name"], "missing", known[k])
    for state in listed:
        if any(same(state, one) for one in refused):
            row.false += 1
            row.tell(record["name"], "false", state)
    new = missing(listed, known)
    if new:
        row.tell(record["name"], "new", [listed[k] for k in new])
    # nobody has looked at these: that they close, by rotations alone, is the least
    for k in new:
        if unclosed(record["q"]["stated"], listed[k][1]) > SAME:
            row.false += 1
            row.tell(record["name"], "does not close", listed[k])
    row.undecided += max(0, len(answer.get("undecided", [])) - record["answer"].get("undecided", 0))


def proof(row: Row, record: Any, answer: Any, refused: list[Any]) -> None:
    """Lists that were proved: the same list; one that is no longer proved counts as not decided."""
    before = record["answer"]
    if before.get("status") != "proved":
        return
    row.undecided += answer.get("status") != "proved"
    known, listed = before["minima"], answer.get("minima", [])
    lost, more = missing(known, listed), missing(listed, known)
    row.found += len(known) - len(lost)
    row.missing += len(lost)
    row.false += len(more)
    if lost or more:
        row.tell(record["name"], "list", lost, [listed[k] for k in more])
    elif answer.get("status") != "proved":
        row.tell(record["name"], "no longer proved", answer.get("status"))


def judged(row: Row, record: Any, answer: Any, refused: list[Any]) -> None:
    """Verdicts; of minima the eigenvalues, and moments of contacts where both are unique."""
    before, now = record["answer"]["verdict"], answer.get("verdict", "error")
    if now == "undecided" and before != "undecided":
        row.undecided += 1
        row.tell(record["name"], "not decided", before)
    elif (before in LOWER and now in LOWER) or before == now or before == "undecided":
        row.found += 1
    else:
        row.false += now == "minimum"
        row.differing += now != "minimum"
        row.tell(record["name"], "verdict", before, now)
        return
    if before == now == "minimum":
        one, other = record["answer"]["eigenvalues"], answer["eigenvalues"]
        top = max((abs(x) for x in one), default=0.0) or 1.0
        if len(one) == len(other) and not near(
            [x / top for x in one], [x / top for x in other], EIGENVALUES
        ):
            row.differing += 1
            row.tell(record["name"], "eigenvalues", one, other)
        held, carried = _moments(record["answer"]), _moments(answer)
        alike = held.keys() == carried.keys()
        for who, moment in held.items():
            if not alike:  # of other rows the shortest vector of multipliers is another one
                moment, carried = moment[1:], {w: m[-2:] for w, m in carried.items()}
            if who in carried and not near(moment, carried[who], MOMENTS):
                row.differing += 1
                row.tell(record["name"], "moment", who, moment, carried[who])


def _moments(answer: Any) -> dict[str, list[float | None]]:
    """Moment of contacts, least and largest, by the creases or facets that touch; not of a name that comes twice."""
    found: dict[str, list[float | None]] = {}
    for kind, creases, facets, *moments in answer["contacts"]:
        found.setdefault(f"{kind} {sorted(creases)} {sorted(facets)}", []).extend(moments)
    return {who: moments for who, moments in found.items() if len(moments) == 3}


def passes(row: Row, record: Any, answer: Any, refused: list[Any]) -> None:
    """Energies over states: exact ones equal, bounds not above what they were by a tenth, none below an exact one."""
    known, told = record["answer"].get("passes", []), answer.get("passes", [])
    if len(known) != len(told):
        row.differing += 1
        row.tell(record["name"], "passes", len(known), len(told))
    for one, other in zip(known, told, strict=False):
        before, now = one[-2], other[-2]
        exact = [str(x[-1]).startswith(("exact", "flat", "saddle", "traced")) for x in (one, other)]
        if before is None or now is None or not math.isfinite(before) or not math.isfinite(now):
            fine = before is None or repr(before) == repr(now)
        elif all(exact):
            fine = near(before, now, EVENTS)
        else:
            fine = now <= 1.1 * before + 1e-12 and (not exact[0] or now >= before * (1 - EVENTS))
        row.found += fine
        row.differing += not fine
        if not fine:
            row.tell(record["name"], "pass", one, other)


def numbers(row: Row, record: Any, answer: Any, refused: list[Any]) -> None:
    """Events, designs, counts, verdicts on statements: equal."""
    for key, before in record["answer"].items():
        now = answer.get(key)
        if key == "events":
            lost = [e for e in before if not any(near(e, other, EVENTS) for other in now or [])]
            row.found += len(before) - len(lost)
            row.differing += len(lost)
            for event in lost:
                row.tell(record["name"], "event", event)
            continue
        if key == "error":  # which one it is, not what it says
            before, now = (str(text).split(":")[0] for text in (before, now))
        fine = near(before, now, 1e-4 if key == "margin" else EVENTS)
        row.found += fine
        row.differing += not fine
        if not fine:
            row.tell(record["name"], key, before, now)


JUDGES: dict[str, Callable[[Row, Any, Any, list[Any]], None]] = {
    "minima": minima,
    "proof": proof,
    "judged": judged,
    "escapes": passes,
    "barriers": passes,
}
"""What holds an answer against what is known, by the verb; `numbers` where there is none."""


def records() -> dict[str, list[Any]]:
    """All questions with what is known, by group; data of later commits beside those of the first."""
    every: dict[str, list[Any]] = {}
    for file in sorted(DATA.glob("*/*.json")):
        if file.stem == "stated":
            continue
        table = stated_by_name(file.parent)
        for record in json.loads(file.read_text()):
            # of states the scene is that of a search that must not list those that are refused
            record["of"] = record["q"].get("stated")
            record["q"] = resolved(record["q"], table)
            every.setdefault(record.get("group", file.stem), []).append(record)
    return every


def chosen(every: dict[str, list[Any]], asked: argparse.Namespace) -> list[tuple[str, Any]]:
    """The questions that are asked: those of the groups, short enough, or some of each."""
    pool = [(g, r) for g, rs in every.items() for r in rs if not asked.groups or g in asked.groups]
    if asked.long:
        return pool
    pool = [(g, r) for g, r in pool if r.get("seconds", 0.0) <= WHOLE]
    if asked.sample:
        step = max(1, len(pool) // asked.sample)
        return pool[::step][: asked.sample]
    if not asked.quick:
        return pool
    # of each group the same share of its time, its shorter questions spread evenly
    taken: list[tuple[str, Any]] = []
    for group in {g: None for g, _ in pool}:
        own = [(g, r) for g, r in pool if g == group and r.get("seconds", 0.0) < 1.0]
        total = sum(r.get("seconds", 0.0) for _, r in own)
        step = max(1, math.ceil(total / (QUICK / len(every))))
        taken += own[::step]
    return taken


def main(words: list[str]) -> int:
    """Do what the command line asks for (see the module)."""
    parser = argparse.ArgumentParser(prog="python -m tests.oracle", description=__doc__)
    for flag in ("--quick", "--long", "--families"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--sample", type=int, default=0)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("groups", nargs="*")
    asked = parser.parse_args(words)
    every = records()
    refused: dict[Any, list[Any]] = {}
    for r in every.get("refused", []):
        if "energy" in r["answer"]:
            refused.setdefault(r["of"], []).append([r["answer"]["energy"], r["q"]["angles"]])
    free: SimpleQueue[tuple[Asked, Asked | None]] = SimpleQueue()
    for _ in range(asked.workers):
        free.put((Asked(Path.cwd()), Asked(asked.against.resolve()) if asked.against else None))

    def answer(one: tuple[str, Any]) -> tuple[str, Any, Any, float]:
        group, record = one
        mine, theirs = free.get()
        try:
            before = theirs(record["q"])["seconds"] if theirs else record.get("seconds", 0.0)
            return group, record, mine(record["q"]), before
        finally:
            free.put((mine, theirs))

    rows: dict[str, Row] = {}
    with ThreadPoolExecutor(asked.workers) as pool:
        for group, record, now, before in pool.map(answer, chosen(every, asked)):
            row = rows.setdefault(group, Row())
            row.questions += 1
            row.seconds += now["seconds"]
            row.before += before
            for family, counts in now.get("families", {}).items():
                sums = row.families.setdefault(family, [0, 0, 0])
                row.families[family] = [a + b for a, b in zip(sums, counts, strict=True)]
            row.slowest = max(row.slowest, (now["seconds"] / max(before, 0.05), record["name"]))
            if "error" in now and "error" not in record["answer"]:
                row.differing += 1
                row.tell(record["name"], "error", now["error"])
            else:
                JUDGES.get(record["q"]["verb"], numbers)(
                    row, record, now, refused.get(record["name"], [])
                )
    columns = (
        "questions",
        "found",
        "missing",
        "false",
        "not decided",
        "differing",
        "time",
        "slowest",
    )
    print(f"{'':20}" + "".join(f"{c:>12}" for c in columns))
    total = Row()
    for group, row in rows.items():
        print(_line(group, row))
        for key in (
            "questions",
            "found",
            "missing",
            "false",
            "undecided",
            "differing",
            "seconds",
            "before",
        ):
            setattr(total, key, getattr(total, key) + getattr(row, key))
    print(_line("all", total))
    if asked.families:
        print(f"{'family':36}{'starts':>10}{'minima':>10}{'alone':>10}")
        for family in {f: None for row in rows.values() for f in row.families}:
            each = [row.families.get(family, [0, 0, 0]) for row in rows.values()]
            print(f"{family:36}" + "".join(f"{sum(c):10}" for c in zip(*each, strict=True)))
    if asked.out:
        lines = [json.dumps({"group": g, **t}) for g, row in rows.items() for t in row.told]
        asked.out.write_text("".join(line + "\n" for line in lines))
    faults = sum((t["name"], t["what"]) in FAULTS for row in rows.values() for t in row.told)
    wrong = total.false + total.differing > faults or total.missing > (1 - SHARE) * total.found
    return 1 if wrong else 0


def _line(name: str, row: Row) -> str:
    ratio, slowest = (
        row.seconds / max(row.before, 1e-9),
        f"{row.slowest[0]:.1f} {row.slowest[1][:24]}",
    )
    counts = (row.questions, row.found, row.missing, row.false, row.undecided, row.differing)
    return f"{name:20}" + "".join(f"{c:12}" for c in counts) + f"{ratio:12.2f}  {slowest}"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
