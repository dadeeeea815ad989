"""What steers a proof: none of it is part of what is proved, and all of it of how much is decided."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

from origami_nlp.arguments import check_number, check_whole
from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED, ROUNDED


@dataclass(frozen=True)
class ProofOptions:
    """How far boxes are cut, and how many of them.

    Attributes
    ----------
    boxes
        Boxes within fold limits after which a proof gives up: 10 million take about ten minutes, five times what
        degree 7 needs.
    touching_boxes
        Boxes for all sets of touches together.
    isolated_boxes
        Candidates of a set of touches up to which they are taken for isolated points, and not for a curve.
    batch
        Boxes that are treated together: fewer take longer, more take more memory.
    fewest
        Boxes to which smaller batches are cut before anything is asked of them.
    smallest
        Width [rad] of boxes that are candidates for roots or singular states: all narrower ones are.
    smaller
        Widths [rad], each less than the one before, to which candidates that hold no certified root are cut once more
        where closure has full rank.
    smaller_boxes
        Boxes for each of these.

    Raises
    ------
    OptionError
        If a field is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> vertex = o.Vertex.from_degrees((70, 80, 120, 90))
    >>> scene = o.Scene(vertex, (1, 2, 3, 2), (1, -0.5, 0.3, 0.8), "none", "fold-limits")
    >>> o.find_minima(scene, prove=o.ProofOptions(boxes=1)).completeness.status
    'not-proved'
    """

    boxes: int = 10_000_000
    touching_boxes: int = 1_000_000
    isolated_boxes: int = 5_000
    batch: int = 2_000
    fewest: int = 256
    smallest: float = 1e-5
    smaller: tuple[float, ...] = (1e-7, 1e-9, 1e-11)
    smaller_boxes: int = 20_000

    def __post_init__(self) -> None:
        for name in (
            "boxes",
            "touching_boxes",
            "isolated_boxes",
            "batch",
            "fewest",
            "smaller_boxes",
        ):
            check_whole(name, getattr(self, name), 1)
        check_number("smallest", self.smallest, RESOLVED, 0.1)
        for width in self.smaller:
            check_number("smaller", width, ROUNDED, self.smallest)
        if any(a <= b for a, b in itertools.pairwise((self.smallest, *self.smaller))):
            raise OptionError(
                f"smaller = {self.smaller} must fall from below smallest = {self.smallest:g}"
            )


DEFAULT = ProofOptions()
"""Those of a proof that was asked for without options."""
