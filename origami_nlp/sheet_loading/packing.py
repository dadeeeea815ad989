"""Branches of a sheet over a load as records: parts between events, judged, and events without repetition."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.atlas import (
    BranchEnd,
    KindRange,
    Multiplier,
    PathBranch,
    PathEvent,
    PathPoint,
    Residuals,
)
from origami_nlp.facets import MOST_DENSE, Sheet
from origami_nlp.kkt import State, contact_forces
from origami_nlp.numerics import SETTLED
from origami_nlp.programme import fold_limit
from origami_nlp.sheet_loading.branch import STABLE, Branch
from origami_nlp.sheet_loading.curve import LoadedState
from origami_nlp.sheet_loading.events import Found
from origami_nlp.sheet_loading.held import touches_of, words
from origami_nlp.sheet_loading.work import Work
from origami_nlp.sheets import SheetContact, closed_contacts, judge, told_contact

ENDS = ("range", STABLE)
"""Ends of a branch that are no events."""


@dataclass(eq=False)
class Packed:
    """Records of what was followed.

    Attributes
    ----------
    branches, events
        In order; events by load.
    number
        Of each event, by the identity of what was found.
    alarms
        In words.
    """

    branches: tuple[PathBranch, ...] = ()
    events: tuple[PathEvent, ...] = ()
    number: dict[int, int] = field(default_factory=dict)
    alarms: list[str] = field(default_factory=list)


def pack_branches(sheet: Sheet, work: Work, branches: list[Branch]) -> Packed:
    """Return branches and their events as records.

    Parameters
    ----------
    sheet, work
        The sheet, and what the load works on.
    branches
        Of `Follower.follow`.

    Returns
    -------
    Packed
        Stable parts are judged in their middle.
    """
    out = Packed()
    groups = _alike(branches)
    order = sorted(range(len(groups)), key=lambda g: groups[g][0][1].state.t)
    for number, g in enumerate(order, start=1):
        out.number |= {id(event): number for _, event in groups[g]}
    events = []
    for number, g in enumerate(order, start=1):
        first = groups[g][0][1]
        on = tuple(sorted({b + 1 for b, _ in groups[g]}))
        events.append(_event(number, first, on))
    out.events = tuple(events)
    out.branches = tuple(
        _branch(k, branch, out, sheet) for k, branch in enumerate(branches, start=1)
    )
    return out


def _alike(branches: list[Branch]) -> list[list[tuple[int, Found]]]:
    """Group the events of all branches by their state; those that are one are met from two sides."""
    groups: list[list[tuple[int, Found]]] = []
    for b, branch in enumerate(branches):
        for _, event in branch.events:
            if event.type in ENDS:
                continue
            for group in groups:
                other = group[0][1]
                near = np.abs(other.state.x - event.state.x).max() <= SETTLED
                if near and other.type == event.type:
                    group.append((b, event))
                    break
            else:
                groups.append([(b, event)])
    return groups


def _event(number: int, found: Found, branches: tuple[int, ...]) -> PathEvent:
    return PathEvent(
        number,
        found.type,
        found.state.t,
        tuple(found.state.phi.tolist()),
        found.contact,
        Residuals(found.state.system.residual, found.value),
        found.located,
        found.why,
        branches,
    )


def _branch(number: int, branch: Branch, out: Packed, sheet: Sheet) -> PathBranch:
    cuts = sorted({0, *(k for k, _ in branch.events), len(branch.states) - 1})
    ranges = []
    for a, b in itertools.pairwise(cuts):
        low, high = branch.states[a].t, branch.states[b].t
        if np.abs(branch.states[a].x - branch.states[b].x).max() <= SETTLED:
            continue
        # between two events without a state beside them: of both the one that is less degenerate
        part = branch.states[a : b + 1]
        middle = part[(b - a) // 2] if b - a > 1 else max(part, key=lambda s: abs(s.lowest))
        kind, certificate = _kind(middle, number, out)
        ranges.append(KindRange((low, high), kind, middle.index, certificate, (a, b)))
    end = branch.end
    ends = (
        BranchEnd("a stable state at its load", None),
        BranchEnd(end.type if end.type in ENDS else f"{end.type}: {end.contact or end.why}",
                  out.number.get(id(end))),
    )  # fmt: skip
    points = tuple(_point(s, sheet) for s in branch.states)
    return PathBranch(number, tuple(ranges), points, ends)


def _kind(state: LoadedState, number: int, out: Packed) -> tuple[str, str]:
    if state.index:
        return "saddle", ""
    found = judge(state.system.sheet, state.phi)
    if found.verdict == "minimum":
        return str(found.kind), found.certificate
    words = f"branch {number} at {state.t:.6g}: {found.verdict}"
    out.alarms.append(f"{words}: {found.certificate}")
    return found.verdict, found.certificate


def _point(state: LoadedState, sheet: Sheet) -> PathPoint:
    low = state.lowest * sheet.scale if math.isfinite(state.lowest) else math.nan
    phi = tuple(state.phi.tolist())
    return PathPoint(
        state.t, phi, float(sheet.pattern.energy(state.phi)), _carried(state), low, math.nan
    )


def _carried(state: LoadedState) -> tuple[Multiplier, ...]:
    """Return what contacts carry; where features touch, all that are closed, and between which bounds."""
    sheet, phi = state.system.sheet, state.phi
    touches, rows = touches_of(state.held), closed_contacts(sheet, phi)
    if not {t.key for t in touches} <= {t.key for t in rows.touches} or not touches:
        # no features touch, or they do so on a border, where they are not inside each other
        units = np.full(len(state.held), sheet.scale)
        units[len(units) - len(touches) :] /= sheet.crossings.size
        both = zip(state.held, (state.system.forces * units).tolist(), strict=True)
        return tuple(Multiplier(words((c,)), f, (f, f)) for c, f in both)
    contacts = carried_at(sheet, phi)
    closed = (*rows.limits.tolist(), *rows.touches)
    return tuple(
        Multiplier(words((c,)), told.force, told.between or (told.force, told.force))
        for c, told in zip(closed, contacts, strict=True)
    )


def carried_at(sheet: Sheet, phi: np.ndarray) -> tuple[SheetContact, ...]:
    """Return the closed contacts of an equilibrium [n] and what they carry; none of sheets too large for a kernel."""
    if sheet.size > MOST_DENSE:
        return ()
    rows = closed_contacts(sheet, phi)
    limits = (fold_limit(int(v), phi[v]) for v in rows.limits)
    contacts = (*limits, *(sheet.contact_of(t) for t in rows.touches))
    return tuple(told_contact(sheet, c) for c in contact_forces(State(sheet, phi), contacts))
