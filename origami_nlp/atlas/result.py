"""What is known of the states over a parameter: branches, events, counts, and the checks by searches."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from origami_nlp.atlas.family import Family, Over
from origami_nlp.atlas.judging import states_at
from origami_nlp.atlas.records import Check, Cost, Interval, PathBranch, PathEvent, StateAt
from origami_nlp.errors import OptionError
from origami_nlp.path import Web
from origami_nlp.pattern import Scene, scene_to_dict
from origami_nlp.show import Content, Piece, Table, Told, Turnable, Words, to_plain

SCHEMA = "origami-nlp/atlas/1"


@dataclass(frozen=True, eq=False, repr=False)
class Atlas(Told, Turnable):
    """All states that were found over a parameter.

    Attributes
    ----------
    scene
        The scene that the others differ from.
    over
        The parameter and its range.
    branches, events, checks
        In order of their numbers; checks in the order in which they were made.
    alarms
        What does not fit together, in words; empty where everything does.
    cost
        What it took.
    family, web, branch_of_arc
        The scenes, and what was followed, for `at`.
    """

    scene: Scene
    over: Over
    branches: tuple[PathBranch, ...]
    events: tuple[PathEvent, ...]
    checks: tuple[Check, ...]
    alarms: tuple[str, ...]
    cost: Cost
    family: Family
    web: Web
    branch_of_arc: dict[int, int]

    PICTURE = "draw_atlas"

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """Number and kinds of minima between the values at which they change."""
        ranges = [r for b in self.branches for r in b.kind_ranges if r.stable]
        cuts = sorted({self.over.low, self.over.high, *(t for r in ranges for t in r.t)})
        out: list[Interval] = []
        for a, b in itertools.pairwise(cuts):
            middle = 0.5 * (a + b)
            kinds = Counter(r.kind for r in ranges if r.low < middle < r.high)
            found = Interval((a, b), sum(kinds.values()), dict(sorted(kinds.items())))
            if out and out[-1].kinds == found.kinds:
                found = Interval((out[-1].t[0], b), found.minima, found.kinds)
                out.pop()
            out.append(found)
        return tuple(out)

    def at(self, value: float) -> tuple[StateAt, ...]:
        """Return the states of all branches at one value, polished and judged there.

        Parameters
        ----------
        value
            Of the parameter, in its unit.

        Returns
        -------
        tuple of StateAt
            Minima and saddles, in order of energy.

        Raises
        ------
        OptionError
            If it is outside what was followed.
        """
        over = self.over
        if not over.low <= value <= over.high:
            raise OptionError(
                f"value = {value:g} is outside what was followed, {over.low:g} to {over.high:g}"
            )
        scene, s = self.family.scene(value), over.s_of(value)
        return states_at(scene, value, s, self.web, self.branches, self.branch_of_arc)

    def summary(self) -> str:
        """Return one line."""
        found = f"{len(self.branches)} branches, {len(self.events)} events over {self.over.name}"
        return found + (f", {len(self.alarms)} alarms" if self.alarms else "")

    def table(self) -> Table:
        """Return one row an interval."""
        rows = [
            (
                f"{self.over.shown(i.t[0])} to {self.over.shown(i.t[1])}",
                str(i.minima),
                ", ".join(f"{n} {kind}" for kind, n in i.kinds.items()),
            )
            for i in self.intervals
        ]
        return Table((self.over.name, "minima", "kinds"), rows, self.summary(), "lrl")

    def told(self) -> Iterator[Piece]:
        """Return counts, events, branches, checks and what they cost."""
        yield self.table()
        rows = [
            (
                str(e.id),
                e.type,
                self.over.shown(e.t, 12),
                e.contact or "-",
                self._angles(e.fold_angles),
            )
            for e in self.events
        ]
        yield Table(
            ("event", "type", self.over.name, "contact", "fold angles [deg]"), rows, columns="rllLL"
        )
        for b in self.branches:
            parts = "; ".join(
                f"{r.kind} {self.over.shown(r.t[0])} to {self.over.shown(r.t[1])}"
                for r in b.kind_ranges
            )
            yield Words(f"branch {b.id}: {parts}; ends: {b.ends[0].why}, {b.ends[1].why}")
        for e in self.events:
            if e.note:
                yield Words(f"event {e.id}: {e.note}")
        for c in self.checks:
            more = f", {c.missed} on branches that it missed" if c.missed else ""
            more += f"; {c.morse}" if c.morse else ""
            yield Words(
                f"check at {self.over.shown(c.t)}: {c.states} minima by search, {c.followed} on branches{more}; "
                f"{c.new_branches} new",
                "dim",
            )
        yield Words(
            f"{self.cost.steps} steps, {self.cost.evaluations} evaluations, {self.cost.seconds:.2f} s, and "
            f"{self.cost.checks:.2f} s for {len(self.checks)} searches.  States that no check found and no event "
            "leads to (isolated branches between the checks) are not here.",
            "dim",
        )
        yield from (Words(f"alarm: {line}", "bold") for line in self.alarms)

    @staticmethod
    def _angles(fold_angles: tuple[float, ...]) -> str:
        return ", ".join(f"{math.degrees(v):.2f}" for v in fold_angles)

    def turned(self) -> Content:
        """Return branches and events as plain data, see `view`."""
        from origami_nlp.atlas.turned import turn_branches  # bodies in space are slow to import

        return turn_branches(self.family, self.branches, self.events, self.told())

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        over = self.over
        return {
            "schema": SCHEMA,
            "scene": scene_to_dict(self.scene),
            "parameter": {
                "name": over.name,
                "unit": over.unit,
                "from": over.low,
                "to": over.high,
                "scale": "log" if over.log else "linear",
            },
            "branches": to_plain(self.branches),
            "events": to_plain(self.events),
            "intervals": to_plain(self.intervals),
            "checks": to_plain(self.checks),
            "alarms": list(self.alarms),
            "cost": to_plain(self.cost),
        }
