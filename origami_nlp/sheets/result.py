"""What a search for states of a sheet has found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.facets import MOST_DENSE, Sheet
from origami_nlp.files import from_plain, to_plain
from origami_nlp.kkt import State, find_stress
from origami_nlp.minima import (
    JudgedState,
    shallow_words,
    softest_words,
    stability_words,
    survival_words,
)
from origami_nlp.numerics import STATIONARY, rank
from origami_nlp.pattern import Pattern, pattern_from_dict, pattern_to_dict
from origami_nlp.sheets.noise import is_overdetermined, measured_words
from origami_nlp.show import Content, Piece, Table, Told, Turnable, inline_image

if TYPE_CHECKING:
    from typing import Self

WAYS_OUT = "ways out of flat-folded states"
MEETINGS = "ways out of states where curves meet"
OF_VERTEX = "the search for single vertices"
POPS = "minima with a vertex popped"
BARRIERS = "escape barriers"
"""Parts of a search that its time may end."""


@dataclass(frozen=True)
class SheetSearch:
    """What was enumerated, what was sampled, what ended open.

    Attributes
    ----------
    starts
        In all.
    open
        Starts that could not be closed within the fold limits: never reported.
    flat
        Starts that fell back into the flat state.
    unfinished
        Descents that did not arrive.
    lines, families
        Ways out of the flat state that were enumerated: with one freedom, with more.
    flat_folded
        States with every crease open or shut, the flat one among them, all ways out of which were gone.
    crossroads
        Other states at which curves meet, found along curves, all ways out of which were gone.
    not_enumerated
        What of these was not enumerated, and why; empty where all were.
    curves, complete
        Curves of states with one freedom that are known; how many of them from limit to limit, or round.
    not_traced
        Starts whose curves were not traced any more: descents began there instead.
    outside
        Of the curves, those that only random starts led to.
    unclear
        Parts of steps along curves in which facets may touch and part again unseen.
    drawn, since
        Random starts; how many of them were made since one led to a new minimum or curve.
    pressed
        Descents into contact, from where descents that let facets cross ended in crossing.
    refused
        Of those, what became of the ones that did not arrive: limits on time, pairs of facets, creases, or steps.
    of_vertex
        Minima that the search for single vertices found, where there is but one.
    popped, by_pops
        Starts from minima with one vertex popped, its folds turned over; minima that they led to.
    wells, resolved
        Wells of the energy along the curves that are known; how many of them were judged: the descent arrived, or the
        stationary state beside the well was solved for, and it is a minimum, none, or one in which facets cross.
    coarse
        Of the curves, those whose polynomials are further from closed states than they are meant to be.
    failed
        Starts, wells and parts of the search that linear algebra did not get through, each with its reason.
    left_out
        Parts of the search that its time, or an interruption, ended: what they had found before is listed.
    interrupted
        Whether the user did.
    """

    starts: int
    open: int
    flat: int
    unfinished: int
    lines: int
    families: int
    flat_folded: int
    crossroads: int
    not_enumerated: str
    curves: int
    complete: int
    not_traced: int
    outside: int
    unclear: int
    drawn: int
    since: int
    pressed: int = 0
    refused: tuple[str, ...] = ()
    of_vertex: int = 0
    popped: int = field(default=0, repr=False)
    by_pops: int = field(default=0, repr=False)
    wells: int = field(default=0, repr=False)
    resolved: int = field(default=0, repr=False)
    coarse: int = field(default=0, repr=False)
    failed: tuple[str, ...] = field(default=(), repr=False)
    left_out: tuple[str, ...] = ()
    interrupted: bool = field(default=False, repr=False)

    def words(self) -> Iterator[str]:
        """Say it."""
        if self.left_out:
            why = "interrupted" if self.interrupted else OUT_OF_TIME
            yield f"{why}, not through with: {', '.join(self.left_out)}"
        if self.lines or self.families:
            what = "family" if self.families == 1 else "families"
            more = f" and {self.families} {what} with more freedoms" if self.families else ""
            yield f"ways out of the flat state: all enumerated, {self.lines} with one freedom{more}"
        if self.flat_folded > 1:
            ways = "" if WAYS_OUT in self.left_out else ", and the ways out of each"
            yield f"flat-folded states: {self.flat_folded} enumerated{ways}"
        if self.crossroads:
            ways = "" if MEETINGS in self.left_out else ", and the ways out of each"
            yield f"states where curves meet others: {self.crossroads} found along curves{ways}"
        if self.not_enumerated:
            yield self.not_enumerated
        if self.curves:
            yield from self._of_curves()
        yield (
            f"{self.starts} starts: {self.open} could not be closed, {self.flat} fell back flat, "
            f"{self.unfinished} descents did not arrive"
        )
        if self.of_vertex:
            what = "minimum" if self.of_vertex == 1 else "minima"
            yield (
                f"one vertex: {self.of_vertex} {what} of the search for single vertices, judged as states of the sheet"
            )
        if self.pressed:
            what = "descent" if self.pressed == 1 else "descents"
            yield f"contact: {self.pressed} {what} along states that do not cross"
            for why, many in Counter(self.refused).items():
                yield f"not decided: {many} of them gave up, {why}"
        for why, many in Counter(self.failed).items():
            yield f"not decided: linear algebra failed {many} time{'s' * (many != 1)}, {why}"
        if self.resolved < self.wells:
            open_ = self.wells - self.resolved
            yield f"not decided: {open_} of {self.wells} wells of the energy along these curves"
        lost = self.curves != self.complete or self.coarse or self.resolved < self.wells
        if self.curves and not (lost or self.not_traced or self.left_out or self.failed):
            yield (
                f"every well of the energy along these curves was judged, {self.wells} in all; other curves are "
                "sampled only"
            )
        else:
            yield "sampled, not exhausted: there may be further states"
        if self.since:
            yield (
                f"the last {self.since} of {self.drawn} drawn starts found no other minimum: those not found draw less "
                f"than {min(1.0, 3 / self.since):.2g} of such starts (95 %)"
            )
        elif self.drawn:
            yield "the last drawn start found another minimum or curve: draw more (starts)"
        if self.popped:
            what = "minimum" if self.by_pops == 1 else "minima"
            new = f"{self.by_pops} further {what}" if self.by_pops else "no further minimum"
            yield f"{self.popped} starts from minima with one vertex popped: {new}"

    def _of_curves(self) -> Iterator[str]:
        lost = self.curves - self.complete
        yield (
            f"one freedom: {self.curves} curve{'s' * (self.curves != 1)} traced"
            + (
                f", {lost} of them lost on the way"
                if lost
                else (", each to its ends" if self.curves != 1 else " to its ends")
            )
            + (f"; {self.outside} of them known from random starts only" if self.outside else "")
            + (f"; {self.not_traced} starts on others" if self.not_traced else "")
        )
        if self.unclear:
            yield "in parts of steps along them facets may touch and part again unseen"


@dataclass(frozen=True, eq=False, repr=False)
class SheetResult(Told, Turnable):
    """States of a sheet.

    Attributes
    ----------
    pattern
        The pattern.
    states
        All that was judged, by energy: minima, and what crosses or is undecided.
    search
        How they were looked for.
    curves
        Those with one freedom that were traced; none of a result that was read from a file.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_minima(o.examples.pattern("metasheet", 2, 3), starts=4)
    >>> found.search.starts >= 4
    True
    """

    pattern: Pattern
    states: tuple[JudgedState, ...] = field(repr=False)
    search: SheetSearch
    curves: tuple[Any, ...] = field(default=(), repr=False)

    PICTURE, SCHEMA = "draw_found", "origami_nlp/minima/1"

    def turned(self) -> Content:
        """Return its stable states as plain data, see `view`."""
        content: Content = self._from_room("turn_found")(self)  # slow to import
        return content

    @cached_property
    def problem(self) -> Sheet:
        """The programme that its states are states of."""
        return Sheet(self.pattern)

    def state_of(self, state: JudgedState) -> State:
        """Return a state as one of the programme.

        Parameters
        ----------
        state
            One of `states`.

        Returns
        -------
        State
            With its contacts, multipliers and curvature.
        """
        return State(self.problem, state.phi)

    @property
    def minima(self) -> tuple[JudgedState, ...]:
        """Certified minima, by energy."""
        return self._with("minimum")

    @property
    def undecided(self) -> tuple[JudgedState, ...]:
        """States that are stationary as far as could be told, without a certificate."""
        return self._with("undecided")

    @property
    def crossing(self) -> tuple[JudgedState, ...]:
        """States in which facets pass through each other: no states of paper."""
        return self._with("not admissible")

    def _with(self, verdict: str) -> tuple[JudgedState, ...]:
        return tuple(s for s in self.states if s.verdict == verdict)

    def _stressed(self, state: JudgedState) -> dict[str, Any]:
        """Return a state as plain data, with what closure carries in it."""
        rows = 3 * len(self.pattern.vertices) + 6 * len(self.pattern.holes)
        data = {**to_plain(state), "self_stress": rows - self.pattern.creases + state.freedoms}
        if self.pattern.creases > MOST_DENSE or not all(c.is_limit for c in state.contacts):
            return data
        held = [c.creases[0] - 1 for c in state.contacts]
        stress = find_stress(State(Sheet(self.pattern), state.phi), held)
        return {
            **data,
            "multipliers": stress.multipliers.tolist(),
            "closure_torques": stress.torque.tolist(),
            "closure_torques_unique": stress.unique,
        }

    def table(self) -> Table:
        """Return the minima as a table."""
        rows = []
        noise = any(s.survival is not None for s in self.minima)
        for k, s in enumerate(self.minima, 1):
            barrier = s.escape.words() if s.escape else "-"
            barrier += ", shallow" * s.shallow
            limits = [k for c in s.contacts for k in c.creases]
            touched = dict.fromkeys(c.facets for c in s.contacts if not c.is_limit)
            pairs = [f"{a}|{b}" for a, b in touched]
            more = ", ..." if len(pairs) > 3 else ""
            words = [f"facets {', '.join(pairs[:3])}{more} touch"] if pairs else []
            if limits:
                shown = ", ".join(map(str, limits[:3])) + (", ..." if len(limits) > 3 else "")
                words.append(f"fold limit of {shown}")
            touching = "; ".join(words)
            cells = [f"{s.energy:.10g}", str(s.kind), str(s.freedoms), softest_words(s.softest)]
            rows.append([str(k), *cells, barrier, *[str(s.survival)] * noise, touching])
        heads = ["state", "energy", "kind", "freedoms", "softest", "barrier"]
        heads += [*["survives"] * noise, "contacts"]
        return Table(heads, rows, title=self._title(), columns=f"lrlrrr{'r' * noise}l")

    def _title(self) -> str:
        shallow = sum(s.shallow for s in self.minima)
        many = len(self.minima) - shallow
        name = f"{self.pattern.name}: " if self.pattern.name else ""
        return f"{name}{many} stable state{'s' * (many != 1)}{shallow_words(shallow)}"

    def told(self) -> Iterable[Piece]:
        """Say what was found, what was not decided, and how it was looked for."""
        yield self.table() if self.minima else self._title()
        for k, state in enumerate(self.minima, 1):
            touches = [c.words() for c in state.contacts if not c.is_limit]
            if state.escape is not None:
                forces = [c.force for c in state.contacts]
                isolated = state.local_dimension == 0
                words = stability_words(state.softest, forces, isolated, state.escape)
                yield f"state {k}: {words}"
            if touches:
                yield f"state {k} touches: " + "; ".join(touches)
        yield from self._survivals()
        for s in self.crossing:
            yield f"energy {s.energy:.6g}: no state of paper, {s.certificate}"
        for s in self.undecided:
            yield f"energy {s.energy:.6g}: {s.certificate}"
        yield from self.search.words()
        rows = 3 * len(self.pattern.vertices) + 6 * len(self.pattern.holes)
        balanced = [s for s in self.minima if s.kkt_residual <= 10 * STATIONARY]
        spare = sorted({rows - self.pattern.creases + s.freedoms for s in balanced})
        if spare and spare[-1]:
            many = " or ".join(map(str, spare))
            where = (
                " where closure balances the springs" if len(balanced) < len(self.minima) else ""
            )
            yield (
                f"states of self-stress{where}: {many}; torques about creases are unique, moments across creases "
                "are not (rigid facets leave them open)"
            )
        yield "modelled: rigid facets without thickness, springs at creases; the way to a state may cross"

    def _survivals(self) -> Iterator[str]:
        """Say what the column of survivals counts."""
        degrees = next((s.survival.degrees for s in self.minima if s.survival), None)
        if degrees is None:
            return
        yield survival_words(degrees, measured_words(self.pattern))
        if is_overdetermined(self.pattern):
            yield (
                "closure has as many equations as there are creases, and with errors of positions rigid facets do not "
                'fold: "springs" counts draws that are survived with errors of rest angles and stiffnesses alone'
            )

    def _repr_html_(self) -> str:
        """Return what is told, and the minima drawn, for Jupyter."""
        told = super()._repr_html_()
        if not self.minima:
            return told
        return f"{told}\n{inline_image(self.draw(), 'stable states of the sheet', 75)}"

    def _to_plain(self) -> dict[str, Any]:
        return {
            "pattern": pattern_to_dict(self.pattern),
            "minima": [self._stressed(s) for s in self.minima],
            "undecided": to_plain(self.undecided),
            "crossing": to_plain(self.crossing),
            "refuted": to_plain([s for s in self.states if s.refuted]),
            "search": to_plain(self.search),
        }

    @classmethod
    def _from_plain(cls, data: dict[str, Any]) -> Self:
        stressed = ("self_stress", "multipliers", "closure_torques", "closure_torques_unique")
        states: list[JudgedState] = []
        for key in ("minima", "undecided", "crossing", "refuted"):
            listed = from_plain(tuple[dict[str, Any], ...], data[key], at=key)
            own = [{k: v for k, v in s.items() if k not in stressed} for s in listed]
            states += from_plain(tuple[JudgedState, ...], own, at=key)
        pattern = pattern_from_dict(data["pattern"])
        scale = float(pattern.stiffness.mean()) if pattern.creases else 1.0
        by_energy = tuple(sorted(states, key=lambda s: rank(s.energy / scale, ())))
        return cls(pattern, by_energy, from_plain(SheetSearch, data["search"], at="search"))

    def _rows(self) -> Iterable[Mapping[str, object]]:
        for s in self.minima:
            row = to_plain(s)
            angles = {f"phi_{i + 1}": a for i, a in enumerate(row.pop("fold_angles"))}
            yield {**{k: v for k, v in row.items() if not isinstance(v, list)}, **angles}
