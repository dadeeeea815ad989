"""Which hinge laws hold given states: sums of laws of a library on each crease, convex as with springs.

Laws side by side on one crease add, so that torques and stiffnesses are linear in their weights a >= 0: balance and
curvature of each state are the rows of `Balance`, with a column for each law of each kind of crease.  With linear
springs of several rest angles as the library this is the design of springs.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.convex import LARGEST_MARGIN, ConvexDesign, reach_of_multipliers
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.io import read_toml
from origami_nlp.numerics import (
    DEFINITE,
    DESIGN_MARGIN,
    EQUAL,
    POSITIVE,
    ConicProgram,
    ConicSolution,
    smatrix,
)
from origami_nlp.pattern import HingeLaw, linear, read_law, well

LARGEST = 1_000_000
"""Bytes of a file."""
USED = 1e-9
"""Of the weight that would make all of the mean stiffness: less of a law is none of it."""
LEAST_SHARE = 1e-3
"""Of the mean stiffness: what each crease has at least, as it is to have a law."""
KEPT = 0.5
"""Share of the largest margin that a design with the fewest wells keeps."""
MOST_CUTS = 60
"""Programs with integers that are solved in turn."""


def wells_library(
    spacing: float = math.pi / 6, width: float = math.radians(20)
) -> dict[str, HingeLaw]:
    """Return the built-in library: springs that rest at -90, 0 and 90 degrees, and Gaussian wells.

    Parameters
    ----------
    spacing
        Of the wells, from -150 to 150 degrees by default [rad].
    width
        Their standard deviation [rad].

    Returns
    -------
    dict
        Laws by name, of unit stiffness or energy.
    """
    springs = {f"spring at {a}": linear(1.0, math.radians(a)) for a in (-90, 0, 90)}
    count = math.ceil(round(math.pi / spacing, 6)) - 1
    at = spacing * np.arange(-count, count + 1)
    wells = {f"well at {math.degrees(a):.4g}": well(1.0, float(a), width) for a in at}
    return springs | wells


def read_library(source: str | Path) -> dict[str, HingeLaw]:
    """Read a library from a TOML file: tables ``[laws.NAME]`` as in scene files, of unit size.

    Parameters
    ----------
    source
        The file; data of laws are relative to it.

    Returns
    -------
    dict
        Laws by name.

    Raises
    ------
    OptionError, SceneError
        If the file cannot be read, or has anything but laws.
    """
    data = read_toml(source, LARGEST, "library", OptionError)
    stated = data.get("laws")
    if set(data) != {"laws"} or not isinstance(stated, Mapping) or not stated:
        raise OptionError(f"library {str(source)!r}: give tables [laws.NAME] and nothing else")
    return {name: read_law(one, name, Path(source).parent) for name, one in stated.items()}


@dataclass(frozen=True)
class _Weights:
    """Where the weights of laws are among the unknowns, kind by kind, then the margin."""

    laws: tuple[HingeLaw, ...]
    kinds: int

    @property
    def margin(self) -> int:
        return self.kinds * len(self.laws)

    @property
    def size(self) -> int:
        return self.margin + 1

    def _spread(self, values: np.ndarray, kind: np.ndarray, columns: int) -> np.ndarray:
        out, j = np.zeros((len(kind), columns)), len(self.laws)
        for row, k in enumerate(kind):
            out[row, k * j : (k + 1) * j] = values[:, row]
        return out

    def torques(self, x: np.ndarray, kind: np.ndarray, columns: int) -> np.ndarray:
        return self._spread(np.array([law.torque(x) for law in self.laws]), kind, columns)

    def slopes(self, x: np.ndarray, kind: np.ndarray, columns: int) -> np.ndarray:
        return self._spread(np.array([law.slope(x) for law in self.laws]), kind, columns)


class LibraryProgram(ConvexDesign):
    """The convex program of a question, over weights of laws.

    Parameters
    ----------
    targets
        The question.
    laws
        The library.
    loose
        See `ConvexDesign`.
    without
        Numbers of weights that are 0.
    """

    def __init__(
        self,
        targets: Targets,
        laws: Sequence[HingeLaw],
        loose: bool = False,
        without: Collection[int] = (),
    ) -> None:
        self.targets, self.touching, self.loose = targets, frozenset(), loose
        self.laws = tuple(laws)
        kinds = int(targets.kinds.max()) + 1
        self.count = np.bincount(targets.kinds, minlength=kinds)
        # columns of one size: what is sought are shares of the mean stiffness
        self.stiff = np.array([law.stiffness for law in laws])
        unit = tuple(law.times(1 / k) for law, k in zip(laws, self.stiff, strict=True))
        self.places: Any = _Weights(unit, kinds)
        self.problem = ConicProgram(self.places.size)
        self.balances = []
        size, margin = self.places.size, self.places.margin
        mean = np.append(np.repeat(self.count, len(laws)).astype(float), 0.0)
        self.problem.add(EQUAL, mean, -float(self.count.sum()), "the mean stiffness is 1")
        eye = np.eye(size)
        self.problem.add(POSITIVE, eye[:margin], np.zeros(margin), "weights of laws")
        each = np.kron(np.eye(kinds), np.ones(len(laws)))
        least = np.pad(each, ((0, 0), (0, 1)))
        self.problem.add(POSITIVE, least, np.full(kinds, -LEAST_SHARE), "no crease without a law")
        self.problem.add(POSITIVE, -eye[margin], LARGEST_MARGIN, "the margin has a cap")
        for number in without:
            self.problem.add(EQUAL, eye[number], 0.0, "laws that are left out")
        for i, placed in enumerate(targets.placed):
            self._hold(i, placed.target.margin, placed.target.name)
        self.aim = np.zeros(self.problem.size)
        self.aim[margin] = 1.0

    @cached_property
    def answer(self) -> ConicSolution:
        """The optimum, or the proof that there is no point.

        With one degree of freedom all rows are linear: the simplex method ends at a vertex, where few laws are used.
        """
        from scipy.optimize import linprog

        p = self.problem
        if all(len(r.b) == 1 for r in p.rows if r.cone == DEFINITE):
            equal, other = (
                [(p.matrix(r), r.b) for r in p.rows if (r.cone == EQUAL) == same]
                for same in (True, False)
            )
            (a, b), (c, d) = (
                map(np.concatenate, zip(*rows, strict=True)) for rows in (equal, other)
            )
            found = linprog(-self.aim, -c, d, a, -b, bounds=(None, None), method="highs-ds")
            if found.status == 0 and found.x[self.places.margin] > DESIGN_MARGIN:
                t = float(found.x[self.places.margin])
                return ConicSolution("Solved", found.x, (), t, 0.0, int(found.nit))
        return p.maximise(self.aim)

    @cached_property
    def most(self) -> np.ndarray:
        """Largest share of each law of each kind: all of the mean stiffness, [kinds J]."""
        return np.repeat(self.count.sum() / self.count, len(self.stiff))

    @property
    def reach(self) -> np.ndarray:
        """How large each unknown can be, [V]: see `ConvexDesign.reach`."""
        places, n = self.places, float(self.count.sum())
        out = np.zeros(self.problem.size)
        out[: places.margin] = self.most
        out[places.margin] = LARGEST_MARGIN
        for _, balance, where in self.balances:
            x = balance.stratum.state.x
            torques = np.abs([law.torque(x) for law in places.laws])
            slopes = np.abs([law.slope(x) for law in places.laws])
            torque, slope = (n * math.sqrt(n) * float(v.max()) for v in (torques, slopes))
            out[where] = reach_of_multipliers(balance, torque, slope)
        return out

    def weights(self) -> np.ndarray:
        """Weights of the optimum that fulfil the balance to rounding, [kinds, J]."""
        v = self.answer.v.copy()
        used = np.ones(len(v), bool)
        used[: self.places.margin] = v[: self.places.margin] > USED * self.most
        v[~used] = 0.0
        equal = [r for r in self.problem.rows if r.cone == EQUAL]
        a = np.vstack([self.problem.matrix(r) for r in equal])
        b = np.concatenate([r.b for r in equal])
        for _ in range(3):
            v[used] -= np.linalg.lstsq(a[:, used], a @ v + b, rcond=None)[0]
        return np.asarray(v[: self.places.margin].reshape(self.places.kinds, -1) / self.stiff)


def fewest_wells(posed: LibraryProgram) -> tuple[LibraryProgram, bool]:
    """Return the program with the fewest laws whose torque falls somewhere, and whether fewer are excluded.

    By integer programming (HiGHS): a weight is 0 unless its law is chosen, the margin is at least half the largest one.
    Matrices that must be positive are cut from outside until they are.

    Parameters
    ----------
    posed
        A feasible program.

    Returns
    -------
    program : LibraryProgram
        With the other laws left out.
    proved : bool
        Whether branch and bound ended, so that no fewer hold the states with this margin.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp

    places, p = posed.places, posed.problem
    counted = np.tile([not law.monotone for law in places.laws], places.kinds)
    choice = np.flatnonzero(counted)
    columns = p.size + len(choice)
    cost = np.zeros(columns)
    cost[p.size :] = np.repeat(posed.count, len(places.laws))[choice]

    def wide(a: np.ndarray) -> np.ndarray:
        return np.pad(a, ((0, 0), (0, columns - a.shape[1])))

    rows, low, high = [], [], []
    for r in p.rows:
        if r.cone in (EQUAL, POSITIVE):
            rows.append(wide(p.matrix(r)))
            low.append(-r.b)
            high.append(-r.b if r.cone == EQUAL else np.full(len(r.b), np.inf))
    tie = np.zeros((len(choice), columns))
    tie[np.arange(len(choice)), choice] = -1.0 / posed.most[choice]
    tie[np.arange(len(choice)), p.size + np.arange(len(choice))] = 1.0
    rows.append(tie)
    low.append(np.zeros(len(choice)))
    high.append(np.full(len(choice), np.inf))
    least = np.full(columns, -np.inf)
    least[: places.margin], least[p.size :] = 0.0, 0.0
    least[places.margin] = KEPT * posed.margin
    top = np.full(columns, np.inf)
    top[p.size :] = 1.0
    whole = (np.arange(columns) >= p.size).astype(int)
    definite = [r for r in p.rows if r.cone == DEFINITE]
    for _ in range(MOST_CUTS):
        linear_rows = LinearConstraint(np.vstack(rows), np.concatenate(low), np.concatenate(high))
        found = milp(cost, integrality=whole, bounds=Bounds(least, top), constraints=linear_rows)
        if found.x is None:
            return posed, False
        chosen = found.x[p.size :] > 0.5
        small = LibraryProgram(posed.targets, posed.laws, without=choice[~chosen].tolist())
        if small.feasible and small.margin >= KEPT * posed.margin * (1 - DESIGN_MARGIN):
            return small, bool(found.status == 0)
        cut = False
        for r in definite:
            a = p.matrix(r)
            values, vectors = np.linalg.eigh(smatrix(a @ found.x[: p.size] + r.b))
            for value, e in zip(values, vectors.T, strict=True):
                if value < 0:
                    # e' M(v) e >= 0 for every v that is feasible
                    rows.append(wide(np.array([[e @ smatrix(column) @ e for column in a.T]])))
                    low.append(np.array([-float(e @ smatrix(r.b) @ e)]))
                    high.append(np.array([np.inf]))
                    cut = True
        if not cut:  # (rounding) this choice is excluded, and so nothing is proved of it
            return posed, False
    return posed, False
