"""What steers a proof: none of it is part of what is proved, and all of it of how much is decided."""

from __future__ import annotations

from dataclasses import dataclass

from origami_nlp.arguments import check_whole


@dataclass(frozen=True)
class ProofOptions:
    """How much a proof may look at.

    Attributes
    ----------
    boxes
        Boxes, or intervals of curves, after which it gives up: 10 million take about ten minutes.

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

    def __post_init__(self) -> None:
        check_whole("boxes", self.boxes, 1)
