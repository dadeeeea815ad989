"""What the tables, the figure and the targets are made of: medians with quartiles over problems and rounds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.tally import FEWEST_STARTS

LEVEL = 1e-10
"""Error of fold angles [rad] at which methods are compared."""


@dataclass(frozen=True)
class Spread:
    """Median and quartiles of `count` numbers; infinite ones count, as the largest."""

    low: float
    median: float
    high: float
    count: int

    @classmethod
    def of(cls, values: Iterable[float]) -> Spread | None:
        """Return the spread of the numbers that are not NaN, or None without any."""
        v = np.sort([x for x in values if not math.isnan(x)])
        if not len(v):
            return None
        # the quartiles are numbers of the list: no means of a finite and an infinite one
        low, mid, high = (float(v[round(q * (len(v) - 1))]) for q in (0.25, 0.5, 0.75))
        return cls(low, mid, high, len(v))


@dataclass(frozen=True)
class Contact:
    """One method over a family of problems.

    starts: how many.  seconds: a start.  angle, energy, multiplier, eigenvalue: median errors.
    ratio: seconds per minimum correct to `LEVEL`, over ours, on the same starts.
    minima, missed: of all problems, by searches that stop by the package's rule; None for settings that ran on
    fewer starts.  exact: how many of the minima were reached to `LEVEL`.
    false_states, failed: distinct states that were claimed and are no minima; starts without a claim.
    """

    label: str
    family: str
    accuracy: float
    starts: int
    seconds: Spread | None
    errors: dict[str, Spread | None]
    ratio: Spread | None
    minima: int
    missed: int | None
    exact: int
    false_states: int
    failed: int


def rows(part: dict[str, Any], family: str | None = None) -> list[Contact]:
    """Return one row for each method of a part of the data that ran, over the problems of a family (or all)."""
    problems = {p["name"]: p for p in part["problems"] if family in (None, p["family"])}
    out = []
    for method in part["methods"]:
        cells = [
            c for c in part["cells"] if c["method"] == method["label"] and c["problem"] in problems
        ]
        if cells:
            out.append(_row(method, cells, problems))
    return out


def _row(method: dict[str, Any], cells: list[dict[str, Any]], problems: dict[str, Any]) -> Contact:
    minima = sum(len(problems[c["problem"]]["minima"]) for c in cells)
    found = [c["until_the_rule"]["found"] for c in cells]
    return Contact(
        method["label"],
        method["family"],
        method["accuracy"],
        sum(c["starts"] for c in cells),
        Spread.of(s for c in cells for s in c["seconds_per_start"] if s is not None),
        {
            name: Spread.of(e[name][1] for c in cells if (e := c["errors"]).get(name) is not None)
            for name in ("angle", "energy", "multiplier", "eigenvalue")
        },
        Spread.of(r for c in cells for r in numbers(c["ratios"][f"{LEVEL:.0e}"])),
        minima,
        None if method["sweep"] else minima - sum(len(f) for f in found),
        sum(e is not None and e <= LEVEL for f in found for e in f.values()),
        sum(c["false_states"] for c in cells),
        sum(c["failed"] for c in cells),
    )


def numbers(values: Sequence[Any]) -> list[float]:
    """Read ratios back from JSON: "inf" is infinite, null is NaN."""
    return [math.inf if v == "inf" else math.nan if v is None else float(v) for v in values]


def whole_job_ratios(data: dict[str, Any], label: str, level: float = LEVEL) -> Spread | None:
    """Return seconds per correct minimum of a whole search by `label`, over the whole main job's.

    Both stop by the same rule; a search that reaches no minimum to `level` counts as infinite.
    """
    jobs = {j["problem"]: j for j in data["job"]}
    out = []
    for cell in data["cells"]:
        if cell["method"] != label or cell["until_the_rule"]["starts"] < FEWEST_STARTS:
            continue  # (a short run: the rule asks for more starts than were made)
        job, search = jobs[cell["problem"]], cell["until_the_rule"]
        mine = len(job["found"])
        theirs = sum(e <= level for e in search["found"].values())
        for seconds in job["seconds"]:
            if mine:
                ours = seconds / mine
                out.append(search["seconds"] / theirs / ours if theirs else math.inf)
    return Spread.of(out)


def job_summary(data: dict[str, Any], family: str | None = None) -> dict[str, Any]:
    """Return seconds, minima found and missed by the whole main job."""
    names = [p["name"] for p in data["problems"] if family in (None, p["family"])]
    jobs = [j for j in data["job"] if j["problem"] in names]
    return {
        "seconds": Spread.of(s for j in jobs for s in j["seconds"]),
        "found": sum(len(j["found"]) for j in jobs),
        "missed": {j["problem"]: j["missed"] for j in jobs if j["missed"]},
    }


def hessian_ratios(data: dict[str, Any]) -> tuple[Spread | None, Spread | None]:
    """Return time and eigenvalue error of appendix A over the exact Hessian's, state by state.

    The error of appendix A is that of its best step; the exact one is taken as rounding (1e-16) at least.
    """
    time, error = [], []
    for h in data["hessian"]:
        pairs = zip(h["seconds"]["appendix A"], h["seconds"]["exact"], strict=True)
        time += [a / b for a, b in pairs]
        steps = [e for e in h["error_appendix"].values() if e is not None]
        if steps:
            error.append(min(steps) / max(h["error_exact"], 1e-16))
    return Spread.of(time), Spread.of(error)


@dataclass(frozen=True)
class Target:
    """One aim of the package: what, the measured numbers, whether it is reached, and why not."""

    text: str
    wanted: float
    measured: Spread | None
    why: str = ""

    @property
    def reached(self) -> bool | None:
        """Whether the median reaches it; None where it was not measured."""
        return None if self.measured is None else self.measured.median >= self.wanted


def targets(data: dict[str, Any]) -> list[Target]:
    """Return the aims, with what this run measured."""
    out = []
    for name in ("SLSQP", "trust-constr"):
        labels = [m["label"] for m in data["methods"] if m["name"] == name and not m["sweep"]]
        spreads = {label: whole_job_ratios(data, label) for label in labels}
        single = {r.label: r.ratio for r in rows(data)}
        for kind, table in (("whole main job", spreads), ("multi-start alone", single)):
            # the rival's best setting
            best = min(
                (s for label in labels if (s := table.get(label)) is not None),
                key=lambda s: s.median,
                default=None,
            )
            text = f"{name} over {kind}: seconds per minimum correct to {LEVEL:.0e}, ratio"
            out.append(Target(text, 10.0, best, _why(data, name)))
    time, error = hessian_ratios(data)
    out.append(Target("appendix A over the exact Hessian: seconds a state, ratio", 50.0, time))
    out.append(
        Target("appendix A over the exact Hessian: error of the eigenvalues, ratio", 1e5, error)
    )
    return out


def _why(data: dict[str, Any], name: str) -> str:
    """Return where a rival's time goes, in numbers."""
    labelled = {r.label: r for r in rows(data)}
    ours = rows(data)[0]
    best = [r for r in labelled.values() if r.family == name and r.missed is not None and r.seconds]
    if not best or ours.seconds is None:
        return ""
    row = min(best, key=lambda r: r.seconds.median if r.seconds else math.inf)
    assert row.seconds is not None
    return (
        f"{name} gets the package's own problem, projected starts and compiled derivatives, and takes "
        f"{1e3 * row.seconds.median:.2g} ms a start where the package takes {1e3 * ours.seconds.median:.2g} ms; "
        f"it does not pay for polish, classification and proofs, and claims {row.false_states} states that are no "
        f"minima"
    )
