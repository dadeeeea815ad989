"""What a polished state is: which kind of minimum, with which certificate, or why it is none."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from origami_nlp.folding import examine
from origami_nlp.kkt.certificates import STATIONARY, BranchJudgement, judge_branch
from origami_nlp.kkt.neighbours import (
    CLOSES,
    RADII,
    dimension_nearby,
    leads_somewhere,
    project,
    search_spheres,
)
from origami_nlp.programme import (
    CLOSED,
    Contacts,
    Gap,
    Local,
    Model,
    Row,
    broken_gap,
    closed_contacts,
    is_admissible,
)

AT_REST = 1e-24
"""Energy over the mean stiffness [rad^2] of springs at rest to rounding of their fold angles."""
MOST_SETS, MOST_FAILED = 100, 6
"""Sets of pieces that are judged where more than 256 meet, and failures after which that stops."""
Kind = Literal["interior", "contact-pinned", "contact-touching", "degenerate"]


@dataclass(frozen=True)
class ContactForce:
    """One closed contact of a state and what it carries.

    type: ``fold-limit``, ``mirror``, ``axis`` or ``facet-pair``.
    creases, facets: who touches, 1-based, all images under the symmetry included for creases at a
    fold limit; a facet pair
        names its two facets (and their touching crease in `text`).
    multiplier: moment [N m per rad of opening, in the scene's units] at each single contact; where
    contacts are dependent,
        the entry of the multiplier vector of smallest norm.
    multiplier_range: smallest and largest value over the set of multipliers; inf where unbounded.
    text: the contact in words.
    """

    type: str
    creases: tuple[int, ...]
    facets: tuple[int, ...]
    multiplier: float
    multiplier_range: tuple[float, float]
    text: str


@dataclass(frozen=True)
class Classification:
    """The decision on a state.

    verdict: ``minimum``, ``saddle``, ``not stationary``, ``not admissible`` or ``undecided``.
    kind: for minima, see `Kind`; else None.
    reason: the certificate of a minimum, or why it is none.
    local_dimension: dimension of the feasible set at the state: the model's degrees of freedom
    where it is full, 1 on a
        handle, 0 if isolated.
    contacts: closed contacts with their multipliers.
    eigenvalues: of the reduced Hessian (tangential stiffness), scene's units.
    stationarity: residual of the best multipliers (scaled energy).
    descent: for a saddle, a unit direction of descent [n] in the model's variables.
    """

    verdict: str
    kind: Kind | None
    reason: str
    local_dimension: int
    contacts: tuple[ContactForce, ...] = ()
    eigenvalues: tuple[float, ...] = ()
    stationarity: float = math.nan
    descent: np.ndarray | None = None


def classify(model: Model, x: np.ndarray, *, polished: bool = True) -> Classification:
    """Classify a closed state x [n] of the model.

    `polished` says whether x is exact to rounding; if not, IPOPT's accuracy is assumed, nothing finer is read, and
    what looks like a minimum is undecided: next to a singular set any state seems to balance.
    """
    what = _decide(model, x, polished)
    if what.verdict == "minimum" and not polished:
        return Classification("undecided", None, f"not polished; {what.reason}", 0)
    return what


def _decide(model: Model, x: np.ndarray, polished: bool) -> Classification:
    """Decide on a state, taking at their word the numbers of one that is not polished."""

    def reject(verdict: str, why: str, descent: np.ndarray | None = None) -> Classification:
        return Classification(verdict, None, why, 0, descent=descent)

    if not model.on_sheet(x):
        return reject("not admissible", "closes with q = -1: not a sheet of paper")
    if (np.abs(x) > model.bound + 1e-9).any():
        return reject("not admissible", f"a fold angle exceeds {model.bound:.4g}: not modelled")
    if model.scene.contact == "full":
        embedding = examine(
            model.scene.vertex, model.expand(x), elements=model.scene.group.elements
        )
        if not embedding.admissible:
            return reject("not admissible", embedding.reason)
    local = model.local(x)
    broken = broken_gap(model, local.gaps)
    if broken is not None:
        what = model.gap_name(model.structure.gaps[broken])
        return reject(
            "not admissible",
            f"beyond the contact '{what}': its layers have no order with the symmetry of the scene",
        )
    contacts = closed_contacts(model, x, local.gaps, CLOSED if polished else 1e-5)
    choices = contacts.combinations()
    accuracy = STATIONARY if polished else 1e-5
    # Too many pieces meet: judge larger sets that ignore facet pairs.  What is a minimum of them is one of ours;
    # anything else is decided by looking at neighbours.
    relaxed = choices is None
    if choices is None:
        whole = judge_branch(model, x, contacts.base, local, accuracy)
        lower = _follow_descent(model, x, [whole]) if whole.verdict != "minimum" else None
        if lower is not None:
            return lower
        judged, failed = _judge_by_splitting(model, x, contacts, local, accuracy)
        if failed:
            return _by_search(model, x, contacts, failed)
    else:
        judged = [judge_branch(model, x, rows, local, accuracy) for rows in choices]
    real = [
        b for b in judged if b.tangent is not None and leads_somewhere(model, x, b.tangent, b.held)
    ]
    thickest = max(b.cone_dimension for b in judged)
    if not real and thickest == 1 and not relaxed:
        return _isolated(
            model,
            x,
            judged[0],
            contacts,
            "isolated: the linearised contacts leave single directions, and facets cross at once "
            "along each of them (a check, not a proof)",
        )
    if not real and thickest > 1:
        # no piece that the linearised contacts allow is followed by states: isolated, or beyond first order
        return _by_search(model, x, contacts, judged)
    decisive = real or judged  # without a real piece every cone is a point: isolated
    dimension = max((b.cone_dimension for b in real), default=0)
    if real and not all(b.regular for b in real):
        dimension = dimension_nearby(model, x, contacts.base)
    verdicts = {b.verdict for b in decisive}
    if "saddle" in verdicts or "not stationary" in verdicts:
        worst = next(b for b in decisive if b.verdict in ("saddle", "not stationary"))
        d = worst.direction
        if d is not None:
            d = d / np.linalg.norm(d) if d.any() else None
        return reject(worst.verdict, worst.certificate, d)
    certificate = "; ".join(dict.fromkeys(b.certificate for b in decisive))
    if 0 < dimension < model.freedom:
        certificate += f"; nearby states exist only with {_held_words(model, decisive)} exactly"
    if "undecided" in verdicts:
        return _by_search(model, x, contacts, judged)
    return Classification(
        "minimum",
        _kind(decisive),
        certificate + (_of_branches(len(decisive)) if len(decisive) > 1 else ""),
        dimension,
        _forces(model, x, decisive[0], contacts),
        tuple((model.scale * decisive[0].eigenvalues).tolist()),
        # nothing has to balance where closure itself leaves no way down
        math.nan if decisive[0].level == 5 else decisive[0].multipliers.residual,
    )


def _judge_by_splitting(
    model: Model, x: np.ndarray, contacts: Contacts, local: Local, accuracy: float
) -> tuple[list[BranchJudgement], list[BranchJudgement]]:
    """Judge the union of pieces without listing them: split a set by one facet pair after the other.

    A minimum of a larger set is one of every piece of it, so most sets need no splitting.  Returns the sets of
    which x is a minimum, which cover all pieces, and the pieces (or sets, where there are too many) for which
    that could not be shown.
    """
    good: list[BranchJudgement] = []
    failed: list[BranchJudgement] = []
    pending = [(contacts.base, 0)]
    while pending:
        rows, start = pending.pop()
        b = judge_branch(model, x, rows, local, accuracy)
        held = set(rows)
        split = next(
            (
                k
                for k in range(start, len(contacts.branches))
                if not any(held.issuperset(option) for option in contacts.branches[k])
            ),
            None,
        )
        if b.verdict == "minimum":
            good.append(b)
        elif split is None or len(good) + len(failed) + len(pending) > MOST_SETS:
            failed.append(b)
            if len(failed) == MOST_FAILED:
                break
        else:
            for option in contacts.branches[split]:
                pending.append((tuple(dict.fromkeys((*rows, *option))), split + 1))
    return good, failed


def _isolated(
    model: Model, x: np.ndarray, branch: BranchJudgement, contacts: Contacts, reason: str
) -> Classification:
    """Return the classification of an isolated point: a minimum, since it has no neighbours."""
    forces = _forces(model, x, branch, contacts)
    # nothing has to balance at a point that cannot move: no stationarity residual
    return Classification("minimum", "degenerate", reason, 0, forces)


def _held_words(model: Model, branches: list[BranchJudgement]) -> str:
    """Name the contacts that every neighbouring state keeps closed."""
    held = set.intersection(*(set(b.held) for b in branches))
    words = []
    for row in sorted(held):
        if row.kind == "limit":
            creases = ", ".join(map(str, model.creases_of(row.index)))
            words.append(f"phi_{{{creases}}} = {'+' if row.side > 0 else '-'}pi")
        else:
            words.append(model.gap_name(model.structure.gaps[row.index]))
    return " and ".join(words) or "their contacts"


def _of_branches(count: int) -> str:
    return f" (on each of the {count} pieces of the feasible set that meet here)"


def _kind(branches: list[BranchJudgement]) -> Kind:
    if any(not b.regular or not b.multipliers.unique or b.held for b in branches):
        return "degenerate"
    if all(not b.rows for b in branches):
        return "interior"
    loaded = all((b.multipliers.smallest > 0).all() for b in branches)
    return "contact-pinned" if loaded else "contact-touching"


def _follow_descent(
    model: Model, x: np.ndarray, judged: list[BranchJudgement]
) -> Classification | None:
    """Step along the linearised descent directions; an admissible lower state settles the matter."""
    for b in judged:
        if b.direction is None or not np.abs(b.direction).max() > 0:
            continue
        d = b.direction / np.linalg.norm(b.direction)
        slope = float(model.local(x).gradient @ d) * model.scale
        for step in (1e-5, 1e-4, 1e-3):  # shorter ones hide in the snapping of contacts
            y, residual = project(model, x + step * d, b.held)
            change = model.energy_change(x, y)
            if (
                residual <= CLOSES
                and np.linalg.norm(y - x) < 3 * step
                and change < 0.1 * step * slope < 0
                and is_admissible(model, y)
            ):
                why = f"an admissible state {step:g} rad away is lower by {-change:.2e}"
                return Classification("not stationary", None, why, 0, descent=d)
    return None


def _by_search(
    model: Model, x: np.ndarray, contacts: Contacts, judged: list[BranchJudgement]
) -> Classification:
    """Refute a singular state by a lower neighbour on small spheres around it; without one it is undecided."""
    if model.energy(x) <= AT_REST * model.scale:
        return Classification(
            "minimum",
            "degenerate",
            "at rest: no state has less energy",
            dimension_nearby(model, x, contacts.base),
            _forces(model, x, judged[0], contacts),
            stationarity=0.0,
        )
    lower = _follow_descent(model, x, judged)
    if lower is not None:
        return lower
    rows = tuple(dict.fromkeys(row for b in judged for row in b.rows))
    found = search_spheres(model, x, rows)
    noise = 1e-12 * max(model.energy(x), model.scale)
    where = f"small spheres, radii {min(RADII):g} to {max(RADII):g}, {found.admissible} admissible states"
    if found.state is not None and found.lowest < -noise:
        return Classification(
            "not stationary",
            None,
            f"{where}: a neighbour is lower by {-found.lowest:.2e}",
            found.dimension,
        )
    if found.state is None:
        reason = "no certificate; no admissible neighbour found on small spheres"
    else:
        reason = f"no certificate; {where}, none lower"
    return Classification("undecided", None, reason, found.dimension)


def _where_rays_meet(model: Model, x: np.ndarray, gap: Gap) -> str | None:
    """Name a facet-pair contact by its two creases where they lie on each other."""
    rays = model.rays(x)
    k, j = gap.rays
    for end in (j, (j + 1) % len(rays)):
        has = model.structure.has_crease
        if (
            np.linalg.norm(rays[k] - rays[end]) <= CLOSED
            and has[k % len(has)]
            and has[end % len(has)]
        ):
            first, second = sorted((model.crease_of_ray(k), model.crease_of_ray(end)))
            facet = model.facet_of_ray(j)
            off = model.crease_of_ray(k)
            return (
                f"creases {first} and {second} on each other "
                f"(opening: crease {off} off the plane of facet {facet})"
            )
    return None


def _forces(
    model: Model, x: np.ndarray, branch: BranchJudgement, contacts: Contacts
) -> tuple[ContactForce, ...]:
    """Turn rows and multipliers into contacts with moments."""
    out = []
    also: dict[Row, list[str]] = {}
    for row, same in contacts.implied:
        also.setdefault(same, []).append(model.gap_name(model.structure.gaps[row.index]))
    m = branch.multipliers
    stationary = m.residual <= 1e-8 * (1 + float(np.abs(m.smallest).max(initial=0)))
    for r, row in enumerate(branch.rows):
        creases: tuple[int, ...] = ()
        facets: tuple[int, ...] = ()
        if row.kind == "limit":
            kind, weight = "fold-limit", int(model.multiplicity[row.index])
            creases = model.creases_of(row.index)
            text = f"phi = {'+' if row.side > 0 else '-'}pi at crease{'s' * (len(creases) > 1)} "
            text += ", ".join(map(str, creases))
        else:
            gap = model.structure.gaps[row.index]
            kind, weight, text = gap.type, gap.weight, model.gap_name(gap)
            if gap.pair is not None:
                text = _where_rays_meet(model, x, gap) or text
                facets = tuple(model.facet_of_ray(i) for i in gap.pair)
            elif model.scene.group.rays[gap.rays[0]].crease is not None:
                creases = (model.crease_of_ray(gap.rays[0]),)
            else:
                facets = (model.facet_of_ray(gap.rays[0]),)
        if row in also:
            text += " (so " + ", ".join(sorted(set(also[row]))) + ")"
        unit = model.scale / weight
        values = (m.smallest[r], m.lower[r], m.upper[r]) if stationary else (0.0, 0.0, math.inf)
        out.append(
            ContactForce(
                kind,
                creases,
                facets,
                float(values[0] * unit),
                (float(values[1] * unit), float(values[2] * unit)),
                text,
            )
        )
    return tuple(out)
