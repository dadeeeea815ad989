"""Singular states stand alone: no other critical point within a radius of them.

At a closed state whose free axes lie in one plane, or on one line, closure loses rank, and no interval Newton method
certifies anything there.  Three kinds are looked at.  *Flat foldings*: all fold angles 0 or +-pi.  *Turned twins*
(handles, book folds): creases on one line, or on some lines, have other fold angles.  The states with sum t_i x_i as
it is, over a line, all close; they hold one point where the moments G_i / t_i along the line are equal, and that is the
state meant.  *Right angles*: in a wedge of D1 or D2 one line is turned by right angles, so that the facets beyond it
stand at right angles to the mirror.

`blow_up` has what closure, minors and twins say near such a state, `forms` shows that they agree nowhere.

Whether the state itself is a minimum is for `kkt.classify` to say; it is not asked here.

*What is exact.*  That the state closes, and that axes are on one line: sums of sector angles, which a scene decides
(they hold to rounding, or miss by 1e-7 at least).  Torques that should be zero, or equal, are taken as what they are:
they may miss by rounding, |miss| / r is then an error, and the statement holds beyond `Isolation.core` only.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.problem import Model
from origami_nlp.proof.blow_up import SLACK, NotShown, Site, Stratum, kinematics_of, shares
from origami_nlp.proof.forms import left_over, none_beside

RADII = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""Radii [rad] that are tried, largest first; boxes of the search end at some 1e-5."""

STEPS = 8
"""Of Newton's method, from `NEAR_SINGULAR_TOL` on."""


@dataclass(frozen=True)
class Isolation:
    """What is known about critical points near a singular state.

    Attributes
    ----------
    point
        The state x*, to rounding [rad], shape [n]; x itself where none was found.
    radius
        No critical point of the stratum or its limits with core < |x - x*|_inf <= radius [rad]; 0: not shown.
    core
        0, or the distance [rad] below which torques that balance to rounding leave it open.
    reason
        In words, why, or why not.
    """

    point: tuple[float, ...]
    radius: float
    core: float
    reason: str

    def holds(self, lower: Sequence[float], upper: Sequence[float]) -> bool:
        """Return whether a box [n] of the stratum lies within the radius, so that it holds no other critical point."""
        x = np.array(self.point)
        away = np.maximum(np.abs(np.subtract(upper, x)), np.abs(np.subtract(lower, x)))
        return bool(self.radius > 0 and (away <= self.radius * (1 - SLACK)).all())


def isolated(model: Model, x: Sequence[float], stratum: Stratum) -> Isolation:
    """Show that a singular state is the only critical point near it on a stratum.

    Parameters
    ----------
    model
        A posed scene with fold limits.
    x
        Near the state, to `NEAR_SINGULAR_TOL` [rad], shape [n].
    stratum
        +1 or -1 for variables held at +-pi, 0 for free ones; those free may be at +-pi at the state.

    Returns
    -------
    Isolation
        Radius 0 where nothing is shown.

    Raises
    ------
    OptionError
        If the scene has other contact than "fold-limits", or is no flat sheet.

    Examples
    --------
    >>> import math
    >>> from origami_nlp import Scene, Vertex
    >>> from origami_nlp.problem import Model
    >>> vertex = Vertex.from_degrees((60, 80, 120, 100))
    >>> model = Model(Scene(vertex, (1, 2, 3, 4), (0.3, -1, 2, 0.5), "none", "fold-limits"))
    >>> isolated(model, [math.pi, -math.pi, -math.pi, -math.pi], (0, 0, 0, -1)).radius
    0.01
    """
    model.scene.check_no_forces("a singular state")
    if model.scene.contact != "fold-limits" or not model.scene.vertex.flat:
        raise OptionError(
            "singular states are looked at for contact = 'fold-limits' and flat sheets"
        )
    near, stratum = np.asarray(x, dtype=float), tuple(int(s) for s in stratum)
    known = _KNOWN.setdefault(model, {})
    # one flat folding is looked at once, on all the strata that it is on
    flat = math.pi * np.rint(near / math.pi)
    shown = known.get(tuple(flat.tolist()), {}).get(stratum)
    if shown is not None and np.abs(near - flat).max() <= NEAR_SINGULAR_TOL:
        return shown
    try:
        point, lines = _state_at(model, near, stratum)
        limits = model.fold_limits
        stop = np.abs(limits.hold(point, limits.side(point))) != math.pi
        if (stop & (limits.room(point) <= RADII[0])).any():
            raise NotShown("a crease is at a stop there, or next to one")
        key = (*point.tolist(), *(stratum if lines else ()))
        if key not in known:
            known[key] = _decide(model, point, lines, stratum)
        return known[key][stratum]
    except NotShown as why:
        return Isolation(tuple(near.tolist()), 0.0, 0.0, str(why))


_KNOWN: WeakKeyDictionary[Model, dict[tuple[float, ...], dict[Stratum, Isolation]]] = (
    WeakKeyDictionary()
)


def _state_at(model: Model, x: np.ndarray, stratum: Stratum) -> tuple[np.ndarray, list[list[int]]]:
    """Return the exact state next to x, and its creases that are turned by no multiple of pi, by their lines."""
    turns = np.rint(x / math.pi)
    point = turns * math.pi
    turned = np.flatnonzero(np.abs(x - point) > NEAR_SINGULAR_TOL).tolist()
    point[turned] = x[turned]
    if any(s and (s != turns[i] or i in turned) for i, s in enumerate(stratum)):
        raise NotShown("it is not on the stratum")
    if not turned:
        _check_closes(model, point)
        return point, []
    at = kinematics_of(model).fold(point[None])
    # turned creases by the line that they share
    lines: list[list[int]] = []
    for i in turned:
        apart = [np.linalg.norm(np.cross(at.axes[0, line[0]], at.axes[0, i])) for line in lines]
        if lines and min(apart) <= model.size * NEAR_SINGULAR_TOL:
            lines[int(np.argmin(apart))].append(i)
        else:
            lines.append([i])
    mirrored = model.structure.kind == "D" and model.structure.turn in (1, 2) and len(lines) == 1
    for line in lines:
        if len(line) < 2 and not mirrored:
            raise NotShown("a crease is turned that has no twin")
        point[line] = _balanced(model, point, line, at.axes[0, line])
    quarters = 0.5 * math.pi * np.rint(2 * x[turned] / math.pi)
    if mirrored and np.abs(x[turned] - quarters).max() <= NEAR_SINGULAR_TOL:
        point[turned] = quarters
    _check_closes(model, point)
    if np.abs(x - point).max() > NEAR_SINGULAR_TOL:
        raise NotShown("its turned creases are not in balance there")
    return point, lines


def _check_closes(model: Model, point: np.ndarray) -> None:
    """Raise `NotShown` unless a state closes; each is looked at once, however many strata it is on."""
    known, key = _CLOSES.setdefault(model, {}), point.tobytes()
    if key not in known:
        kinematics = kinematics_of(model)
        at = kinematics.fold(point[None])
        closes = np.abs(kinematics.closure(at)[0]).max() <= CLOSURE_TOL and at.lift[0] > 0
        known[key] = bool(closes)
    if not known[key]:
        raise NotShown("no flat folding, nor one with twins turned, closes there")


_CLOSES: WeakKeyDictionary[Model, dict[bytes, bool]] = WeakKeyDictionary()


def _balanced(model: Model, x: np.ndarray, line: list[int], axes: np.ndarray) -> np.ndarray:
    """Fold angles [k] near x [n] of turned creases with axes [k, 3] on one line whose moments along it are equal."""
    p = model.parameters
    stiffness, rest = p.stiffness[line], p.rest[line] + p.load[line] / p.stiffness[line]
    t = np.sign(axes @ axes[0]) * shares(model)[line] / shares(model)[line[0]]
    # t . x is a multiple of pi/2 where the facets beyond the line are in one plane with, or square to, those before it
    quarter = 0.5 * math.pi
    total = quarter * np.rint(t @ x[line] / quarter)
    if p.laws is not None:
        return _balanced_laws(model, x, line, t, total)
    # least sum k (x - rest)^2 / 2 with t . x = total: k (x - rest) = mu t, the same moment mu along the line
    return rest + t / stiffness * (total - t @ rest) / (t @ (t / stiffness))


def _balanced_laws(
    model: Model, x: np.ndarray, line: list[int], t: np.ndarray, total: float
) -> np.ndarray:
    """As `_balanced`, by Newton's method."""
    at, p = x.copy(), model.parameters
    for _ in range(STEPS):
        rows = np.block([[np.diag(p.curvature(at)[line]), -t[:, None]], [t, 0.0]])
        try:
            step = np.linalg.solve(rows, -np.append(p.torque(at)[line], t @ at[line] - total))
        except np.linalg.LinAlgError:
            break
        at[line] += step[:-1]
    return at[line]


def _decide(
    model: Model, point: np.ndarray, lines: list[list[int]], stratum: Stratum
) -> dict[Stratum, Isolation]:
    """Decide on all strata that a flat folding touches, or on one that a state with turned twins touches."""
    turns = np.rint(point / math.pi).astype(int).tolist()
    # a crease at +-pi is either pinned or free and about to open: all strata whose closure holds the state
    touched = itertools.product(*[(0, t) if t else (0,) for t in turns])
    strata = [stratum] if lines else list(touched)
    site = Site(model, point, lines, stratum)
    key, out = tuple(point.tolist()), {}
    for radius in RADII:
        forms, loose = site.forms(strata, radius)
        given_up, left = left_over(forms, radius)
        # leading forms exclude most boxes, the next order those about their common zeros
        beside = none_beside(forms, left, DUPLICATE_TOL, radius)
        for k, s in enumerate(strata):
            mine = left.stratum == k
            if given_up[k] or not beside[mine].all():
                # boxes of directions left: the midpoint of one is named
                what = "whole sets of directions"
                if not given_up[k]:
                    u = (0.5 * (left.lower + left.upper))[mine & ~beside][0]
                    what = f"u = {tuple(np.round(u, 3).tolist())}"
                out[s] = Isolation(
                    key, 0.0, 0.0, f"not shown: rows vanish, as far as looked at, along {what}"
                )
            else:
                core = DUPLICATE_TOL if loose[k] or mine.any() else 0.0
                out[s] = Isolation(key, radius, core, "closure, minors and twins to second order")
        strata = [s for s in strata if not out[s].radius]
        if not strata:
            break
    return out
