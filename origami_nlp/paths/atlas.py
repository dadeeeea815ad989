"""What is known of the states over a parameter: branches, events, counts, and the checks by searches."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from origami_nlp.continuation import BifurcationDiagram
from origami_nlp.display import (
    Content,
    Details,
    Report,
    Section,
    Table,
    Viewable,
    Words,
    angle_columns,
)
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.paths.family import Family, family_of, pattern_family
from origami_nlp.paths.judging import states_at
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.records import (
    Cost,
    Interval,
    PathBranch,
    PathEvent,
    SearchCheck,
    StateAt,
)
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.pattern_problem import pose

COMPLETE = {
    "proved": "proved to be all",
}
"""How it is said that a check is complete."""
MOST_NAMED = 4
"""Values at which the number of minima changes that the verdict names."""


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
    def stopped(self) -> bool:
        """Whether the user (Ctrl-C) ended it, in place of the time."""
        return self.web is not None and self.web.stopped

    @property
    def _ended(self) -> str:
        return "interrupted" if self.stopped else OUT_OF_TIME

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
        problem, s = pose(self.family.scene(value)), parameter.s_of(value)
        here = states_at(problem, value, s, self.web, self.branches, self.branch_of_arc)
        more = (state for other in self.others for state in other.at(value))
        return (
            tuple(sorted((*here, *more), key=lambda state: state.energy)) if self.others else here
        )

    def summary(self) -> str:
        """Return one line: how many minima there are, and where their number changes."""
        found, over = self.intervals, self.parameter
        scene = self.scene if isinstance(self.scene, Scene) else None
        kept = scene is not None and not scene.group.is_trivial
        counts = sorted({i.minima for i in found})
        many = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
        noun = f"minim{'um' if counts == [1] else 'a'}"
        said = f"{self.scene.title}: {many} {'symmetric ' * kept}{noun}"
        said += f" over {over.name} = {over.shown(over.low)} to {over.shown(over.high)}"
        changes = [over.shown(b.t[0]) for a, b in itertools.pairwise(found) if a.minima != b.minima]
        if changes:
            where = ", ".join(changes) if len(changes) <= MOST_NAMED else f"{len(changes)} values"
            said += f"; their number changes at {where}"
        said += f"; {self._ended}" if self.interrupted else ""
        return said + (f"; {len(self.alarms)} alarms" if self.alarms else "")

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
        heads = (self.parameter.name, "minima", "kinds")
        return Table(heads, rows, self.summary(), "lrL", framed=False, narrow=True)

    def report_sections(self) -> Iterator[Section]:
        """Return counts, events, what is not known, and the details: branches, checks and what they cost."""
        over = self.parameter
        yield self.table()
        rows = []
        for e in self.events:
            rows.append((str(e.id), over.shown(e.t), e.words(), ", ".join(map(str, e.branches))))
        if rows:
            heads = ("event", over.name, "what happens", "branches")
            yield Table(heads, rows, "Events", "rrLr", framed=False, narrow=True)
        for e in self.events:
            if e.note:
                yield Words(f"event {e.id}: {e.note}")
        at = ", ".join(over.shown(c.t) for c in sorted(self.checks, key=lambda c: c.t))
        missed = sum(c.missed for c in self.checks)
        yield f"checked by searches at {over.name} = {at or 'no value'}" + (
            f", which missed {missed} of the states on branches" if missed else ""
        )
        yield "Isolated branches between the checks may be missing."
        yield from (Words(f"alarm: {line}", "bold") for line in self.alarms)
        if self.interrupted:
            yield Words(
                f"{self._ended}: branches and checks are those until then; intervals count what was followed",
                "bold",
            )
        yield Details(tuple(self._details()), "Branches, fold angles, checks")
        for other in self.others:
            stated: Any = other.scene
            yield Words(
                f"states that wind {stated.winding} times round the axis of {stated.group.name}"
            )
            yield from other.report_sections()

    def _details(self) -> Iterator[Table | Words]:
        """Return fold angles at events, branches, checks, and what they cost."""
        over = self.parameter
        if self.events:
            rows = [
                (str(e.id), over.shown(e.t, 12), self._angles(e.fold_angles)) for e in self.events
            ]
            heads = ("event", over.name, "fold angles [deg]")
            yield Table(heads, rows, "", "rlL", framed=False, narrow=True)
        for b in self.branches:
            parts = "; ".join(
                f"{r.kind} {over.shown(r.t[0])} to {over.shown(r.t[1])}" for r in b.kind_ranges
            )
            yield Words(f"branch {b.id}: {parts}; ends: {b.ends[0].why}, {b.ends[1].why}")
        for c in self.checks:
            more = f", {c.missed} on branches that it missed" if c.missed else ""
            more += f"; {c.morse}" if c.morse else ""
            more += f"; {COMPLETE.get(c.complete, c.complete)}" if c.complete else ""
            yield Words(
                f"check at {over.shown(c.t)}: {c.states} minima by search, {c.followed} on branches{more}; "
                f"{c.new_branches} new",
                "dim",
            )
        yield Words(
            f"{self.cost.steps} steps, {self.cost.seconds:.2f} s, and "
            f"{self.cost.checks:.2f} s for {len(self.checks)} searches",
            "dim",
        )

    @staticmethod
    def _angles(fold_angles: tuple[float, ...]) -> str:
        return ", ".join(f"{math.degrees(v):.2f}" for v in fold_angles)

    def _rows(self) -> Iterator[dict[str, object]]:
        whose = getattr(self.scene, "label", self.scene.name)
        for branch in self.branches:
            for k, p in enumerate(branch.points):
                row: dict[str, object] = {"scene": whose, "branch": branch.id}
                row["winding"] = getattr(self.scene, "winding", None) or 1
                row |= {"parameter": self.parameter.name, "t": p.t, "unit": self.parameter.unit}
                row |= {"energy_J": p.energy, "kind": branch.kind_at(k)}
                row["eigenvalue_N_m_per_rad"] = p.eigenvalue
                yield row | angle_columns(p.fold_angles)
        for other in self.others:
            yield from other._rows()

    def view_content(self) -> Content:
        """Return branches and events as plain data, see `view`."""
        from origami_nlp.paths.interactive import (
            view_branches,  # bodies in space are slow to import
        )

        return view_branches(self.family, self.branches, self.events, self.report_sections())

    def to_fold(self) -> dict[str, Any]:
        """Return the points of all branches as FOLD data (spec 1.1), one frame each, in order."""
        parameter, states = self.parameter, []
        for branch in self.branches:
            for k, point in enumerate(branch.points):
                kind = branch.kind_at(k)
                title = f"branch {branch.id}, {parameter.name} = {point.t:.9g}: {kind}"
                more = {"branch": branch.id, "parameter": point.t, "energy": point.energy}
                states.append((point.t, point.fold_angles, title, {**more, "kind": kind}))
        return self.family.to_fold(states)
