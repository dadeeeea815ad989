"""What steers a search for minima: how many starts of each kind, when it stops, and what it does up to which size."""

from __future__ import annotations

from dataclasses import dataclass

from origami_nlp.arguments import check_type, check_whole
from origami_nlp.errors import OptionError
from origami_nlp.pattern_problem import PatternProblem

CHEAP, CHEAPER = 15, 24
"""Creases of a problem below which starts cost so little that more are made; of one whose facets may cross."""
DEAR = 40
"""Creases above which starts cost so much that fewer are made: each takes their number cubed."""
MOST_DOF, MOST_MORE = 12, 5
"""Degrees of freedom that count, and up to which each counts the more the more there are, from three on."""


@dataclass(frozen=True)
class SearchOptions:
    """How much a search does; `EFFORTS` holds those of ``effort="quick"``, ``"normal"`` and ``"thorough"``.

    Attributes
    ----------
    in_a_row
        Random starts in a row that find nothing new, for each degree of freedom, then no more are made; more where
        there are few creases, most so with three degrees of freedom and more, and fewer where there are many.
    most_drawn
        Random starts in all, over `in_a_row`.
    most_on
        Starts from minima with a hinge in another well of its law, in all.
    most_traced
        Creases up to which curves are traced; descents beyond.
    most_curves
        Curves that are traced, beside images of them.

    Raises
    ------
    OptionError
        If a field is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3"), options=o.SearchOptions(in_a_row=20), escape=False)
    >>> result.search.effort, len(result.minima)
    ('own options', 4)
    """

    in_a_row: int = 60
    most_drawn: int = 10
    most_on: int = 3000
    most_traced: int = 250
    most_curves: int = 64

    def __post_init__(self) -> None:
        from_zero = "in_a_row", "most_on", "most_traced", "most_curves"
        for name, value in vars(self).items():
            check_whole(name, value, 0 if name in from_zero else 1)

    def random_starts(
        self, starts: int | None, max_starts: int | None, problem: PatternProblem
    ) -> tuple[int, int]:
        """Return how many random starts in a row find nothing new, and how many are drawn at most.

        Parameters
        ----------
        starts, max_starts
            As asked for; None: what the options say.
        problem
            Whose degrees of freedom and creases count.

        Returns
        -------
        starts, most : int
            Both at least 0.

        Raises
        ------
        OptionError
            If one is no such number.
        """
        if starts is None:
            cheap = CHEAP if problem.contact else CHEAPER
            dof, share = min(max(problem.dof, 1), MOST_DOF), cheap / problem.pattern.creases
            more = max(share - 1.0, 0.0) * max(1.0, min(dof, MOST_MORE) / 2)
            fewer = min(DEAR / problem.pattern.creases, 1.0)
            starts = int(self.in_a_row * dof * (1.0 + more) * fewer)
        check_whole("starts", starts, 0)
        if max_starts is None:
            return starts, self.most_drawn * starts
        return starts, check_whole("max_starts", max_starts, 1)


EFFORTS = {
    "quick": SearchOptions(in_a_row=10),
    "normal": SearchOptions(),
    "thorough": SearchOptions(in_a_row=160),
}
"""By name."""
OWN = "own options"
"""The effort of a search whose options were given."""


def options_of(effort: object, options: SearchOptions | None = None) -> SearchOptions:
    """Return options, or those of an effort by its name where none are given.

    Raises
    ------
    OptionError
        If there is no such effort, or the options are not valid.
    """
    if options is not None:
        check_type("options", options, SearchOptions)
        return options
    if not isinstance(effort, str) or effort not in EFFORTS:
        raise OptionError(f"effort = {effort!r} is unknown: use one of {', '.join(EFFORTS)}")
    return EFFORTS[effort]
