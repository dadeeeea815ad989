"""The tables of the page of speed on patterns, from the recorded run of `python -m benchmarks patterns`."""

from __future__ import annotations

import json
import re
from typing import Any

from benchmarks.checkout import HERE
from benchmarks.patterns import PatternBench
from origami_nlp.io import from_plain

DATA = HERE / "docs" / "bench_patterns.json"
PAGE = HERE / "docs" / "validation" / "speed_patterns.md"


def with_tables(text: str, data: dict[str, Any]) -> str:
    """Return the page with the tables of methods and of parts, and the commit, as they were recorded."""
    fields = PatternBench.__dataclass_fields__
    bench = from_plain(PatternBench, {k: v for k, v in data.items() if k in fields})
    lines = re.sub(r"Recorded at `[^`]*`", f"Recorded at `{data['stamp']}`", text).split("\n")
    for table in (bench.methods_table(), bench.scales_table()):
        made = table.markdown().rstrip().split("\n")
        first = lines.index(made[0])
        end = next(i for i in range(first, len(lines)) if not lines[i].startswith("|"))
        lines[first:end] = made
    return "\n".join(lines)


def write_page() -> None:
    """Write the tables from the record."""
    PAGE.write_text(with_tables(PAGE.read_text(), json.loads(DATA.read_text())))
