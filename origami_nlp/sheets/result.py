"""What a search for states of a sheet has found."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from origami_nlp.facets import MOST_DENSE, Sheet
from origami_nlp.files import from_plain, to_plain
from origami_nlp.kkt import State, find_stress
from origami_nlp.minima import (
    FoundMinima,
    JudgedState,
    Part,
    shallow_words,
    state_lines,
    survival_words,
    undecided_lines,
)
from origami_nlp.numerics import STATIONARY
from origami_nlp.pattern import Pattern, pattern_from_dict, pattern_to_dict
from origami_nlp.sheets.account import SheetSearch
from origami_nlp.sheets.fold_out import sheet_frame, sheet_parts, sheet_to_fold
from origami_nlp.sheets.noise import is_overdetermined, measured_words
from origami_nlp.show import Content, Piece, inline_image

if TYPE_CHECKING:
    from typing import Self


@dataclass(frozen=True, eq=False, repr=False)
class SheetResult(FoundMinima):
    """States of a sheet.

    Attributes
    ----------
    pattern
        The pattern.
    minima
        Certified minima, by energy.
    search
        How they were looked for, and the states that are no minima or not decided.
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
    minima: tuple[JudgedState, ...] = field(repr=False)
    search: SheetSearch
    curves: tuple[Any, ...] = field(default=(), repr=False)

    PICTURE, SCHEMA = "draw_found", "origami-nlp/minima/1"

    def turned(self) -> Content:
        """Return its stable states as plain data, see `view`."""
        content: Content = self._from_room("turn_found")(self)  # slow to import
        return content

    @cached_property
    def model(self) -> Sheet:
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
        return State(self.model, state.phi)

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

    _LAST = ("contacts",)
    _COLUMNS = "l"

    @property
    def name(self) -> str:
        """Of the pattern."""
        return self.pattern.name

    @property
    def headline(self) -> str:
        """What is folded, and how many stable states there are."""
        shallow = sum(s.shallow for s in self.minima)
        many = len(self.minima) - shallow
        name = f"{self.name}: " if self.name else ""
        return f"{name}{many} stable state{'s' * (many != 1)}{shallow_words(shallow)}"

    def _last_cells(self, minimum: JudgedState) -> list[str]:
        """Return which facets touch, and which creases are at their fold limit."""
        limits = [str(k) for c in minimum.contacts for k in c.creases]
        touched = dict.fromkeys(c.facets for c in minimum.contacts if not c.is_limit)
        words = [f"facets {_few([f'{a}|{b}' for a, b in touched])} touch"] * bool(touched)
        words += [f"fold limit of {_few(limits)}"] * bool(limits)
        return ["; ".join(words)]

    def to_fold(self) -> dict[str, Any]:
        """Return the states as FOLD data."""
        frames = (
            sheet_frame(self.pattern, m.phi, m.title(k), **m.frame_entries())
            for k, m in enumerate(self.minima, start=1)
        )
        return sheet_to_fold(self.pattern, frames)

    def mesh_parts(self) -> list[Part]:
        """Return the states side by side as triangles."""
        return sheet_parts(self.pattern, [m.phi for m in self.minima])

    def told(self) -> Iterable[Piece]:
        """Say what was found, what was not decided, and how it was looked for."""
        yield self.table() if self.minima else self.headline
        yield from state_lines(self)
        yield from self._survivals()
        for s in self.crossing:
            yield f"energy {s.energy:.6g}: no state of paper, {s.certificate}"
        yield from undecided_lines(self.search)
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
            "search": to_plain(self.search),
        }

    @classmethod
    def _from_plain(cls, data: dict[str, Any]) -> Self:
        stressed = ("self_stress", "multipliers", "closure_torques", "closure_torques_unique")
        listed = from_plain(tuple[dict[str, Any], ...], data["minima"], at="minima")
        own = [{k: v for k, v in m.items() if k not in stressed} for m in listed]
        minima = from_plain(tuple[JudgedState, ...], own, at="minima")
        search = from_plain(SheetSearch, data["search"], at="search")
        return cls(pattern_from_dict(data["pattern"]), minima, search)


def _few(names: Sequence[str]) -> str:
    return ", ".join([*names[:3], *["..."] * (len(names) > 3)])
