"""The benchmark's tables, in Markdown and for the terminal."""

from __future__ import annotations

import math
from typing import Any

from benchmarks.digest import (
    LEVEL,
    Contact,
    Spread,
    hessian_ratios,
    job_summary,
    rows,
    targets,
)
from benchmarks.methods_ours import OURS
from origami_nlp.display import rows_markdown

HEADS = (
    "method",
    "ms a start",
    "error of fold angles",
    "energy",
    "multipliers",
    "eigenvalues",
    f"s per minimum to {LEVEL:.0e}, over ours",
    "missed",
    "false",
    "starts without a claim",
)


def show(spread: Spread | None, factor: float = 1.0, digits: int = 2) -> str:
    """Write median and quartiles, such as ``12 [9.1, 20]``."""
    if spread is None:
        return "-"
    low, mid, high = (_number(v * factor, digits) for v in (spread.low, spread.median, spread.high))
    return f"{mid} [{low}, {high}]"


def _number(value: float, digits: int) -> str:
    if math.isinf(value):
        return "none"
    return f"{value:.0f}" if 100 <= value < 1e5 else f"{value:.{digits}g}"


def table(found: list[Contact]) -> list[tuple[str, ...]]:
    """Return the cells of a table of methods, one row each."""
    return [
        (
            r.label,
            show(r.seconds, 1e3),
            *(
                "-" if (e := r.errors[name]) is None else f"{e.median:.0e}"
                for name in ("angle", "energy", "multiplier", "eigenvalue")
            ),
            show(r.ratio),
            "-" if r.missed is None else f"{r.missed} of {r.minima}",
            str(r.false_states),
            f"{r.failed} of {r.starts}",
        )
        for r in found
    ]


def headline(data: dict[str, Any]) -> str:
    """Return the five-line table of the README."""
    by_label = {r.label: r for r in rows(data)}
    job = job_summary(data)
    lines: list[tuple[str, ...]] = []
    best = _best(list(by_label.values()), "SLSQP"), _best(list(by_label.values()), "trust-constr")
    shown = [by_label[OURS], *(r for r in best if r), *_named(by_label, "IPOPT alone, tol 1e-08")]
    for r in shown:
        lines.append(
            (
                r.label,
                show(r.seconds, 1e3),
                "-" if (e := r.errors["angle"]) is None else f"{e.median:.0e}",
                show(r.ratio),
                "-" if r.missed is None else f"{r.missed} of {r.minima}",
                str(r.false_states),
            )
        )
    missed = sum(job["missed"].values())
    total = by_label[OURS].minima
    seconds = job["seconds"]
    lines.append(
        ("whole main job, per scene", show(seconds, 1e3), "-", "-", f"{missed} of {total}", "0")
    )
    heads = (
        "method",
        "ms a start",
        "error",
        "s per minimum to 1e-10, over ours",
        "missed",
        "false",
    )
    return rows_markdown(heads, lines)


def _best(found: list[Contact], family: str) -> Contact | None:
    """Return the setting of a family with the smallest seconds per minimum at `LEVEL`."""
    own = [r for r in found if r.family == family and r.missed is not None and r.ratio]
    return min(own, key=lambda r: r.ratio.median if r.ratio else math.inf, default=None)


def _named(by_label: dict[str, Contact], label: str) -> list[Contact]:
    return [by_label[label]] if label in by_label else []


def markdown(data: dict[str, Any], figure: str | None = None) -> str:
    """Return the whole report."""
    s, m = data["settings"], data["machine"]
    problems = data["problems"]
    out = ["# Speed against error\n"]
    out.append(
        f"One run of `python -m benchmarks speed{' --quick' if s['quick'] else ''}`: {len(problems)} problems, "
        f"{s['rounds']} rounds of {s['starts']} starts each ({s['sweep']} for settings that only the diagram needs), "
        f"seed {s['seed']}, all methods interleaved start by start in rotating order, single process, one warm-up "
        "start untimed. Numbers are medians with [quartiles] over problems and rounds, errors medians over problems. "
        "Every method gets the same problem (the package's own, with its separating planes added by the package's "
        "rule) and the same starts, projected onto closure (raw: uniform random fold "
        "angles); seconds are processor time; drawing and projecting is in every method's time, building "
        f"functions is not. A method stops after {s['budget']:g} s on one problem and round. Machine: {m['system']} "
        f"{m['processor']}, {m['processors']} processors, Python {m['python']}, "
        + ", ".join(f"{k} {v}" for k, v in m["versions"].items())
        + ".\n"
    )
    if figure:
        out.append(f"![Work-precision diagrams]({figure})\n")
    out.append(in_short(data))
    for family, title in (("panel", "The paper's panels"), ("random", "Random vertices")):
        found = rows(data, family)
        if found:
            out.append(f"## {title}\n")
            out.append(_of_family(data, family))
            out.append(rows_markdown(HEADS, table(found)))
    out.append(_references(data))
    for key, title in (
        ("closure", "Loop closure posed in other ways (no symmetry, fold limits only)"),
        ("wedge", "The symmetric piece against tied angles (fold limits only)"),
    ):
        out.append(f"## {title}\n")
        out.append(rows_markdown(HEADS, table(rows(data[key]))))
        if "evaluation" in data[key]:
            times = ", ".join(
                f"{name} {1e6 * v:.2g} us" for name, v in data[key]["evaluation"].items()
            )
            out.append(f"Closure and its Jacobian, one evaluation: {times}.\n")
    out.append(grid_section(data))
    out.append(appendix_section(data))
    out.append(_scaling(data))
    out.append(_missing(data))
    return "\n".join(out)


def in_short(data: dict[str, Any]) -> str:
    """Return the headline table and the targets."""
    return "\n".join(["## In short\n", headline(data), _targets(data)])


def _targets(data: dict[str, Any]) -> str:
    lines, said = ["## Targets\n"], ""
    for t in targets(data):
        if t.measured is None:
            lines.append(f"- not measured: {t.text} (wanted {t.wanted:g})")
            continue
        verdict = "reached" if t.reached else "NOT reached"
        why = f"; {'as above' if t.why == said else t.why}" if t.why and not t.reached else ""
        said = t.why or said
        lines.append(f"- {verdict}: {t.text} {show(t.measured)}, wanted at least {t.wanted:g}{why}")
    missed = job_summary(data)["missed"]
    words = "; ".join(f"{name}: {count}" for name, count in missed.items())
    lines.append(
        f"- {'NOT reached' if missed else 'reached'}: the whole main job misses nothing"
        + (f" (missed {words})" if missed else "")
    )
    return "\n".join(lines) + "\n"


def _of_family(data: dict[str, Any], family: str) -> str:
    job = job_summary(data, family)
    return (
        f"The whole main job (listing, boundaries, starts until the rule stops it, classification): "
        f"{show(job['seconds'])} s a scene; it found {job['found']} minima and missed "
        f"{sum(job['missed'].values())}. `missed` below is for searches that stop by the same rule; sets that no "
        "descent reaches (flat foldings, 1-handles) are listed by the job, not found by any multi-start.\n"
    )


def _references(data: dict[str, Any]) -> str:
    minima = [m for p in data["problems"] for m in p["minima"]]
    solved = [m for m in minima if m["digits"]]
    worst = max((m["residual"] for m in solved), default=0.0)
    why = sorted({m["no_reference"] for m in minima if not m["digits"]})
    text = f"{len(solved)} of {len(minima)} minima have a 50-digit reference (largest residual {worst:.0e})"
    return text + (f"; the others: {'; '.join(why)}" if why else "") + ".\n"


def grid_section(data: dict[str, Any]) -> str:
    """Return what the grid method finds."""
    if not data["grid"]:
        return ""
    heads = (
        "grid",
        "s a scene",
        "reported",
        "minima found",
        "missed",
        "false",
        "duplicates",
        "error",
    )
    lines = []
    for size in sorted({g["size"] for g in data["grid"]}):
        of = [g for g in data["grid"] if g["size"] == size]
        found = sum(len(g["found"]) for g in of)
        lines.append(
            (
                f"{size} x {size}",
                show(Spread.of(t for g in of for t in g["seconds"])),
                str(sum(g["reported"] for g in of)),
                str(found),
                str(sum(g["missed"] for g in of)),
                str(sum(g["false"] for g in of)),
                str(sum(g["duplicates"] for g in of)),
                show(Spread.of(e for g in of for e in g["found"].values()), digits=1),
            )
        )
    return "## The grid method\n\n" + rows_markdown(heads, lines)


def appendix_section(data: dict[str, Any]) -> str:
    """Return what the paper's test of a state costs and misses."""
    heads = ("test", "ms a state", "relative error of the eigenvalues")
    h = data["hessian"]
    exact = Spread.of(x["error_exact"] for x in h)
    lines = [
        (
            "exact Hessian",
            show(Spread.of(s for x in h for s in x["seconds"]["exact"]), 1e3),
            show(exact, 1, 1),
        )
    ]
    steps = list(h[0]["error_appendix"]) if h else []
    cost = show(Spread.of(s for x in h for s in x["seconds"]["appendix A"]), 1e3)
    for step in steps:
        error = Spread.of(e for x in h if (e := x["error_appendix"][step]) is not None)
        lines.append((f"appendix A, h = {step}", f"{cost} (all steps)", show(error, 1, 1)))
    time, error = hessian_ratios(data)
    return (
        f"## The paper's appendix-A test, {len(h)} interior states\n\n"
        + rows_markdown(heads, lines)
        + f"\nRatio of times {show(time)}, of errors (its best step) {show(error)}.\n"
    )


def _scaling(data: dict[str, Any]) -> str:
    heads = (
        "N",
        "contact",
        "facet pairs",
        "compile [s]",
        "first solve [s]",
        "solve + polish [ms]",
        "MB",
    )
    lines = []
    for d in data["scaling"]["degrees"]:
        if "stopped" in d:
            lines.append((str(d["degree"]), d["contact"], "-", d["stopped"], "-", "-", "-"))
            continue
        lines.append(
            (
                str(d["degree"]),
                d["contact"],
                str(d["pairs"]),
                f"{d['compile_seconds']:.2f}",
                f"{d['first_seconds']:.2f}",
                show(Spread.of(d["solve_seconds"]), 1e3),
                f"{d['megabytes']:.0f}",
            )
        )
    scenes = [
        (str(d["scenes"]), f"{d['seconds']:.2f}", f"{d['megabytes']:.0f}")
        for d in data["scaling"]["scenes"]
        if "seconds" in d
    ]
    return (
        "## Scaling\n\nOne random vertex of degree N without symmetry, in a process of its own; with contact, facet "
        "pairs get planes when a solve makes them cross. A size that takes longer than "
        f"{data['scaling']['limit']:g} s is stopped, and larger ones are not tried: the gaps of all facet pairs are "
        "compiled with their derivatives, and their number grows with N^2.\n\n"
        + rows_markdown(heads, lines)
        + "\nScenes of one structure (8 starts each) share compiled functions:\n\n"
        + rows_markdown(("scenes", "s", "MB"), scenes)
    )


def _missing(data: dict[str, Any]) -> str:
    lines = [f"- {m['label']}: {m['missing']}" for m in data["methods"] if m["missing"]]
    lines += [f"- {name}: {why}" for name, why in data["left_out"].items()]
    return "## Not run\n\n" + "\n".join(lines) + "\n"
