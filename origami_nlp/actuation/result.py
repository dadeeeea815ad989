"""What torques on creases do: branches of the flat state that they start, states that are reached, loads in turn.

Angles in radians, torques in N m, energies in J (the units of springs).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from origami_nlp.actuation.driving import DrivenSet
from origami_nlp.display import Details, Report, Section, Table, angle_columns
from origami_nlp.io import ShortRepr
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import coarse
from origami_nlp.pattern import Pattern, listed
from origami_nlp.pattern_problem import state_frame, states_to_fold

MOST_ROWS = 12
"""Branches that are printed; all are in JSON."""


@dataclass(frozen=True, eq=False, repr=False)
class BranchWay(ShortRepr):
    """A direction in which the steepest descent leaves the flat state along a cone of motions.

    Attributes
    ----------
    velocity
        Unit flat velocity, [n]: the work is a strict local maximum among those of the cone.
    work
        For it [N m].
    reached
        Number (1-based) of the state that is reached; 0 where none was.
    why
        Why none was reached.
    """

    velocity: np.ndarray
    work: float
    reached: int = 0
    why: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class FlatBranch(ShortRepr):
    """A branch of closed states that leaves the flat one.

    Attributes
    ----------
    kind
        ``line``: one degree of freedom; ``family``: several, all motions of a subspace; ``cone``: several, one of the
        two nappes of a cone in a subspace, round a vertex of more than four creases.
    velocities
        Orthonormal basis of its flat velocities, of a cone of the subspace that it lies in, [n, k].
    work
        Of the torques, springs included, for a unit motion along it [N m]: in the sense, and of a family in the
        direction, in which it is most; 0 where it is not started.
    drivable
        Whether torques exist that start this branch alone.
    reached
        Number (1-based) of the state that is reached along it, of a cone in the way of most work; 0 where it is not
        started, or none was reached.
    why
        Why none was reached.
    ways
        Of a cone: all directions in which descents leave, that of most work first.
    side
        Of a cone: 1 where the sum of the fold angles is positive, -1 where it is negative; else 0.
    """

    kind: Literal["line", "family", "cone"]
    velocities: np.ndarray
    work: float
    drivable: bool
    reached: int = 0
    why: str = ""
    ways: tuple[BranchWay, ...] = ()
    side: int = 0

    @property
    def is_unique(self) -> bool | None:
        """Whether descents along it leave the flat state in one direction; None where that is not decided."""
        if self.kind == "cone":
            return len(self.ways) == 1 if self.ways else None
        return self.kind == "line"


@dataclass(frozen=True, repr=False)
class StateTransition(ShortRepr):
    """What becomes of a stable state when a load is put on and taken off again.

    Attributes
    ----------
    start, end
        Numbers (1-based) of the states, 0 of the flat one; `end` is -1 where it is not known.
    load
        Number (1-based) of the load.
    snaps
        Where it snaps on the way, in order: the load there, over the whole load.
    why
        Why it is not known where it ends; "" otherwise.
    """

    start: int
    end: int
    load: int
    snaps: tuple[float, ...]
    why: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class Actuation(Report):
    """What torques on creases do to a pattern.

    Attributes
    ----------
    pattern
        The sheet with its springs; of a vertex a sheet of one vertex.
    loads
        Torques of each load in turn, [n] each [N m], towards valley > 0.
    branches
        Of the flat state; none where the first load does not begin there.
    reached
        States under the first load that are reached from the flat one.
    driven
        The fewest creases that start a branch alone, for each branch where there are any.
    states
        Stable states without loads, between which loads lead.
    transitions
        Where each load leads from each of these that was looked at.
    walk
        Numbers (1-based) of the states after each load, from the start on (0: flat); it ends where a load leads to
        several states, or where that is not known.
    reason
        Why branches were not enumerated; "" where they were.
    left_out
        What the time did not suffice for, in words.
    signs
        Signs of torques on each crease (0: none), where no sizes are stated; `driven` has sizes of such torques then
        that start a branch alone.

    Examples
    --------
    >>> import origami_nlp as o
    >>> seen = o.actuate("miura:2x2", {2: 0.01}, relaxed=True)
    >>> seen.unique, len(seen.branches), [d.creases for d in seen.driven]
    (False, 2, [(1,), (2, 3)])
    """

    pattern: Pattern
    loads: tuple[np.ndarray, ...]
    branches: tuple[FlatBranch, ...] = ()
    reached: tuple[JudgedState, ...] = ()
    driven: tuple[DrivenSet, ...] = ()
    states: tuple[JudgedState, ...] = ()
    transitions: tuple[StateTransition, ...] = ()
    walk: tuple[int, ...] = ()
    reason: str = ""
    left_out: tuple[str, ...] = ()
    signs: tuple[int, ...] = ()

    PICTURE, SCHEMA = "draw_actuation", "origami-nlp/actuation/1"
    ALSO = ("unique",)

    @property
    def started(self) -> tuple[int, ...]:
        """Numbers (1-based) of the branches that the first load starts."""
        return tuple(k for k, branch in enumerate(self.branches, start=1) if branch.work > 0)

    @property
    def unique(self) -> bool | None:
        """Whether the first load starts exactly one branch of the flat state, and leaves in one direction along it.

        A branch of one degree of freedom, or a cone on which one direction has most work: see `FlatBranch.ways`.
        None where that is not known.
        """
        if self.reason or not self.branches or not self.loads:
            return None
        if len(self.started) != 1:
            return False
        return self.branches[self.started[0] - 1].is_unique

    @property
    def can_be_unique(self) -> bool | None:
        """Whether torques exist, of the signs stated, for which the fold is unique; None where that is not known."""
        if self.reason or not self.branches:
            return None
        if self.signs:
            if any(branch.kind == "cone" for branch in self.branches):
                return None
            return any(self.branches[d.branch - 1].kind == "line" for d in self.driven)
        if any(branch.drivable and branch.kind == "line" for branch in self.branches):
            return True
        if self.driven and any(self.branches[d.branch - 1].kind == "cone" for d in self.driven):
            return True
        return None if any(branch.kind == "cone" for branch in self.branches) else False

    @property
    def verdict(self) -> str:
        """What the torques do, in a sentence."""
        name = self.pattern.title
        if self.walk:
            way = " -> ".join("flat" if k == 0 else f"#{k}" for k in self.walk)
            return f"{name}: loads lead {way}"
        if self.reason:
            return f"{name}: branches of the flat state are not enumerated: {self.reason}"
        if self.transitions:
            return f"{name}: {len(self.states)} states, {len(self.transitions)} transitions"
        if self.signs:
            if self.can_be_unique is None:
                return f"{name}: not decided for torques of these signs: motions are a cone"
            alone = [d.branch for d in self.driven if self.branches[d.branch - 1].kind == "line"]
            if alone:
                return f"{name}: torques of these signs fold it uniquely for some sizes, along branch {listed(alone)}"
            return f"{name}: no unique fold by torques of these signs, whatever their sizes"
        if not self.loads:
            of = _many(len(self.branches), "branch")
            if self.can_be_unique is None:
                return f"{name}: {of}, torques for which the fold is unique were not found"
            if self.can_be_unique:
                return f"{name}: {of}, torques exist for which the fold is unique"
            return f"{name}: {of}, the fold is not unique whatever the torques"
        many = len(self.started)
        first = self.branches[self.started[0] - 1] if many else None
        if many == 1 and first is not None and first.kind == "cone":
            if self.unique is None:
                return f"{name}: one side is started, {first.why}"
            if self.unique:
                return f"{name}: the torques fold it uniquely, along one direction of branch {self.started[0]}"
            return f"{name}: no unique fold, descents leave along {len(first.ways)} directions of one side"
        if many == 1 and first is not None and not self.unique:
            dof = first.velocities.shape[1]
            return f"{name}: no unique fold, the torques start motions of {dof} degrees of freedom"
        if many == 1:
            return f"{name}: the torques fold it uniquely, along branch {self.started[0]}"
        if not many:
            return f"{name}: the torques start no branch"
        of = _many(len(self.branches), "branch")
        return f"{name}: no unique fold, the torques start {many} of {of}"

    def report_sections(self) -> Iterator[Section]:
        """Return branches with what becomes of them, the fewest driven creases, and transitions between states."""
        if not self.branches:
            yield self.verdict
        else:
            rows = [
                [str(k), _kind(b), f"{b.work:.4g}", _reached(b), self._how(k, b)]
                for k, b in self._shown()
            ]
            last = "torques of these signs" if self.signs else "fewest creases, torques"
            heads = ["branch", "", "work\n[N m]", "reached", last]
            yield Table(heads, rows, self.verdict, "rlrLL", framed=False, narrow=True)
            if len(rows) < len(self.branches):
                yield f"{len(self.branches) - len(rows)} more branches: -o FILE.json"
        if self.loads and self.branches and self.pattern.rest.any():
            yield "springs that are not at rest in the flat state work on branches as well"
        for k, state in enumerate(self.reached, start=1):
            yield f"state {k} under the torques [deg]: {_angles(state.fold_angles)}"
        if self.transitions:
            rows = [
                [
                    "flat" if t.start == 0 else f"#{t.start}",
                    str(t.load),
                    "not known" if t.end < 0 else "flat" if t.end == 0 else f"#{t.end}",
                    ", ".join(f"{share:.4g}" for share in t.snaps) or "-",
                    t.why,
                ]
                for t in self.transitions
            ]
            heads = ["from", "load", "to", "snaps at this share of it", ""]
            yield Table(heads, rows, "each load put on and taken off", "rrrLL", framed=False)
            for k, state in enumerate(self.states, start=1):
                yield f"#{k} {state.energy:.6g} J [deg]: {_angles(state.fold_angles)}"
        yield from self.left_out
        certificates = [f"state {k}: {s.certificate}" for k, s in enumerate(self.reached, start=1)]
        certificates += [f"#{k}: {s.certificate}" for k, s in enumerate(self.states, start=1)]
        if certificates:
            yield Details(tuple(certificates), "Certificates of states")

    def _how(self, k: int, branch: FlatBranch) -> str:
        """Say how branch k is started alone; of signs also whether torques of all sizes start it."""
        if not self.signs:
            return _driven(self.driven, k) if branch.drivable else "no torques start it alone"
        alone = next((d for d in self.driven if d.branch == k), None)
        if alone is not None:
            return f"alone by {listed(list(alone.creases))} ({', '.join(f'{t:.4g}' for t in alone.torques)})"
        if branch.kind != "line":
            return "not alone" if branch.kind == "family" else "not decided"
        works = np.array(self.signs) * coarse(branch.velocities[:, 0])
        if not works.any():
            return "never"
        return "always" if works.min() >= 0 or works.max() <= 0 else "by some, not alone"

    def _shown(self) -> list[tuple[int, FlatBranch]]:
        """Return the branches that are printed: those that are started first."""
        each = [*enumerate(self.branches, start=1)]
        return sorted(each, key=lambda one: one[1].work <= 0)[:MOST_ROWS]

    def to_fold(self) -> dict[str, Any]:
        """Return states as FOLD data (spec 1.1), a frame each: those reached under the first load, then the others."""
        titled = [(f"reached {k}", s) for k, s in enumerate(self.reached, start=1)]
        titled += [(f"state {k}", s) for k, s in enumerate(self.states, start=1)]
        frames = [state_frame(self.pattern, s.phi, title) for title, s in titled]
        return states_to_fold(self.pattern, frames)

    def _rows(self) -> Iterator[dict[str, object]]:
        for k, branch in enumerate(self.branches, start=1):
            row: dict[str, object] = {"branch": k, "kind": branch.kind, "work_N_m": branch.work}
            row |= {"drivable": branch.drivable, "reached": branch.reached}
            driven = next((d for d in self.driven if d.branch == k), None)
            row["driven_creases"] = "" if driven is None else " ".join(map(str, driven.creases))
            yield row
        for k, state in enumerate(self.states, start=1):
            yield {"state": k, "energy_J": state.energy} | angle_columns(state.fold_angles)


def _kind(branch: FlatBranch) -> str:
    """Say what a branch is; of a cone on which side."""
    dimension = branch.velocities.shape[1]
    if branch.kind == "cone":
        return f"cone of {dimension - 1}, sum of folds {'>' if branch.side > 0 else '<'} 0"
    return "line" if branch.kind == "line" else f"family of {dimension}"


def _reached(branch: FlatBranch) -> str:
    """Say which states are reached along a branch."""
    if len(branch.ways) > 1:
        return "; ".join(f"state {w.reached}" if w.reached else w.why for w in branch.ways)
    return f"state {branch.reached}" if branch.reached else branch.why or "-"


def _driven(sets: tuple[DrivenSet, ...], branch: int) -> str:
    """Write the creases that start a branch alone, with torques on them."""
    found = next((d for d in sets if d.branch == branch), None)
    if found is None:
        return "some do; fewest not looked for"
    torques = ", ".join(f"{t:.4g}" for t in found.torques)
    few = "" if found.fewest else ", perhaps fewer"
    return f"{listed(list(found.creases))} ({torques}){few}"


def _angles(phi: tuple[float, ...], most: int = 12) -> str:
    """Write fold angles [deg], the first of many."""
    shown = " ".join(f"{round(math.degrees(a), 2) + 0.0:.2f}" for a in phi[:most])
    return f"{shown} ... ({len(phi)} creases: -o FILE.json)" if len(phi) > most else shown


def _many(count: int, one: str) -> str:
    return f"{count} {one}{'' if count == 1 else 'es'}"
