"""A pattern, however it is stated: itself, the name of an example, or a FOLD file."""

from __future__ import annotations

from pathlib import Path

from origami_nlp.arguments import check_type
from origami_nlp.pattern import examples
from origami_nlp.pattern.pattern_file import read_pattern
from origami_nlp.pattern.sheet import Pattern


def as_pattern(stated: Pattern | str | Path, name: str = "pattern") -> Pattern:
    """Return a pattern, however it is stated.

    Parameters
    ----------
    stated
        The pattern itself, the name of an example with its size, such as ``"miura:4x6"``, or a FOLD file.
    name
        Of the argument, for what is said of a wrong one.

    Returns
    -------
    Pattern
        The sheet with its springs.

    Raises
    ------
    OptionError
        If it is neither of these, or the example has no such size.
    FoldFileError
        If the file is no FOLD file, or its frame is no sheet of rigid facets.

    Examples
    --------
    >>> from origami_nlp.pattern import as_pattern
    >>> as_pattern("metasheet:2x3")
    Pattern('metasheet': 6 facets, 7 creases, 2 interior vertices)
    """
    if isinstance(stated, str) and stated.partition(":")[0] in {
        **examples.BY_NAME,
        **examples.SHEETS,
    }:
        return examples.pattern(stated)
    if isinstance(stated, str | Path):
        return read_pattern(stated)
    check_type(name, stated, Pattern)
    return stated
