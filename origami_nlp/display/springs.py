"""The springs of an origami, a record a crease."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import zip_longest

from origami_nlp.display.records import shown
from origami_nlp.pattern import Pattern, Scene


@dataclass(frozen=True)
class Spring:
    """The spring of a crease; of a hinge law its name alone.

    Attributes
    ----------
    crease
        From 1.
    sector
        From it to the next crease, of a vertex [rad].
    stiffness, rest_angle
        Of a linear spring [N m/rad], [rad].
    preload
        Of a wound one [N m].
    stops
        Fold limits [rad].
    law
        Name of its hinge law.
    """

    crease: int = field(metadata=shown("crease"))
    sector: float | None = field(metadata=shown("sector to the next", "rad", ".7g"))
    stiffness: float | None = field(metadata=shown("stiffness", "N m/rad", ".5g", missing=""))
    rest_angle: float | None = field(metadata=shown("rest angle", "rad", ".7g", missing=""))
    preload: float | None = field(metadata=shown("preload", "N m", ".5g"))
    stops: tuple[float, float] | None = field(metadata=shown("stops", "rad", ".7g", between=" to "))
    law: str | None = field(metadata=shown("law", missing=""))


def springs_of(origami: Scene | Pattern) -> list[Spring]:
    """Return the springs of an origami.

    Parameters
    ----------
    origami
        A vertex or a sheet.

    Returns
    -------
    list of Spring
        One a crease.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.display import springs_of
    >>> [spring.stiffness for spring in springs_of(o.examples.miura())]
    [0.025, 0.025, 0.025, 0.025]
    """
    vertex, preload = getattr(origami, "vertex", None), getattr(origami, "preload", ())
    columns = (
        vertex.sector_angles if vertex else (),
        map(float, origami.stiffness),
        origami.rest.tolist(),
        preload if any(preload) else (),
        origami.limits,
        origami.laws,
    )
    rows = list(zip_longest(*columns))
    return [
        Spring(k, sector, None if law else s, None if law else r, wound, stops, law and law.name)
        for k, (sector, s, r, wound, stops, law) in enumerate(rows, start=1)
    ]
