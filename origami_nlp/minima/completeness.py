"""What is proved about a list of minima, and the words for it.

The words are chosen with care: *complete* stands nowhere else than at a proof that left nothing open.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.display import Table, field_table, record_table, shown
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
    energy: float = field(metadata=shown("energy", "J", ".6g"))
    reason: str = field(metadata=shown("why"))
    verdict: str = field(default="", metadata=shown("judged otherwise"))
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

    energy: float = field(metadata=shown("energy", "J", ".9g"))
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
        `Open.isolated` where one is shown to stand alone.
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
    'proved'
    """

    status: str
    reason: str = ""
    boxes: int = 0
    seconds: float = field(default=0.0, metadata=shown())
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
        """Say what is not proved, in a line."""
        if self.status == "not-proved":
            yield f"not proved that the list is complete: {self.reason}"
        elif open_ := self._open:
            yield f"singular states near which nothing is proved: {len(open_)}"

    @property
    def _open(self) -> list[Open]:
        return [s for s in self.singular if not s.isolated]

    def report_sections(self) -> Iterator[Table]:
        """Return what was examined, minima that the search had missed, and regions that are left open."""
        yield field_table(self, "proof of completeness")
        for title, some in (
            ("minima that the search had missed", self.added),
            ("singular states, proved but for their neighbourhood", self._open),
            ("regions left open", self.undecided),
        ):
            if some and not (self.proved and some is not self.added):
                yield record_table(some[:8], title)
