"""The page of speed against error, the sentence of the README, and their figure, from one recorded measurement.

`python -m benchmarks page` writes them from `docs/bench_search.json`, which `python -m benchmarks search` writes; a
test compares what stands there with what is made, so that no number is typed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from statistics import median
from typing import Any

from benchmarks.by_scip import LIMIT
from benchmarks.checkout import HERE
from benchmarks.coverage import NOW, Covered
from benchmarks.coverage_table import (
    RIVAL,
    TIMES,
    curve_rows,
    draw_coverage,
    per_correct,
    scenes_of,
    share_at,
)
from benchmarks.digest import Spread
from benchmarks.report import appendix_section, grid_section
from origami_nlp.display import rows_markdown

DATA = HERE / "docs" / "bench_search.json"
PAPER = HERE / "docs" / "bench.json"
PAGE = HERE / "docs" / "validation" / "speed.md"
FIGURE = HERE / "docs" / "figures" / "speed.png"
README = HERE / "README.md"
BEGIN, END = "- **Speed against error.**", "\n- **"
"""Where the README's sentence begins and what comes after it."""
HINTED = "SLSQP, given starts"
"""A foreign search that gets starts of ours, which no user has."""
AHEAD = TIMES
"""Processor seconds from which on a search may be ahead: those of the table."""


def compared(data: dict[str, Any]) -> list[Covered]:
    """Return all scenes that foreign searches ran on."""
    return [c for of in scenes_of(data).values() for c in of if RIVAL in c.runs]


def searchers(scenes: Sequence[Covered]) -> list[str]:
    """Return who searched all of some scenes, ours first."""
    return [n for n in scenes[0].runs if all(n in c.runs for c in scenes)]


def best_rival(scenes: Sequence[Covered], seconds: float) -> tuple[str, float]:
    """Return who else, with starts of its own, knows most after so many seconds, and which share."""
    others = [n for n in searchers(scenes) if n not in (NOW, HINTED)]
    return max(((n, share_at(scenes, n, seconds)) for n in others), key=lambda found: found[1])


def ahead_from(scenes: Sequence[Covered], rival: str) -> float:
    """Return from which of `AHEAD` on the main job knows no less than a rival; inf where it never does."""
    first = math.inf
    for t in reversed(AHEAD):
        if share_at(scenes, NOW, t) < share_at(scenes, rival, t):
            break
        first = t
    return first


def false_states(scenes: Sequence[Covered], name: str) -> int:
    """Count distinct states that a searcher claimed and that are no minima."""
    return sum(r.false for c in scenes for r in c.runs[name])


def in_short(data: dict[str, Any]) -> str:
    """Return the result in three sentences."""
    scenes = compared(data)
    minima = sum(c.minima for c in scenes)
    rival, theirs = best_rival(scenes, TIMES[-1])
    ratio = per_correct(scenes)
    early, share = best_rival(scenes, TIMES[0])
    return (
        f"After {TIMES[-1]:g} s this package lists {_percent(share_at(scenes, NOW, TIMES[-1]))} of the {minima} known "
        f"minima of {len(scenes)} vertices and nothing false; the best other search, {rival}, has "
        f"{_percent(theirs)} and claims {false_states(scenes, rival)} states that are no minima. "
        f"A minimum right to 1e-10 rad costs SciPy's SLSQP {_spread(ratio)} times the processor time. "
        f"After {TIMES[0]:g} s it is {_percent(share_at(scenes, NOW, TIMES[0]))} against "
        f"{_percent(share)} ({early}); a bare local solve is faster than anything here where one minimum, and no word "
        "on what else there is, will do."
    )


def readme_line(data: dict[str, Any]) -> str:
    """Return the README's sentence."""
    scenes = compared(data)
    at = share_at(scenes, NOW, TIMES[-1]), share_at(scenes, RIVAL, TIMES[-1])
    ratio = per_correct(scenes)
    words = (
        f"{BEGIN} After {TIMES[-1]:g} s a search lists {_percent(at[0])} of "
        f"{sum(c.minima for c in scenes)} known minima "
        f"and nothing false, SciPy's SLSQP {_percent(at[1])} and {false_states(scenes, RIVAL)} states that are no "
        f"minima; one right to 1e-10 rad costs it {_median(ratio)} times our time. "
        "[Speed](docs/validation/speed.md), [what a search finds](docs/validation/search_studies.md)"
    )
    return _wrapped(words, 100)


def _wrapped(words: str, width: int) -> str:
    lines, line = [], ""
    for word in re.findall(r"\[[^\]]*\]\([^)]*\),?|\S+", words):
        if len(line) + 1 + len(word) > width:
            lines.append(line)
            line = "  " + word
        else:
            line = f"{line} {word}" if line.strip() else line + word
    return "\n".join([*lines, line])


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _spread(found: Spread | None) -> str:
    return (
        "-"
        if found is None
        else f"{_number(found.median)} [{_number(found.low)}, {_number(found.high)}]"
    )


def _median(found: Spread | None) -> str:
    return "-" if found is None else _number(found.median)


def _number(value: float) -> str:
    return "inf" if math.isinf(value) else f"{value:.2g}"


def _by_degree(scenes: Sequence[Covered]) -> Iterable[tuple[str, ...]]:
    for family in dict.fromkeys(c.family for c in scenes):
        of = [c for c in scenes if c.family == family]
        for degree in sorted({c.degree for c in of}):
            some = [c for c in of if c.degree == degree]
            ours = [r.seconds for c in some for r in c.runs[NOW]]
            yield (
                family,
                str(degree),
                str(sum(c.minima for c in some)),
                f"{sum(ours) / len(ours):.2f}",
                _percent(share_at(some, NOW, math.inf)),
                _percent(share_at(some, RIVAL, math.inf)),
                *(
                    _from(ahead_from(some, n))
                    for n in (RIVAL, "NLopt SLSQP")
                    if n in searchers(some)
                ),
                _spread(per_correct(some)),
            )


def _from(seconds: float) -> str:
    return "never" if math.isinf(seconds) else f"{seconds:g} s"


def _precision(scenes: Sequence[Covered]) -> Iterable[tuple[str, ...]]:
    for name in searchers(scenes):
        runs = [r for c in scenes for r in c.runs[name]]
        attempts = sum(r.attempts for r in runs)
        found = sum(len(r.found) for r in runs)
        errors = Spread.of(r.error for r in runs if math.isfinite(r.error))
        yield (
            name,
            f"{1e3 * sum(r.seconds for r in runs) / attempts:.2g}" if attempts else "-",
            f"{1e3 * sum(r.seconds for r in runs) / found:.3g}" if found else "-",
            f"{errors.median:.0e}" if errors else "rounding",
            _percent(sum(r.exact for r in runs) / found) if attempts and found else "100 %",
            str(false_states(scenes, name)) if attempts else "0 (certified)",
        )


def markdown(data: dict[str, Any], paper: dict[str, Any]) -> str:
    """Return the page."""
    scenes, said, costs = compared(data), data["settings"], data["costs"]
    degree = (
        "family",
        "degree",
        "minima",
        "s a search",
        "listed",
        f"{RIVAL}, {said['budget']:g} s",
        f"ahead of {RIVAL} from",
        *(["ahead of NLopt from"] if "NLopt SLSQP" in searchers(scenes) else []),
        f"{RIVAL} over us: s a minimum to 1e-10",
    )
    precision = (
        "search",
        "ms a start",
        "ms a minimum",
        "error [rad]",
        "of these right to 1e-10",
        "false answers",
    )
    stages = (
        "scene",
        "minima",
        "search",
        "proof",
        "escape barriers",
        "without the symmetry",
        "whole",
        "proof says",
    )
    parts = [
        "# Speed against error",
        in_short(data),
        f"![Share of all known minima against processor seconds](../figures/{FIGURE.name})",
        f"Recorded at `{data['stamp']}`: {said['seeds']} seeds of `find_minima(prove=False, escape=False)`, one run of "
        f"{said['budget']:g} s of each other search, processor seconds of one thread without imports and compilation "
        "(below). Others get this package's own problem (closure, planes between facets that an answer makes cross) "
        "with exact derivatives compiled by CasADi, from uniform random fold angles; "
        f'"some fully folded" folds a random share of them by 180°, "{HINTED}" gets the package\'s corners of the '
        "state space for nothing. Known is what thorough runs of this package and all other searches together found, "
        "each polished and certified: "
        f"{said['union_seeds']} thorough runs, and {said['union_seconds'][0]:g} to {said['union_seconds'][1]:g} s of "
        "each other search on every vertex. Whole patterns, with bars and hinges: "
        "[speed_patterns.md](speed_patterns.md)."
        + (f" {data['remark']}" if data.get("remark") else ""),
        "<!-- run: not: it takes an hour -->\n```bash\nexport OMP_NUM_THREADS=1\n"
        + data["command"]
        + "\npython -m benchmarks page\n```",
        "## Found against seconds, by degree",
        rows_markdown(degree, list(_by_degree(scenes))).rstrip(),
        f"Last column: {RIVAL}'s time until the last minimum that it has right, over our whole search, both a minimum; "
        "inf: it has none right.",
        "## Work and precision",
        rows_markdown(precision, list(_precision(scenes))).rstrip(),
        "Errors are medians over scenes of the largest error of a fold angle of what was claimed near a minimum. Those "
        f"of this package, against solutions to 50 digits of {len(costs['errors'])} minima: median "
        f"{median(costs['errors']):.0e}, largest {max(costs['errors']):.0e} rad.",
        "## Share of all known minima after so many seconds",
        _shares(data),
        "## What it costs before anything is searched",
        rows_markdown(
            ("process", "s"), [(n, f"{s:.2f}") for n, s in costs["processes"].items()]
        ).rstrip(),
        "Python's own compilation of the modules is left out, as where the package is installed. Descents, and what "
        "proofs do with boxes, are compiled once a machine, by half a second of `cc`.",
        _before(costs),
        "## What a call without options does",
        "Seconds of `find_minima(scene)`: the search, and what it does unasked; `prove=False, escape=False` leave that "
        "out.",
        rows_markdown(stages, [_stage(s) for s in costs["stages"]]).rstrip(),
        "## One global minimum: SCIP",
        _global(costs["global"]),
        "## Where others are ahead",
        _behind(data),
        "## The paper's own methods",
        "Of an earlier recorded run (`docs/bench.json`, panels of the paper): they have not changed.",
        grid_section(paper).rstrip(),
        appendix_section(paper).rstrip(),
    ]
    return "\n\n".join(parts) + "\n"


def _shares(data: dict[str, Any]) -> str:
    heads = ("family", "search", *(f"{t:g} s" for t in TIMES), "in the end")
    return rows_markdown(heads, [row[: len(heads)] for row in curve_rows(data)]).rstrip()


def _before(costs: dict[str, Any]) -> str:
    """Say what the panels took before and take now, as each is called."""
    if "before" not in costs:
        return ""
    rows = []
    calls = {k: v for k, v in costs["before"].items() if k != "stamp"}
    for name, found in calls.items():
        spreads = [
            Spread.of(values)
            for values in (
                [r["before"] for r in found],
                [r["after"] for r in found],
                [r["before"] / r["after"] for r in found],
            )
        ]
        numbers = (f"{s.median:.2f} [{s.low:.2f}, {s.high:.2f}]" for s in spreads if s)
        residuals = (f"{max(r['residual'][k] for r in found):.0e}" for k in (0, 1))
        minima = (str(sum(r["minima"][k] for r in found)) for k in (0, 1))
        proved = (str(sum(r["says"][k] == "proved" for r in found)) for k in (0, 1))
        rows.append((name, *numbers, " / ".join(minima), " / ".join(proved), " / ".join(residuals)))
    heads = (
        "18 panels of the paper",
        "s before",
        "s now",
        "before / now",
        "minima",
        "proved",
        "largest residual",
    )
    return (
        f"The paper's panels at `{costs['before']['stamp']}` (before) and `{costs['stamp']}` (now), in turn: medians "
        "[quartiles] of seconds of one call each; residuals of closure and stationarity.\n\n"
        + rows_markdown(heads, rows).rstrip()
    )


def _stage(found: dict[str, Any]) -> tuple[str, ...]:
    from benchmarks.fixed_costs import STAGES

    seconds = (f"{found.get(name, 0.0):.2f}" for name in STAGES.values())
    return (found["scene"], str(found["minima"]), *seconds, f"{found['whole']:.2f}", found["says"])


def _global(found: Sequence[dict[str, Any]]) -> str:
    if not found:
        return "Not installed where this was measured."
    heads = (
        "degree",
        "SCIP says",
        "s",
        "its bounds [J]",
        "least energy here [J]",
        "s, all minima proved",
    )
    rows = [
        (
            str(g["degree"]),
            g["status"],
            f"{g['seconds']:.1f}",
            f"{g['lower']:.4g} to {g['upper']:.4g}",
            f"{g['least']:.6g}",
            f"{g['ours']:.2f}",
        )
        for g in found
    ]
    said = f"The state of least energy alone, closure by quaternions, stopped after {LIMIT:g} s of wall time."
    return said + "\n\n" + rows_markdown(heads, rows).rstrip()


def _behind(data: dict[str, Any]) -> str:
    lines = []
    for family, scenes in scenes_of(data).items():
        if RIVAL not in scenes[0].runs:
            continue
        for name in searchers(scenes):
            at = [t for t in TIMES if share_at(scenes, name, t) > share_at(scenes, NOW, t)]
            if name != NOW and at:
                shares = ", ".join(
                    f"{t:g} s: {_percent(share_at(scenes, name, t))} against {_percent(share_at(scenes, NOW, t))}"
                    for t in at
                )
                lines.append(f"- {family}, {name}: {shares}")
    return "\n".join(lines) or "At no second of the table, on no family."


def write_page(data: dict[str, Any], paper: dict[str, Any]) -> None:
    """Write page, figure and the README's sentence."""
    PAGE.write_text(markdown(data, paper))
    README.write_text(with_line(README.read_text(), data))
    draw_coverage(data, FIGURE)


def with_line(readme: str, data: dict[str, Any]) -> str:
    """Return the README with its sentence on speed as it has to be."""
    begin = readme.index(BEGIN)
    end = readme.index(END, begin)
    return readme[:begin] + readme_line(data) + readme[end:]
