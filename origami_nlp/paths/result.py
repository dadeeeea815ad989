"""What paths are, over a parameter or under a load: branches, events, legs and snaps; as they are told and written."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, cast

import numpy as np

from origami_nlp.display import (
    Content,
    Details,
    Report,
    Section,
    Viewable,
    Words,
    angle_columns,
    record_row,
    record_table,
)
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.minima import JudgedState, Part
from origami_nlp.numerics import DUPLICATE_TOL, INPUT_TOL, STATIONARY
from origami_nlp.paths.driver import Driver
from origami_nlp.paths.family import Family, family_of
from origami_nlp.paths.followed import FollowedDiagram
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.records import (
    COLLAPSE,
    COUNTED,
    Interval,
    Leg,
    PathBranch,
    PathEvent,
    PathPoint,
    SearchCheck,
    Snap,
)
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.pattern_problem import state_frame, state_parts, states_to_fold


class Track(NamedTuple):
    """States of a path in order: a branch, or a leg of a load, and what they are."""

    word: str
    id: int
    points: Sequence[PathPoint]
    kind: str


class Plot(NamedTuple):
    """Axes over which the states of a path are drawn: labels, and the place of a state."""

    x: str
    y: str
    place: Callable[[PathPoint], tuple[float, float]]

    def values(self, points: Iterable[PathPoint | None]) -> np.ndarray:
        """Return the places of points, [m, 2], nan of those that are left out."""
        return np.array([self.place(p) if p else (math.nan, math.nan) for p in points])


@dataclass(frozen=True, eq=False, repr=False)
class Path(Report, Viewable):
    """States that were followed over a parameter, or under a load.

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
    """

    parameter: ParameterRange
    branches: tuple[PathBranch, ...]
    events: tuple[PathEvent, ...]
    alarms: tuple[str, ...]
    steps: int
    interrupted: bool

    PICTURE, SCHEMA = "draw_path", "origami-nlp/path/2"

    @property
    def curves(self) -> list[Track]:
        """What is listed point by point: the branches."""
        return [Track("branch", b.id, b.points, b.kind) for b in self.branches]

    @property
    def panels(self) -> list[Plot]:
        """The axes over which it is drawn."""
        raise NotImplementedError

    @property
    def span(self) -> tuple[float, float]:
        """The range of the parameter that is drawn."""
        return self.parameter.low, self.parameter.high

    def origami_at(self, t: float) -> Any:
        """Return what is folded at a value of the parameter, without the load of the path.

        Parameters
        ----------
        t
            The value.

        Returns
        -------
        Scene or Pattern
            Whose states those at t are.
        """
        raise NotImplementedError

    def point_of(self, event: PathEvent) -> PathPoint:
        """Return an event as a point, by the nearest one of its branches, or of all curves.

        Parameters
        ----------
        event
            Of this path.

        Returns
        -------
        PathPoint
            With the energy and the moments there.
        """
        own = [p for b in self.branches if b.id in event.branches for p in b.points]
        phi = np.array(event.fold_angles)
        near = min(
            own or [p for curve in self.curves for p in curve.points],
            key=lambda p: abs(p.t - event.t) + float(np.abs(phi - p.fold_angles).max()),
        )
        return replace(near, t=event.t, fold_angles=event.fold_angles)

    def known_sections(self) -> Iterator[Section]:
        """Return the events, what is not known, and the number of steps: the end of each report."""
        # digits that are not sure are not printed
        sure = (e if e.located else replace(e, t=float(f"{e.t:.6g}")) for e in self.events)
        yield self._listed_over(sure, "Events")
        yield from (Words(line, "bold") for line in self.alarms)
        yield Words(f"{self.steps} steps", "dim")

    def _listed_over(self, records: Iterable[Any], title: str) -> Section:
        """Return records as a table, with values of the parameter as axes have them, angles in degrees."""
        over, drawn = self.parameter, list[Any]()
        for one in records:
            t = tuple(map(over.drawn, one.t)) if isinstance(one.t, tuple) else over.drawn(one.t)
            drawn.append(replace(one, t=t))
        return listed(drawn, f"{title} over {over.axis}")

    def view_content(self) -> Content:
        """Return curves and marks as plain data, see `view`."""
        return cast(Content, self._from_room("view_path")(self))  # bodies are slow to import

    def _listed(self) -> Iterator[tuple[dict[str, Any], PathPoint]]:
        """Yield every point with the number of its curve and what it is."""
        for curve in self.curves:
            yield from (({curve.word: curve.id, "kind": curve.kind}, p) for p in curve.points)

    def _rows(self) -> Iterator[dict[str, object]]:
        over = {"parameter": self.parameter.name, "unit": self.parameter.unit}
        for known, p in self._listed():
            stable = known["kind"] in ("minimum", *COUNTED) and not p.full_space_eigenvalue < 0
            row = over | known | {"stable": stable} | record_row(p)
            yield row | angle_columns(p.fold_angles)

    def to_fold(self) -> dict[str, Any]:
        """Return all points as FOLD data (spec 1.1), one frame each, in order."""
        frames, over = [], self.parameter
        for known, p in self._listed():
            title = f"{over.name} = {p.t:.9g}, " + ", ".join(f"{k} {v}" for k, v in known.items())
            more = known | {"parameter": p.t, "energy": p.energy}
            frames.append(state_frame(self.origami_at(p.t), p.fold_angles, title, **more))
        return states_to_fold(self.origami_at(over.low), frames)


def listed(records: Sequence[Any], title: str) -> Section:
    """Return records as a table, or its title alone."""
    return record_table(records, title, narrow=True) if records else title


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
    ([2], ['interior', 'interior', 'contact-touching', 'contact-touching'])
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


@dataclass(frozen=True, eq=False, repr=False)
class LoadPath(Path):
    """A state of a vertex or of a pattern under a load that grows, through contacts and snaps.

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
    driver
        What the load is: its `name`, its `unit`, and the `coordinate` that it works on.
    state
        Number (1-based) of the unloaded minimum that is loaded; 0 where it was given itself.
    legs, snaps
        What the state does, in order.
    plastic_work
        What hinges that yield have taken [J].

    Examples
    --------
    >>> import origami_nlp as o
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=-0.15)
    >>> [round(snap.t, 6) for snap in path.snaps], [leg.why for leg in path.legs]
    ([-0.13815], ['snap', 'range'])
    >>> sheet = o.examples.pattern("miura", 2, 3).with_springs(0.01, 1.2)
    >>> path = o.load_path(sheet, 2, to=0.02)
    >>> [leg.why for leg in path.legs], len(path.snaps)
    (['range'], 0)
    """

    driver: Driver
    state: int
    legs: tuple[Leg, ...]
    snaps: tuple[Snap, ...]
    plastic_work: float = 0.0

    ALSO = ("dissipated", "start_stiffness", "stiffness_unit")

    def origami_at(self, t: float) -> Any:
        """Return what is loaded, without the load.

        Parameters
        ----------
        t
            The value.

        Returns
        -------
        Scene or Pattern
            Whose states those at t are.
        """
        return self.driver.unloaded

    @property
    def dissipated(self) -> float:
        """Energy lost in all snaps and to yielding [J]; over a closed cycle the area of the hysteresis loop."""
        return sum(snap.released for snap in self.snaps) + self.plastic_work

    @property
    def start_stiffness(self) -> float:
        """Stiffness of the state that is loaded, against the load, see `Leg`."""
        return self.legs[0].stiffness if self.legs else math.nan

    @property
    def stiffness_unit(self) -> str:
        """The unit of `start_stiffness`, of the load over what it works on."""
        return f"{self.driver.unit or 1}/{self.place.unit}"

    @property
    def place(self) -> ParameterRange:
        """What the load works on, as it is shown."""
        name, _, unit = self.driver.coordinate[:-1].rpartition(" [")
        return ParameterRange(name, -math.inf, math.inf, unit, False)

    @property
    def curves(self) -> list[Track]:
        """The legs: stable states."""
        each = [leg.points for leg in self.legs]
        return [Track("leg", k, p, "minimum") for k, p in enumerate(each, start=1)]

    def point_at(self, t: float, fold_angles: Sequence[float]) -> PathPoint:
        """Return a state as a point.

        Parameters
        ----------
        t
            The load.
        fold_angles
            All N [rad].

        Returns
        -------
        PathPoint
            With its energy and what the load works on.
        """
        phi = np.array(fold_angles)
        energy, angle = float(self.driver.unloaded.energy(phi)), float(self.driver.conjugate(phi))
        return PathPoint(t, tuple(fold_angles), energy, (), math.nan, math.nan, angle)

    @property
    def panels(self) -> list[Plot]:
        """Load and energy over what the load works on, energy over the load."""
        load, energy, place = self.parameter.axis, "energy without the load [J]", self.place
        return [
            Plot(place.axis, load, lambda p: (place.drawn(p.angle), p.t)),
            Plot(place.axis, energy, lambda p: (place.drawn(p.angle), p.energy)),
            Plot(load, energy, lambda p: (p.t, p.energy)),
        ]

    @property
    def span(self) -> tuple[float, float]:
        """The loads of the path, not far beyond its last event."""
        loads = [t for leg in self.legs for t in leg.t] or [0.0]
        low, high = min(loads), max(loads)
        events = [0.0, *(e.t for e in self.events if low <= e.t <= high)]
        more = 0.3 * (max(events) - min(events)) or high - low
        low, high = max(low, min(events) - more), min(high, max(events) + more)
        room = 0.1 * (high - low) or 1.0
        return low - room, high + room

    def report_sections(self) -> Iterator[Section]:
        """Return what the state does: legs, snaps, events; and what is not known."""
        place, unit = self.place.stated, self.stiffness_unit
        yield listed(self.legs, f"{self.verdict}\nLegs over {place}, stiffness [{unit}]")
        if self.snaps:
            yield listed(self.snaps, f"Snaps, over {place}")
        angles = [p.angle for leg in self.legs for p in leg.points]
        if len(angles) > 1 and np.ptp(angles) <= INPUT_TOL * self.driver.work.arm:
            yield "the load does no work"
        if self.plastic_work:
            yield f"plastic work {self.plastic_work:.6g} J"
        if self.driver.scene is None:
            yield "crossing of facets is checked at the states of the path and of descents, not between them"
        yield from self.known_sections()

    @property
    def verdict(self) -> str:
        """What the state does under the load, in a sentence."""
        unit, title = f" {self.driver.unit}".rstrip(), self.driver.origami.title
        state = f"state #{self.state}" if self.state else "a state"
        does, at = "does not snap, loaded to", [leg.t[1] for leg in self.legs if leg.why == "range"]
        if self.legs and self.legs[-1].why == COLLAPSE:
            does, at = "collapses, as hinges yield, at", [self.legs[-1].t[1]]
        elif self.snaps:
            does, at = "snaps at", [snap.t for snap in self.snaps]
        loads = " and ".join(f"{t:.6g}" for t in at) or "0"
        lost = f", losing {self.dissipated:.6g} J" * bool(self.snaps)
        return f"{title}: {state} under {self.driver.name} {does} {loads}{unit}{lost}"

    def mesh_parts(self) -> list[Part]:
        """Return the states at which each leg begins and ends, side by side as triangles."""
        ends = dict.fromkeys(leg.points[k].fold_angles for leg in self.legs for k in (0, -1))
        return state_parts(self.driver.origami, [np.array(phi) for phi in ends])
