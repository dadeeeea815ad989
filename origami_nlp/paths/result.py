"""What a path is, over a parameter or under a load: branches, events, and what is drawn, written and told of both."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, cast

import numpy as np

from origami_nlp.display import (
    Content,
    Report,
    Section,
    Viewable,
    Words,
    angle_columns,
    record_row,
    record_table,
)
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.records import COUNTED, PathBranch, PathEvent, PathPoint
from origami_nlp.pattern_problem import state_frame, states_to_fold


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
            stable = known["kind"] in ("minimum", *COUNTED)
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
