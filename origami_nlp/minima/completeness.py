"""What is proved about a list of minima, and the words for it.

The words are chosen with care: *complete* stands nowhere else than at a proof that left nothing open.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.io import ShortRepr
from origami_nlp.proof import ProofOptions


def check_prove(name: str, value: object) -> None:
    """Raise an error for what is neither None, a flag, a positive number of seconds nor `ProofOptions`.

    Raises
    ------
    OptionError
        With the name, the value and what it must be.
    """
    if not (value is None or isinstance(value, bool | np.bool_ | ProofOptions)):
        check_number(name, value, 0.0, math.inf)


@dataclass(frozen=True, repr=False)
class Open(ShortRepr):
    """A region of fold angles that a proof leaves open, or closes by another argument.

    Attributes
    ----------
    lower, upper
        All N fold angles lie between [rad].
    energy
        In the middle, in the scene's units.
    reason
        Why it is open.
    verdict
        What the state in it was judged to be, by another argument than the proof's; "" where there is none.
    isolated
        Why there is no critical point in it but that state, as far as that is proved; "" where it is not.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    energy: float
    reason: str
    verdict: str = ""
    isolated: str = ""


@dataclass(frozen=True, repr=False)
class Added(ShortRepr):
    """A minimum that the proof found and the search had not.

    Attributes
    ----------
    energy
        In the scene's units.
    fold_angles
        All N [rad].
    """

    energy: float
    fold_angles: tuple[float, ...]


@dataclass(frozen=True, repr=False)
class Completeness(ShortRepr):
    """Whether a list of minima is complete, as a theorem.

    Attributes
    ----------
    status
        ``"proved"``; ``"proved-except-singular"``: but for the flat foldings and other states of `singular`, judged by
        their cones; ``"not-proved"``.
    reason
        Why it is not proved; "" where it is.
    boxes
        Boxes of fold angles that were examined.
    seconds
        What that took, of wall time.
    critical_points
        How many states are stationary, by index (how many directions lower the energy to second order): "0", "1", ...;
        "unclear" where that, or whether a limit is pushed, is not certified.  Each exists, and outside the regions
        below there are no others.
    held
        How many more are stationary only while contacts are held that they would leave.
    minima
        How many are listed, added ones included.
    undecided
        Where minima may be that are not listed.
    singular
        States at which the creases lose rank, flat foldings above all, each judged by its cone of directions;
        `Open.isolated` where one is shown to stand alone (the flat state).
    added
        Minima that the search had not found.
    over
        Over which states the statement ranges, where a symmetry is imposed; "": over all closed states that the
        contact of the scene admits.

    Examples
    --------
    >>> import origami_nlp as o
    >>> scene = o.examples.degree6("pi/4", ratio=1, contact="fold-limits")
    >>> o.find_minima(scene, prove=True).completeness.status
    'proved-except-singular'
    """

    status: str
    reason: str = ""
    boxes: int = 0
    seconds: float = 0.0
    critical_points: dict[str, int] = field(default_factory=dict)
    held: int = 0
    minima: int = 0
    undecided: tuple[Open, ...] = ()
    singular: tuple[Open, ...] = ()
    added: tuple[Added, ...] = ()
    over: str = ""

    @property
    def proved(self) -> bool:
        """Whether nothing was left open."""
        return self.status == "proved"

    def open_lines(self) -> Iterator[str]:
        """Say what is not proved in a line each; `lines` say where."""
        if self.status == "not-proved":
            yield f"not proved that the list is complete: {self.reason}"
        if open_ := [s for s in self.singular if not s.isolated]:
            energies = [s.energy for s in open_]
            judged = ", each judged by another argument" * all(s.verdict for s in open_)
            yield (
                f"not proved near {_states(len(open_))}{judged}, energies {min(energies):.6g} to "
                f"{max(energies):.6g} J"
            )

    def lines(self) -> Iterator[str]:
        """Say it, a few lines."""
        work = f"{self.boxes:,} boxes, {self.seconds:.1f} s"
        if self.status == "not-proved":
            yield f"not proved: {self.reason}" + (f" ({work})" if self.boxes else "")
        else:
            alone = [s for s in self.singular if s.isolated]
            but = (
                ""
                if self.proved
                else f" but for {_states(len(self.singular) - len(alone))}, judged by their cones (below)"
            )
            listed = "the one minimum is" if self.minima == 1 else f"all {self.minima} minima are"
            yield f"complete: proved{but}: {listed} listed ({work})"
            if self.over:
                yield f"  {self.over}"
            many = ", ".join(
                f"{n} judged by its cone" if k == "unclear" else _of_index(n, k)
                for k, n in self.critical_points.items()
            )
            still = sum(self.critical_points.values())
            yield (
                f"  {still} regular critical point{'s' * (still != 1)} ({many}), {self.held} more with active contacts"
            )
            if alone:
                apart = max(u - v for s in alone for u, v in zip(s.upper, s.lower, strict=True)) / 2
                beyond = f" beyond {apart:.0e} rad" * (apart > 0)
                yield f"  {_states(len(alone))}, each shown to stand alone{beyond} and judged by its cone"
        for new in self.added:
            angles = " ".join(f"{a:.3f}" for a in np.round(np.degrees(new.fold_angles), 3) + 0.0)
            yield f"a minimum that the search had missed, found by the proof: {new.energy:.9g} J at {angles} deg"
        if not self.proved:
            yield from self._regions()

    def _regions(self, most: int = 8) -> Iterator[str]:
        open_ = [s for s in self.singular if not s.isolated]
        for name, regions in (("singular", open_), ("left open", self.undecided)):
            for r in regions[:most]:
                middle = 0.5 * (np.array(r.lower) + np.array(r.upper))
                width = float(np.max(np.array(r.upper) - np.array(r.lower)))
                angles = " ".join(f"{a:.4f}" for a in np.round(np.degrees(middle), 4) + 0.0)
                verdict = f"; judged: {r.verdict}" * bool(r.verdict)
                yield f"  {name}: within {width:.1g} rad of {angles} deg, {r.energy:.6g} J: {r.reason}{verdict}"
            if len(regions) > most:
                energies = [r.energy for r in regions]
                yield (
                    f"  and {len(regions) - most} more {name}, energies {min(energies):.6g} to {max(energies):.6g} J"
                )


def _of_index(many: int, index: str) -> str:
    """Name critical points by how many directions lower the energy to second order."""
    return f"{many} " + {
        "0": "minim" + ("um" if many == 1 else "a"),
        "1": "saddle" + "s" * (many != 1),
    }.get(index, f"of index {index}")


def _states(many: int) -> str:
    return f"{many} singular state{'s' * (many != 1)}"
