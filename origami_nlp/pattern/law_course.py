"""A hinge law over one of the numbers that it is stated with: the depth, place or width of a well, a stiffness.

All laws of a course have the same breaks, on which each follows its formula as closely as a law that is stated alone.
Their torques and slopes there are analytic in the number, so that the derivative of the pieces is that of the formula,
interpolated alike: what a path is traced with is the derivative of the very torque that holds its states.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np

from origami_nlp.arguments import did_you_mean
from origami_nlp.errors import OptionError
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinge_types import (
    TYPES,
    Formula,
    first_breaks,
    hermite,
    of_type,
    pieces_for,
    sum_of,
)
from origami_nlp.pattern.hinges_stated import Laws

LAW_NUMBER = re.compile(
    r"laws\.(?P<law>.+?)(?P<part>(?:\.sum\[\d{1,3}\])*)\.(?P<key>[a-z]+)(?:\[(?P<entry>\d{1,2})\])?"
)
"""Name of a number of a law: ``laws.NAME.energy``, ``laws.NAME.sum[2].at``, ``laws.NAME.coefficients[3]``."""
LOOKED_AT = 9
"""Values of a range at which pieces follow the formula as closely as asked."""
TINY = 1e-300
"""In place of 0: a well without depth is no law by itself."""
IMAGINARY = 1e-30
"""Step of the derivative along the imaginary axis: no difference is taken, nothing cancels."""


@dataclass(frozen=True, eq=False)
class LawCourse:
    """A law over one of its numbers.

    Attributes
    ----------
    name
        Of the law.
    law
        Return the law at a value.
    rate
        Return the derivative of its torque by the number at a value, at fold angles [...].
    """

    name: str
    law: Callable[[float], HingeLaw]
    rate: Callable[[float, np.ndarray], np.ndarray]

    def moved(self, laws: Laws, t: float) -> Laws:
        """Return laws of creases, those of this name at a value; their factors and shifts stay."""
        return tuple(law and self._at(law, t) for law in laws)

    def _at(self, law: HingeLaw, t: float) -> HingeLaw:
        base, *change = law.origin
        return _changed(self.law(t), *change) if base.name == self.name else law


def law_course(laws: Laws, number: str, low: float, high: float) -> LawCourse:
    """Return the law that a number of it moves through.

    Parameters
    ----------
    laws
        Of the creases.
    number
        As in sweeps, see `LAW_NUMBER`: angles without ``_deg``, in radians.
    low, high
        Range of the number.

    Returns
    -------
    LawCourse
        The laws over it.

    Raises
    ------
    OptionError
        If no crease has such a law, or the law no such number.
    SceneError
        If a value does not fit.

    Examples
    --------
    >>> from origami_nlp.pattern.hinge_types import double_well
    >>> from origami_nlp.pattern.law_course import law_course
    >>> course = law_course((double_well(1.0, 0.8),), "laws.double-well.energy", 0.5, 2.0)
    >>> round(float(course.law(1.0).torque(0.4)), 6), round(float(course.rate(1.0, np.array(0.4))), 6)
    (-1.875, -1.875)
    """
    match = LAW_NUMBER.fullmatch(number)
    names = {law.origin[0].name for law in laws if law is not None}
    if match is None or match["law"] not in names:
        raise OptionError(
            f"{number}: write laws.NAME.energy, laws.NAME.sum[2].at or another number of a law, of a crease's law: "
            f"{', '.join(sorted(names)) or 'no crease has one'}"
        )
    whole = {
        law.origin[0] for law in laws if law is not None and law.origin[0].name == match["law"]
    }
    if len(whole) > 1:
        raise OptionError(f"{number}: {len(whole)} different laws are called {match['law']!r}")
    leaf, around = whole.pop(), []
    factor, by = 1.0, 0.0
    for k in re.findall(r"\d+", match["part"]):
        base, *change = leaf.origin
        kind, parts = base.stated or ("", ())
        if kind != "sum":
            raise OptionError(f"{number}: law {base.name!r} is no sum")
        if not 0 < int(k) <= len(parts):
            raise OptionError(f"{number}: the sum has parts 1 to {len(parts)}")
        around.append((parts[: int(k) - 1], parts[int(k) :], base.name, change))
        factor, by, leaf = factor * change[0], by + change[1], parts[int(k) - 1]
    base, *change = leaf.origin
    factor, by = factor * change[0], by + change[1]
    key = match["key"] + (f"[{match['entry']}]" if match["entry"] else "")
    made, slope = _formula(base, key, number, (low, high))

    @lru_cache(maxsize=256)  # equal laws are one object
    def law(t: float) -> HingeLaw:
        whole = _changed(made(t), *change)
        for before, after, name, changed in reversed(around):
            whole = _changed(sum_of([*before, whole, *after], name), *changed)
        return whole

    for t in (low, high):
        law(t)
    return LawCourse(match["law"], law, lambda t, x: factor * slope(t, x - by))


def _changed(law: HingeLaw, factor: float, by: float) -> HingeLaw:
    return law if (factor, by) == (1.0, 0.0) else law.times(factor).shifted(by)


def _formula(
    law: HingeLaw, key: str, number: str, ends: tuple[float, float]
) -> tuple[Callable[[float], HingeLaw], Callable[[float, np.ndarray], np.ndarray]]:
    """Return a law of a type, and the derivative of its torque, over one of its numbers."""
    from scipy.interpolate import CubicHermiteSpline

    kind, numbers = law.stated or ("", {})
    # of a table, measured data and a sum as such: none
    known = [n for n in numbers if kind in TYPES and TYPES[kind][1][n.partition("[")[0]].smooth]
    if key not in known:
        few = ", ".join(known)
        if kind == "sum":
            few = f"those of its parts, sum[1] to sum[{len(numbers)}]"
        raise OptionError(
            f"{number}: states are followed over these numbers of {kind or 'measured or tabulated'} law {law.name!r}: "
            f"{few or 'none'}{did_you_mean(key, known) if known else ''}; and over law_scale[1] and law_shift[1], "
            "which every law has"
        )

    def formula(t: Any) -> Callable[[np.ndarray], Formula]:
        return partial(TYPES[kind][0], **{**numbers, key: t})

    for t in ends:
        of_type(kind, {**numbers, key: t or TINY})  # which says what does not fit
    every = [formula(float(t)) for t in np.linspace(*ends, LOOKED_AT)]
    x = pieces_for(every, law.name, first_breaks(kind, {**numbers, key: min(ends)}))

    def made(t: float) -> HingeLaw:
        t = t or TINY
        return hermite(x, formula(t)(x), law.name, (kind, {**numbers, key: t}))

    def rate(t: float, phi: np.ndarray) -> np.ndarray:
        change = [v.imag / IMAGINARY for v in formula(complex(t, IMAGINARY))(x + 0j)]
        inside = np.clip(phi, x[0], x[-1])
        spline = CubicHermiteSpline(x, *change)
        # beyond the ends the tangent goes on, as that of the law
        return np.asarray(spline(inside) + (phi - inside) * spline(inside, 1))

    return made, rate
