"""Hinge laws of the creases of a vertex or a pattern: read, checked, and what they are worth at states."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.arguments import check_number, check_whole, shown
from origami_nlp.errors import FoldFileError, OptionError, OrigamiError, SceneError
from origami_nlp.io import printable
from origami_nlp.numerics import OUTSIDE
from origami_nlp.pattern.fold_limits import (
    Limits,
    limit_angles,
    limit_words,
    read_limits,
    thick_limits,
)
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinge_tables import law_to_dict, read_law
from origami_nlp.pattern.numbers_read import check_range, read_numbers

Laws = tuple[HingeLaw | None, ...]
PROBES = np.array([-2.9, -1.7, -0.6, 0.3, 1.1, 2.3])
"""Angles [rad] at whose torques laws are compared."""


def read_laws(given: object, degree: int) -> Laws:
    """Check hinge laws, one for each crease or None; () where all springs are linear."""
    laws = tuple(given) if isinstance(given, Iterable) else ()
    if not laws and given == ():
        return ()
    if len(laws) != degree or not all(law is None or isinstance(law, HingeLaw) for law in laws):
        raise SceneError(f"laws = {shown(given)} must be HingeLaws or None, one for each crease")
    known: dict[HingeLaw, HingeLaw] = {}  # equal laws are one
    return tuple(law and known.setdefault(law, law) for law in laws) if any(laws) else ()


class Hinges(NamedTuple):
    """Springs, stops and laws of n creases, as `Scene` and `Pattern` have them."""

    stiffness: tuple[float, ...]
    rest: tuple[float, ...]
    limits: Limits
    laws: Laws


def read_hinges(
    n: int,
    stiffness: object,
    rest: Iterable[float],
    limits: object = (),
    laws: object = (),
    contact: str = "full",
    panels: tuple[float, float] | None = None,
) -> Hinges:
    """Read what is stated of n creases; a law has its own stiffness and rest angle.

    rest: as `read_rest_angles` returns them, or beyond half a turn where a load winds the springs.
    """
    own = read_laws(laws, n)
    if contact == "none" and (own or limits):
        raise SceneError("contact = 'none' has no limits, and no laws: use 'fold-limits' or 'full'")
    k, phi = read_numbers(stiffness, "stiffness", n), tuple(rest)
    if own:
        each = [*zip(k, phi, own, strict=True)]
        k = tuple(k if law is None else law.stiffness for k, _, law in each)
        phi = tuple(a if law is None else law.rest for _, a, law in each)
    check_range(k)
    stops = thick_limits(read_limits(limits, n), n, panels)
    check_laws(own, limit_angles(stops, n))
    return Hinges(k, phi, stops, own)


def check_laws(laws: Laws, limits: np.ndarray) -> None:
    """Raise an error for a law that is not known on all of the fold limits [2, N] of its crease."""
    for i, (law, low, high) in enumerate(zip(laws, *limits, strict=True) if laws else (), start=1):
        if law and (law.breaks[0] > low + OUTSIDE or law.breaks[-1] < high - OUTSIDE):
            span = "[{:.4g}, {:.4g}] degrees"
            known, asked = (
                span.format(*np.degrees(p))
                for p in (law.breaks[:: len(law.breaks) - 1], (low, high))
            )
            raise SceneError(
                f"hinge law {law.name!r} of crease {i} is known on {known}, its fold limits are {asked}: give "
                "limits_deg within, or extrapolate = 'linear' in the law"
            )


def check_plain_hinges(laws: Laws, limits: Limits, what: str) -> None:
    """Raise an error where there are hinge laws, or fold limits, which `what` does not know."""
    if laws:
        i, law = next((i, law) for i, law in enumerate(laws, start=1) if law)
        raise OptionError(f"{what} is for linear springs: crease {i} has the law {law.name!r}")
    if limits:
        raise OptionError(f"{what} knows no fold limits of their own ({limit_words(limits)})")


LAW_PLACES = ("law_scale", "law_shift")
"""Numbers of a crease that change its law: a factor, and an angle by which it is moved towards valley."""


def law_at(law: HingeLaw | None, what: str, value: float) -> HingeLaw:
    """Return a law with one of `LAW_PLACES` set.

    Parameters
    ----------
    law
        As stated.
    what
        Which.
    value
        Factor, or angle [rad].

    Returns
    -------
    HingeLaw
        The law.
    """
    assert law is not None
    return law.times(value) if what == "law_scale" else law.shifted(value)


def check_law_place(laws: Laws, what: str, entry: int | None = None) -> None:
    """Raise an error where a number of a crease is none of its hinge: of a law where there is none, or of a spring.

    Parameters
    ----------
    laws
        Of all creases.
    what
        Name of the number, without the crease.
    entry
        Crease (0-based); None: all.

    Raises
    ------
    OptionError
        With the crease.
    """
    which = range(len(laws)) if entry is None else [entry]
    has = [i for i in which if laws and laws[i] is not None]
    if what in LAW_PLACES and len(has) < len(which):
        raise OptionError(f"{what}: crease {min({*which} - {*has}) + 1} has no hinge law")
    if what in ("ratio", "stiffness", "rest_angles") and has:
        why = "has a hinge law in place of a spring: write law_scale[1], law_shift[1]"
        raise OptionError(f"{what}: crease {has[0] + 1} {why}")


LAW_KEY = "edges_origaminlp:law"
"""Key of FOLD: the number of each edge's law (from 0), null for a linear spring."""
LAWS_KEY = "origaminlp:laws"
"""Key of a frame of FOLD: its laws, each a name and what `read_law` reads."""


def laws_to_fold(laws: Laws, others: int) -> dict[str, Any]:
    """Return laws as keys of FOLD, for creases and then `others` edges without; nothing where there are no laws.

    Parameters
    ----------
    laws
        Of the creases.
    others
        Edges that follow.

    Returns
    -------
    dict
        Number of the law of each edge, and the laws.
    """
    if not laws:
        return {}
    every = list(dict.fromkeys(filter(None, laws)))
    return {
        LAW_KEY: [*(None if law is None else every.index(law) for law in laws), *[None] * others],
        LAWS_KEY: [{"name": law.name, **law_to_dict(law)} for law in every],
    }


def edge_laws(frame: Mapping[str, Any], edges: int, keep: np.ndarray) -> Laws:
    """Read the laws of some edges of a frame of FOLD; () where it states none.

    Parameters
    ----------
    frame
        As in the file.
    edges
        How many there are.
    keep
        Edges wanted.

    Returns
    -------
    tuple
        A law, or None, for each.

    Raises
    ------
    FoldFileError
        If they do not fit.
    """
    if LAW_KEY not in frame:
        return ()
    numbers, stated = frame[LAW_KEY], frame.get(LAWS_KEY, [])
    tables = isinstance(stated, list) and all(isinstance(table, Mapping) for table in stated)
    if not isinstance(numbers, list) or len(numbers) != edges or not tables:
        many = f"{edges} numbers of laws, or null, and {LAWS_KEY} a list of tables"
        raise FoldFileError(f"{LAW_KEY} must be a list of {many}")
    laws = []
    for k, table in enumerate(stated):
        try:
            law = {key: value for key, value in table.items() if key != "name"}
            laws.append(read_law(law, printable(str(table.get("name", f"law {k}")))))
        except OrigamiError as error:
            raise FoldFileError(f"{LAWS_KEY}[{k}]: {error}") from None
    for e, number in enumerate(numbers):
        if number is not None:
            check_whole(f"{LAW_KEY}[{e}]", number, 0, len(laws) - 1, FoldFileError)
    return tuple(None if numbers[e] is None else laws[numbers[e]] for e in keep.tolist())


def seen_laws(laws: Laws, over: bool, share: float = 1.0) -> Laws:
    """Return laws as they are seen from the other side of the paper, times a share.

    Parameters
    ----------
    laws
        Of creases.
    over
        Whether the paper is turned over.
    share
        Factor of their torques.

    Returns
    -------
    tuple
        In the same order.
    """
    return tuple(law and (law.turned() if over else law).times(share) for law in laws)


def same_laws(one: Laws, two: Laws) -> bool:
    """Return whether laws are equal up to rounding: pieces and torques.

    Parameters
    ----------
    one, two
        Laws of creases.

    Returns
    -------
    bool
        Whether each has its like in the same place.
    """
    return len(one) == len(two) and all(
        a is b or (a is not None and b is not None and a.equals(b))
        for a, b in zip(one, two, strict=True)
    )


def read_torque_bounds(given: Any, creases: int, what: str) -> np.ndarray:
    """Return a bound of the torque at which each crease yields.

    Parameters
    ----------
    given
        One for all creases [N m], a list with None for those that have none, or a mapping from numbers (1-based).
    creases
        How many there are.
    what
        Name of the argument.

    Returns
    -------
    numpy.ndarray
        Bounds [N m], inf where there is none, [N].

    Raises
    ------
    OptionError
        If it is none of these, or a bound is not positive.
    """
    if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str):
        if len(given) != creases:
            each = f"one number [N m], or one or None for each of {creases} creases"
            raise OptionError(f"{what} = {shown(given)} must be {each}")
        given = {i: t for i, t in enumerate(given, start=1) if t is not None}
    elif not isinstance(given, Mapping):
        given = dict.fromkeys(range(1, creases + 1), given)
    out = np.full(creases, np.inf)
    for i, t in given.items():
        at = check_whole(f"{what}: crease", i, 1, creases) - 1
        out[at] = check_number(f"{what} of crease {i}", t, 0.0)
    return out


def most_torque(stiffness: Sequence[float], laws: Laws) -> float:
    """Return a torque beyond which springs and laws no longer matter: what would turn all of them once round.

    Parameters
    ----------
    stiffness
        Of all creases [N m/rad].
    laws
        Of all creases, or none.

    Returns
    -------
    float
        Torque [N m].
    """
    if not laws:
        return 2 * math.pi * sum(stiffness)
    each = zip(stiffness, laws, strict=True)
    return float(sum(2 * math.pi * k if law is None else law.most for k, law in each))


def law_probes(laws: Laws, over: bool, scale: float) -> np.ndarray:
    """Return numbers by which laws are distinguished whatever creases are called: torques at some angles.

    Parameters
    ----------
    laws
        Of creases.
    over
        Whether the paper is turned over.
    scale
        What torques are divided by [N m].

    Returns
    -------
    numpy.ndarray
        Shape [n, P]; empty without laws.
    """
    if not laws:
        return np.zeros((0, 0))
    side = -1.0 if over else 1.0
    rows = [
        np.zeros(len(PROBES)) if law is None else side * law.torque(side * PROBES) for law in laws
    ]
    return np.array(rows) / scale


def law_numbers(laws: Laws) -> list[list[float]]:
    """Return numbers that are equal where laws are, a row of them; none where there are no laws."""
    every = list(dict.fromkeys(laws))
    return [[float(every.index(law)) for law in laws]] if laws else []


def energy_with_laws(
    phi: np.ndarray, k: np.ndarray, rest: np.ndarray, laws: Laws, preload: Sequence[float] = ()
) -> np.ndarray:
    """Return the elastic energy of states, springs and laws, these less preload . phi.

    Parameters
    ----------
    phi
        Fold angles of states [..., N] [rad].
    k, rest
        Of linear springs [N] [N m/rad, rad].
    laws
        In their place; none: ().
    preload
        Torques that act beside laws [N m], or ().

    Returns
    -------
    numpy.ndarray
        Energies [...] [J].
    """
    energy = 0.5 * k * (phi - rest) ** 2
    for i, law in enumerate(laws):
        if law is not None:
            x = phi[..., i]
            energy[..., i] = law.energy(x) - (preload[i] if preload else 0.0) * x
    return np.asarray(energy.sum(axis=-1))
