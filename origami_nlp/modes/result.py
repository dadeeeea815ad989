"""Modes of minima: numbers, words and plain data.

Angles in radians, energies and eigenvalues in the scene's units.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.display import Report, Section, Table, angle_columns
from origami_nlp.io import ShortRepr
from origami_nlp.minima import JudgedState, MinimaResult
from origami_nlp.modes.geodesic import Geodesic

BREAKING = "breaking"


@dataclass(frozen=True, repr=False)
class Mode(ShortRepr):
    """One eigenvector of the reduced Hessian, and the energy along it.

    Attributes
    ----------
    eigenvalue
        Second derivative of the energy per unit length in the space of all N fold angles [N m/rad].
    direction
        Unit change of the N fold angles, the largest entry positive, [N].
    block
        ``symmetric`` or ``breaking``; empty without an imposed symmetry.
    keeps
        Which elements of the symmetry it keeps, in words.
    along
        The geodesic that leaves the state that way: energy over distance, and what ends it.
    """

    eigenvalue: float
    direction: np.ndarray
    block: str
    keeps: str
    along: Geodesic


@dataclass(frozen=True, repr=False)
class StateModes(ShortRepr):
    """The modes of one minimum.

    Attributes
    ----------
    number
        Of the minimum (1-based).
    minimum
        The minimum.
    held
        Names of the loaded contacts, which stay closed.
    modes
        In order of eigenvalues, symmetric ones first.
    coupling
        Largest entry of the Hessian between symmetric and breaking directions [N m/rad]: rounding.
    why
        Why there are none; empty where there are.
    """

    number: int
    minimum: JudgedState
    held: tuple[str, ...]
    modes: tuple[Mode, ...]
    coupling: float
    why: str

    def eigenvalues(self, block: str = "") -> tuple[float, ...]:
        """Return those of one block, or all, rising [N m/rad].

        Parameters
        ----------
        block
            ``symmetric``, ``breaking``, or empty for all.
        """
        return tuple(sorted(m.eigenvalue for m in self.modes if block in ("", m.block)))


@dataclass(frozen=True, repr=False)
class Modes(Report):
    """How the minima of a vertex or a pattern give way.

    Attributes
    ----------
    result
        All minima.
    states
        Modes of those that were looked at.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_modes(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), state=1)
    >>> [round(value, 5) for value in found.states[0].eigenvalues("breaking")]
    [0.25223]
    """

    result: MinimaResult
    states: tuple[StateModes, ...]

    PICTURE = "draw_modes"
    SCHEMA = "origami-nlp/modes/2"

    @property
    def label(self) -> str:
        """Whose minima these are."""
        return self.result.title

    def table(self) -> Table:
        """Return one row a mode: eigenvalue, how far to the first contact each way, and the energy there."""
        rows = []
        for state in self.states:
            for k, mode in enumerate(state.modes, start=1):
                low, high = mode.along.ends
                rows.append(
                    [
                        f"#{state.number}.{k}",
                        mode.block or "all",
                        f"{mode.eigenvalue:.6g}",
                        f"{low.s:.4g} .. {high.s:.4g}",
                        f"{low.rise:.4g}, {high.rise:.4g}",
                    ]
                )
        heads = ["mode", "block", "eigenvalue [N m/rad]", "to contact [rad]", "rise there [J]"]
        title = f"{self.label}: energy along the modes of {len(self.states)} minima"
        return Table(heads, rows, title, "llrrr")

    def report_sections(self) -> Iterator[Section]:
        """Return the table, and for each mode its direction and what ends it."""
        yield self.table()
        for state in self.states:
            if state.held:
                yield f"#{state.number} held closed: " + "; ".join(state.held)
            if state.why:
                yield f"#{state.number} has no modes: {state.why}"
                continue
            for k, mode in enumerate(state.modes, start=1):
                d = " ".join(f"{v:6.3f}" for v in np.round(mode.direction, 3) + 0.0)
                yield f"#{state.number}.{k} along {d}" + (f": {mode.keeps}" if mode.keeps else "")
                low, high = mode.along.ends
                yield f"   ends: backward {low.why}; forward {high.why}"
            if any(m.block == BREAKING for m in state.modes):
                yield (
                    f"   between symmetric and breaking modes: {state.coupling:.1e} N m/rad (rounding)"
                )

    def _rows(self) -> Iterator[dict[str, object]]:
        for state in self.states:
            for k, mode in enumerate(state.modes, start=1):
                low, high = mode.along.ends
                row: dict[str, object] = {"scene": self.label, "minimum": state.number, "mode": k}
                row |= {"block": mode.block, "eigenvalue_N_m_per_rad": mode.eigenvalue}
                row |= {"backward_rad": low.s, "forward_rad": high.s}
                row |= {"backward_rise_J": low.rise, "forward_rise_J": high.rise}
                changes = angle_columns(mode.direction)  # a unit vector, without a unit
                yield row | {f"d_{name.removesuffix('_rad')}": v for name, v in changes.items()}
