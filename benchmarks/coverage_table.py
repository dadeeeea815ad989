"""What a measurement of searches says: shares of all that is known, seconds, and found against seconds."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.coverage import BEFORE, NOW, Covered, Searched
from benchmarks.digest import Spread
from origami_nlp.display import rows_markdown
from origami_nlp.io import from_plain, save_figure

TIMES = (0.05, 0.1, 0.2, 0.3, 0.5, 1.0)
"""Processor seconds at which searches are compared."""
RIVAL = "SLSQP"
STYLES = {  # Okabe and Ito's colours; grey levels, dashes and markers distinguish them too
    NOW: ("#000000", "-", "*"),
    BEFORE: ("#777777", "-", "o"),
    RIVAL: ("#D55E00", "--", "^"),
    "SLSQP, given starts": ("#E69F00", "-.", "v"),
    "SLSQP, some fully folded": ("#CC79A7", (0, (5, 1, 1, 1, 1, 1)), "s"),
    "IPOPT": ("#0072B2", ":", "D"),
    "basin hopping": ("#56B4E9", (0, (1, 2)), "X"),
    "trust-constr": ("#999933", (0, (3, 2)), "P"),
    "NLopt SLSQP": ("#009E73", (0, (6, 1)), "<"),
}

Row = tuple[str, ...]


def scenes_of(data: dict[str, Any]) -> dict[str, list[Covered]]:
    """Return the scenes of a measurement by family."""
    out: dict[str, list[Covered]] = {}
    for plain in data["scenes"]:
        runs = {name: [from_plain(Searched, r) for r in of] for name, of in plain["runs"].items()}
        out.setdefault(plain["family"], []).append(Covered(**{**plain, "runs": runs}))
    return out


def shares(scenes: Sequence[Covered], name: str) -> tuple[float, float, float]:
    """Return the share of all minima that a searcher finds: the least of its seeds, the median, all seeds together."""
    total = sum(c.minima for c in scenes)
    seeds = min(len(c.runs[name]) for c in scenes)
    each = [sum(len(c.runs[name][s].found) for c in scenes) / total for s in range(seeds)]
    together = sum(len(set().union(*(r.found for r in c.runs[name]))) for c in scenes) / total
    return min(each), median(each), together


def faster(scenes: Sequence[Covered]) -> Spread | None:
    """Return how many times less processor time the main job takes than that of the other checkout, over scenes."""
    return Spread.of(
        sum(r.seconds for r in c.runs[BEFORE]) / sum(r.seconds for r in c.runs[NOW])
        for c in scenes
        if BEFORE in c.runs
    )


def share_at(scenes: Sequence[Covered], name: str, seconds: float) -> float:
    """Return the share of all minima that a searcher knows after so many seconds, mean over its seeds."""
    known = 0.0
    for c in scenes:
        known += sum(_known(r, seconds) for r in c.runs[name]) / len(c.runs[name])
    return known / sum(c.minima for c in scenes)


def _known(run: Searched, seconds: float) -> int:
    position = bisect_right([t for t, _ in run.curve], seconds)
    return run.curve[position - 1][1] if position else 0


def sooner(scenes: Sequence[Covered]) -> Spread | None:
    """Return how many times sooner the main job knows as many minima as the rival in the end; 0 where it never does."""
    out = []
    for c in scenes:
        for theirs in c.runs.get(RIVAL, ()):
            count = len(theirs.found)
            last = theirs.curve[-1][0] if theirs.curve else 0.0
            for r in c.runs[NOW]:
                first = next((t for t, n in r.curve if n >= count), math.inf)
                out.append(last / first if first else math.inf)
    return Spread.of(out)


def per_correct(scenes: Sequence[Covered]) -> Spread | None:
    """Return seconds a minimum correct to 1e-10 by the rival, until its last one, over the main job's whole time."""
    out = []
    for c in scenes:
        ours = sum(r.seconds for r in c.runs[NOW]) / max(1, sum(len(r.found) for r in c.runs[NOW]))
        for r in c.runs.get(RIVAL, ()):
            out.append(r.exact_seconds / r.exact / ours if r.exact else math.inf)
    return Spread.of(out)


SHARE_HEADS = (
    "family",
    "scenes",
    "minima",
    "found once",
    "searcher",
    "share a seed, least",
    "median",
    "all seeds",
    "s a search",
    "times faster than before",
    "other kind",
)


def share_rows(data: dict[str, Any]) -> list[Row]:
    """Return one row for each family and checkout."""
    out: list[Row] = []
    for family, scenes in scenes_of(data).items():
        for name in (NOW, BEFORE):
            if name not in scenes[0].runs:
                continue
            least, middle, together = shares(scenes, name)
            runs = [r for c in scenes for r in c.runs[name]]
            out.append(
                (
                    family,
                    str(len(scenes)),
                    str(sum(c.minima for c in scenes)),
                    str(sum(c.once for c in scenes)),
                    name,
                    _percent(least),
                    _percent(middle),
                    _percent(together),
                    f"{median(r.seconds for r in runs):.3g}",
                    _spread(faster(scenes)) if name == NOW else "",
                    str(sum(r.other_kind for r in runs)),
                )
            )
    return out


CURVE_HEADS = (
    "family",
    "searcher",
    *(f"{t:g} s" for t in TIMES),
    "in the end",
    "ms a start",
    "rejected",
    "false answers",
)


def curve_rows(data: dict[str, Any]) -> list[Row]:
    """Return one row for each family and searcher: share known after `TIMES`, rejects and false answers."""
    out: list[Row] = []
    for family, scenes in scenes_of(data).items():
        if RIVAL not in scenes[0].runs:
            continue
        for name in scenes[0].runs:
            runs = [r for c in scenes for r in c.runs[name]]
            attempts = sum(r.attempts for r in runs)
            reported = ("-", "-", "0 (certified)")
            if attempts:
                reported = (
                    f"{1e3 * sum(r.seconds for r in runs) / attempts:.2g}",
                    _percent(sum(r.rejected for r in runs) / attempts),
                    str(sum(r.false for r in runs)),
                )
            at = (_percent(share_at(scenes, name, t)) for t in TIMES)
            out.append((family, name, *at, _percent(share_at(scenes, name, math.inf)), *reported))
    return out


RATIO_HEADS = (
    "family",
    f"times sooner to as many as {RIVAL}",
    f"{RIVAL} over us: s a minimum correct to 1e-10",
)


def ratio_rows(data: dict[str, Any]) -> list[Row]:
    """Return one row for each family that the rival searched."""
    return [
        (family, _spread(sooner(scenes)), _spread(per_correct(scenes)))
        for family, scenes in scenes_of(data).items()
        if RIVAL in scenes[0].runs
    ]


MISSED_HEADS = ("scene", "degree", "minima", "missed by seeds", "missed by all")


def missed_rows(data: dict[str, Any]) -> list[Row]:
    """Return the scenes where some seed of the main job misses a minimum."""
    out: list[Row] = []
    for scenes in scenes_of(data).values():
        for c in scenes:
            missed = [c.minima - len(r.found) for r in c.runs[NOW]]
            together = c.minima - len(set().union(*(r.found for r in c.runs[NOW])))
            if any(missed):
                each = ", ".join(map(str, missed))
                out.append((c.name, str(c.degree), str(c.minima), each, str(together)))
    return out


def coverage_markdown(data: dict[str, Any]) -> str:
    """Return all tables as Markdown."""
    said = data["settings"]
    begin = (
        f"Processor seconds of one thread; {said['seeds']} seeds of the main job, one run of {said['budget']:g} s of "
        "each foreign search.  Shares are of the union of everything that anything found, each member polished and "
        "classified (found once: by a single one of the runs behind it).  Medians with [quartiles] over scenes."
    )
    scenes = [c for of in scenes_of(data).values() for c in of]
    proved = sum(c.proved == "proved" for c in scenes)
    begin += f"  The unions of {proved} of {len(scenes)} scenes are proved complete."
    parts = [begin]
    for title, heads, rows in (
        ("What is found", SHARE_HEADS, share_rows(data)),
        ("Found against seconds", CURVE_HEADS, curve_rows(data)),
        ("Against " + RIVAL, RATIO_HEADS, ratio_rows(data)),
        ("What is missed", MISSED_HEADS, missed_rows(data)),
    ):
        if rows:
            parts += [f"## {title}", rows_markdown(heads, rows).rstrip()]
    return "\n\n".join(parts) + "\n"


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def _spread(spread: Spread | None) -> str:
    if spread is None:
        return "-"
    return f"{spread.median:.3g} [{spread.low:.2g}, {spread.high:.2g}]"


def draw_coverage(data: dict[str, Any], target: str | Path) -> None:
    """Draw the share of all minima against seconds for each family that foreign searches ran on."""
    from matplotlib.figure import Figure

    families = {f: s for f, s in scenes_of(data).items() if RIVAL in s[0].runs}
    figure = Figure(figsize=(4.6 * max(1, len(families)), 4.2), layout="constrained")
    axes = figure.subplots(1, max(1, len(families)), squeeze=False, sharey=True)[0]
    end = max(1.0, float(data["settings"]["budget"]))
    for ax, (family, scenes) in zip(axes, families.items(), strict=False):
        for name in scenes[0].runs:
            colour, dashes, marker = STYLES[name]
            times = sorted({t for t in _geometric(0.02, end, 90)})
            y = [100 * share_at(scenes, name, t) for t in times]
            width = 2.6 if name == NOW else 1.5
            ax.plot(
                times,
                y,
                color=colour,
                linestyle=dashes,
                marker=marker,
                markevery=(8, 18),
                markersize=9 if name == NOW else 5.5,
                linewidth=width,
                label=name,
            )
        ax.set_xscale("log")
        ax.set_xticks(TIMES, [f"{t:g}" for t in TIMES])
        ax.minorticks_off()
        ax.set_ylim(0, 102)
        ax.set_xlabel("processor seconds")
        degrees = sorted({c.degree for c in scenes})
        title = f"{family}, degree {degrees[0]}" + f" to {degrees[-1]}" * (len(degrees) > 1)
        ax.set_title(f"{title}: {sum(c.minima for c in scenes)} minima", fontsize=10)
        ax.grid(alpha=0.3)
        ax.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("share of all known minima [%]")
    handles = {
        label: handle
        for ax in axes
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="outside lower center",
        ncols=min(4, 2 * max(1, len(families))),
        frameon=False,
        fontsize=9,
    )
    save_figure(figure, target, 150)


def _geometric(low: float, high: float, count: int) -> Iterable[float]:
    return (low * (high / low) ** (k / (count - 1)) for k in range(count))
