"""What is known of the states over a parameter: branches, events, counts, and the checks by searches."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from origami_nlp.bifurcation.family import Family, family_of
from origami_nlp.bifurcation.judging import states_at
from origami_nlp.bifurcation.parameter_range import ParameterRange
from origami_nlp.bifurcation.patterns import pattern_family
from origami_nlp.bifurcation.records import (
    Cost,
    Interval,
    PathBranch,
    PathEvent,
    SearchCheck,
    StateAt,
)
from origami_nlp.continuation import BifurcationDiagram
from origami_nlp.display import Content, Report, Section, Table, Viewable, Words
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.pattern import Pattern, Scene

COMPLETE = {
    "proved": "proved to be all",
    "traced": "all that the curves of its one degree of freedom hold",
}
"""How it is said that a check is complete."""


@dataclass(frozen=True, eq=False, repr=False)
class Atlas(Report, Viewable):
    """All states that were found over a parameter.

    Attributes
    ----------
    scene
        The scene, or the pattern, that the others differ from.
    parameter
        The parameter and its range.
    branches, events, checks
        In order of their numbers; checks in the order in which they were made.
    alarms
        What does not fit together, in words; empty where everything does.
    cost
        What it took.
    family
        The scenes.
    web, branch_of_arc
        What was followed, for `at`; None and empty where the atlas was read from a file.
    others
        Atlases of the symmetric states that wind more often round their axis (`Scene.windings`), one for each winding:
        branches, events and intervals of this one are about states that wind once.
    interrupted
        Whether the time was over before all was followed: branches and checks are those until then, and intervals count
        what was followed.
    example
        Of patterns over an option of an example, its name; "" elsewhere.

    Examples
    --------
    >>> import origami_nlp as o
    >>> atlas = o.follow(o.examples.degree6("pi/4"), "ratio=1:1.1", checks=1, full=False)
    >>> [interval.minima for interval in atlas.intervals], [branch.kind_ranges[0].kind for branch in atlas.branches]
    ([2], ['interior', 'contact-touching'])
    """

    scene: Scene | Pattern
    parameter: ParameterRange
    branches: tuple[PathBranch, ...]
    events: tuple[PathEvent, ...]
    checks: tuple[SearchCheck, ...]
    alarms: tuple[str, ...]
    cost: Cost
    family: Family = field(default=None, metadata={"plain": False})  # type: ignore[assignment]
    web: BifurcationDiagram | None = field(default=None, metadata={"plain": False})
    branch_of_arc: dict[int, int] = field(default_factory=dict, metadata={"plain": False})
    others: tuple[Atlas, ...] = ()
    interrupted: bool = False
    example: str = field(default="", metadata={"omit": True})

    PICTURE, SCHEMA = "draw_atlas", "origami-nlp/follow/3"
    ALSO = ("intervals",)

    def __post_init__(self) -> None:
        if self.family is None:  # read from a file
            if self.parameter.name.startswith("loads"):
                raise OptionError("an atlas over forces cannot be read back: follow it anew")
            made: Any = (
                family_of(self.scene, self.parameter)
                if isinstance(self.scene, Scene)
                else pattern_family(self.example or self.scene, self.parameter)
            )
            object.__setattr__(self, "family", made)

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """Number and kinds of minima between the values at which they change."""
        ranges = [r for b in self.branches for r in b.kind_ranges if r.stable]
        cuts = sorted({self.parameter.low, self.parameter.high, *(t for r in ranges for t in r.t)})
        out: list[Interval] = []
        # images of one event under a symmetry of the scene come at one value, up to rounding
        apart = [a for a, b in itertools.pairwise(cuts) if b - a > DUPLICATE_TOL * max(1.0, abs(b))]
        for a, b in itertools.pairwise([*apart, cuts[-1]]):
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
            Minima and saddles, in order of energy, those of `others` among them.

        Raises
        ------
        OptionError
            If it is outside what was followed, or the atlas was read from a file.
        """
        parameter = self.parameter
        if self.web is None:
            raise OptionError(
                "an atlas that was read from a file has its branches and events, not what was followed: follow anew "
                "for the states at a value"
            )
        if not parameter.low <= value <= parameter.high:
            raise OptionError(
                f"value = {value:g} is outside what was followed, {parameter.low:g} to {parameter.high:g}"
            )
        problem, s = self.family.problem(self.family.scene(value)), parameter.s_of(value)
        here = states_at(problem, value, s, self.web, self.branches, self.branch_of_arc)
        more = (state for other in self.others for state in other.at(value))
        return (
            tuple(sorted((*here, *more), key=lambda state: state.energy)) if self.others else here
        )

    def summary(self) -> str:
        """Return one line."""
        found = (
            f"{len(self.branches)} branches, {len(self.events)} events over {self.parameter.name}"
        )
        found += f", {OUT_OF_TIME}" if self.interrupted else ""
        return found + (f", {len(self.alarms)} alarms" if self.alarms else "")

    def table(self) -> Table:
        """Return one row an interval."""
        rows = [
            (
                f"{self.parameter.shown(i.t[0])} to {self.parameter.shown(i.t[1])}",
                str(i.minima),
                ", ".join(f"{n} {kind}" for kind, n in i.kinds.items()),
            )
            for i in self.intervals
        ]
        return Table((self.parameter.name, "minima", "kinds"), rows, self.summary(), "lrl")

    def report_sections(self) -> Iterator[Section]:
        """Return counts, events, branches, checks and what they cost."""
        yield self.table()
        rows = [
            (
                str(e.id),
                e.type,
                self.parameter.shown(e.t, 12),
                e.contact or "-",
                self._angles(e.fold_angles),
            )
            for e in self.events
        ]
        yield Table(
            ("event", "type", self.parameter.name, "contact", "fold angles [deg]"),
            rows,
            columns="rllLL",
        )
        for b in self.branches:
            parts = "; ".join(
                f"{r.kind} {self.parameter.shown(r.t[0])} to {self.parameter.shown(r.t[1])}"
                for r in b.kind_ranges
            )
            yield Words(f"branch {b.id}: {parts}; ends: {b.ends[0].why}, {b.ends[1].why}")
        for e in self.events:
            if e.note:
                yield Words(f"event {e.id}: {e.note}")
        for c in self.checks:
            more = f", {c.missed} on branches that it missed" if c.missed else ""
            more += f"; {c.morse}" if c.morse else ""
            more += f"; {COMPLETE.get(c.complete, c.complete)}" if c.complete else ""
            yield Words(
                f"check at {self.parameter.shown(c.t)}: {c.states} minima by search, {c.followed} on branches{more}; "
                f"{c.new_branches} new",
                "dim",
            )
        yield Words(
            f"{self.cost.steps} steps, {self.cost.seconds:.2f} s, and "
            f"{self.cost.checks:.2f} s for {len(self.checks)} searches.  States that no check found and no event "
            "leads to (isolated branches between the checks) are not here.",
            "dim",
        )
        yield from (Words(f"alarm: {line}", "bold") for line in self.alarms)
        if self.interrupted:
            yield Words(
                f"{OUT_OF_TIME}: branches and checks are those until then; intervals count what was followed",
                "bold",
            )
        for other in self.others:
            stated: Any = other.scene
            yield Words(
                f"states that wind {stated.winding} times round the axis of {stated.group.name}"
            )
            yield from other.report_sections()

    @staticmethod
    def _angles(fold_angles: tuple[float, ...]) -> str:
        return ", ".join(f"{math.degrees(v):.2f}" for v in fold_angles)

    def view_content(self) -> Content:
        """Return branches and events as plain data, see `view`."""
        from origami_nlp.bifurcation.interactive import (
            view_branches,  # bodies in space are slow to import
        )

        return view_branches(self.family, self.branches, self.events, self.report_sections())

    def to_fold(self) -> dict[str, Any]:
        """Return the points of all branches as FOLD data (spec 1.1), one frame each, in order."""
        parameter, states = self.parameter, []
        for branch in self.branches:
            for k, point in enumerate(branch.points):
                kind = next(r.kind for r in branch.kind_ranges if r.points[0] <= k <= r.points[1])
                title = f"branch {branch.id}, {parameter.name} = {point.t:.9g}: {kind}"
                more = {"branch": branch.id, "parameter": point.t, "energy": point.energy}
                states.append((point.t, point.fold_angles, title, {**more, "kind": kind}))
        return self.family.to_fold(states)
