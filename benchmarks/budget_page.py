"""The page of where the time of a search goes, and its figure, as `python -m benchmarks profile` recorded them."""

from __future__ import annotations

import json
from statistics import quantiles
from typing import Any

from benchmarks import time_budget
from benchmarks.checkout import HERE
from benchmarks.time_budget import STAGES, TimeBudget

DATA = HERE / "docs" / "time_budget.json"
PAGE = HERE / "docs" / "validation" / "speed_budget.md"
FIGURE = HERE / "docs" / "figures" / "time_budget.png"
NAMED = 5
"""Stages that the opening names, the longest first."""


def budgets_of(data: dict[str, Any]) -> list[TimeBudget]:
    """Return the budgets of a record."""
    names = TimeBudget.__dataclass_fields__
    return [TimeBudget(**{k: v for k, v in one.items() if k in names}) for one in data["panels"]]


def page(data: dict[str, Any]) -> str:
    """Return the page."""
    budgets = budgets_of(data)
    seconds = [b.total for b in budgets]
    total, (low, mid, high) = sum(seconds), quantiles(seconds, n=4, method="inclusive")
    shares = {s: sum(b.seconds[s] for b in budgets) / total for s in STAGES}
    longest = sorted(STAGES, key=lambda s: -shares[s])[:NAMED]
    named = ", ".join(f"{s} {100 * shares[s]:.0f} %" for s in longest)
    spread = f"{mid:.2f} s (median; quartiles {low:.2f} and {high:.2f}, at most {max(seconds):.2f})"
    origin = f"Recorded at `{data['stamp']}` by `{data['command']}`"
    table = time_budget.markdown(budgets).rstrip()
    return f"""# Where the time of a search goes

One search of a panel, with what it takes to leave each state and what is stable without the symmetry, takes
{spread} of processor time, all {len(budgets)} together {total:.2f} s.
The longest stages: {named}.
Proofs are left out here: [speed.md](speed.md) has them, and the same calls before and after in turn.

{origin}: one `find_minima(prove=False)` of each panel, solvers
built anew, in seconds of one thread of a machine that may have been busy with other work, which makes them up to twice
as long; stages that run inside another count once. "Descents" are those of batches, "judging" the classification of
every distinct end and of every listed state, "IPOPT confirms" one solve from each minimum.
`python -m benchmarks page` writes this page from the record.

![Stages of one search of each panel, stacked](../figures/time_budget.png)

{table}
"""


def write_page() -> None:
    """Write page and figure from the record."""
    data = json.loads(DATA.read_text())
    PAGE.write_text(page(data))
    time_budget.draw(budgets_of(data), FIGURE)
