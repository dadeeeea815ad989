"""What is known of the states over a parameter: branches, events, counts, and the checks by searches."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from origami_nlp.display import Details, Section, Words
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import DUPLICATE_TOL, STATIONARY
from origami_nlp.paths.family import Family, family_of
from origami_nlp.paths.followed import FollowedDiagram
from origami_nlp.paths.records import Interval, PathPoint, SearchCheck
from origami_nlp.paths.result import Path, Plot
from origami_nlp.pattern import Pattern, Scene


@dataclass(frozen=True, eq=False, repr=False)
class Atlas(Path):
    """All states that were found over a parameter.

    Attributes
    ----------
    parameter
        The parameter, or the load, and its range.
    branches, events
        All equilibria that were followed, unstable ones included, and where they change, in order of their numbers.
    alarms
        What does not fit together, in words; empty where everything does.
    steps
        Of the continuation, that were accepted.
    interrupted
        Whether the time was over, or the user (Ctrl-C) ended it, before all was followed and judged.
    scene
        The scene, or the pattern, that the others differ from.
    checks
        In the order in which they were made.
    family
        The scenes.
    web
        What was followed, for `at`; None where the atlas was read from a file.
    example
        Of patterns over an option of an example, its name; "" elsewhere.

    Examples
    --------
    >>> import origami_nlp as o
    >>> atlas = o.follow(o.examples.degree6("pi/4"), "ratio=1:1.1", checks=1)
    >>> [interval.minima for interval in atlas.intervals], [branch.kind for branch in atlas.branches]
    ([2], ['interior', 'contact-touching'])
    """

    scene: Scene | Pattern
    checks: tuple[SearchCheck, ...]
    family: Family = field(default=None, metadata={"plain": False})  # type: ignore[assignment]
    web: FollowedDiagram | None = field(default=None, metadata={"plain": False})
    example: str = field(default="", metadata={"omit": True})

    ALSO = ("intervals",)

    def __post_init__(self) -> None:
        if self.family is None:  # read from a file
            if self.parameter.name.startswith("loads"):
                raise OptionError("an atlas over forces cannot be read back: follow it anew")
            made = family_of(self.example or self.scene, self.parameter)
            object.__setattr__(self, "family", made)

    @property
    def stopped(self) -> bool:
        """Whether the user (Ctrl-C) ended it, in place of the time."""
        return self.web is not None and self.web.stopped

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """Number and kinds of minima between the values at which they change."""
        ranges = [(min(b.t), max(b.t), b.kind) for b in self.branches if b.stable]
        cuts = sorted(
            {self.parameter.low, self.parameter.high, *(t for r in ranges for t in r[:2])}
        )
        out: list[Interval] = []
        # images of one event under a symmetry of the scene come at one value, up to rounding
        apart = [a for a, b in itertools.pairwise(cuts) if b - a > DUPLICATE_TOL * max(1.0, abs(b))]
        for a, b in itertools.pairwise([*apart, cuts[-1]]):
            middle = 0.5 * (a + b)
            kinds = tuple(sorted(kind for low, high, kind in ranges if low < middle < high))
            begin = out.pop().t[0] if out and out[-1].kinds == kinds else a
            out.append(Interval((begin, b), len(kinds), kinds))
        return tuple(out)

    def at(self, value: float) -> tuple[JudgedState, ...]:
        """Return the states of all branches at one value, polished and judged there.

        Parameters
        ----------
        value
            Of the parameter, in its unit.

        Returns
        -------
        tuple of JudgedState
            Minima and saddles, in order of energy.

        Raises
        ------
        OptionError
            If it is outside what was followed, or the atlas was read from a file.
        """
        parameter = self.parameter
        if self.web is None:
            raise OptionError("an atlas from a file has no states at a value: follow anew")
        if not parameter.low <= value <= parameter.high:
            whole = f"{parameter.low:g} to {parameter.high:g}"
            raise OptionError(f"value = {value:g} is outside what was followed, {whole}")
        return self.web.listed_at(value)

    def origami_at(self, t: float) -> Any:
        """Return what is folded at a value of the parameter.

        Parameters
        ----------
        t
            The value.

        Returns
        -------
        Scene or Pattern
            Whose states those at t are.
        """
        return self.family.scene_of(t)

    @property
    def panels(self) -> list[Plot]:
        """Energy, the fold angle that separates branches best, and contact moments where there are any."""
        over, points = self.parameter, [p for b in self.branches for p in b.points]
        k = int(np.ptp([p.fold_angles for p in points], axis=0).argmax()) if points else 0

        def moment(p: PathPoint) -> float:
            return max((m.multiplier for m in p.multipliers), default=math.nan)

        panels = {"energy [J]": lambda p: p.energy}
        panels[f"fold angle {k + 1} [deg]"] = lambda p: math.degrees(p.fold_angles[k])
        least = STATIONARY * max(self.scene.stiffness)  # below, moments are rounding
        if any(moment(p) > least for p in points):
            panels["largest moment [N m]"] = moment
        place: Any = lambda of: lambda p: (over.drawn(p.t), of(p))  # noqa: E731
        return [Plot(over.axis, y, place(of)) for y, of in panels.items()]

    def report_sections(self) -> Iterator[Section]:
        """Return counts, checks, events, what is not known, and the branches."""
        kept = "symmetric " * self.scene.is_symmetric
        yield self._listed_over(self.intervals, f"{self.scene.title}: {kept}minima")
        yield self._listed_over(self.checks, "Searches (isolated branches between may be missing)")
        yield from self.known_sections()
        if self.interrupted:
            what = "branches and checks are those until then; intervals count what was followed"
            yield Words(f"{'interrupted' if self.stopped else OUT_OF_TIME}: {what}", "bold")
        branches: Any = self._listed_over(self.branches, "Branches")
        yield Details([branches], "Branches")
