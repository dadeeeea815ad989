"""What every origami states, one vertex or a sheet; what solves, draws and reports asks no more."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError
from origami_nlp.io import printable
from origami_nlp.pattern.fold_limits import Contact, Limits, limit_angles
from origami_nlp.pattern.hinges_stated import Laws, check_plain_hinges

if TYPE_CHECKING:
    from typing import Self

    from origami_nlp.pattern.relations import Relations


class Origami:
    """An origami with its springs: a `Scene`, which is one vertex, or a `Pattern`.

    Attributes
    ----------
    cell
        Of one that repeats its `Cell`; else None.
    preload, loads
        Of a vertex, see `Scene`.
    panels, adjusted, relations
        Of a vertex, see `Scene`.
    load_lines
        What reports say of preload and forces.
    is_symmetric
        Whether states are asked to keep a symmetry.
    """

    cell: Any = None
    preload: tuple[float, ...] = ()
    loads: tuple[Any, ...] = ()
    fixed_facet: int | None = None
    symmetry: str = "none"
    panels: tuple[float, float] | None = None
    adjusted: float = 0.0
    relations: Relations | None = None
    load_lines: ClassVar[Any] = ()
    is_symmetric: ClassVar[Any] = False
    CONTACTS: ClassVar[tuple[str, ...]] = ()
    contact: Contact
    limits: Limits
    laws: Laws
    name: Any
    group: Any
    stiffness: Any
    rest: Any
    is_flat: Any
    paper: Any
    source: str
    creases: Any

    @property
    def label(self) -> str:
        """The name as it may be shown (`printable`), empty where there is none."""
        return printable(self.name or "")

    @property
    def kind_words(self) -> str:
        """What it is called where it has no name."""
        return "pattern"

    @property
    def title(self) -> str:
        """What reports call it: what was typed, else its name."""
        return printable(self.source) or self.label or self.kind_words

    @property
    def limit_angles(self) -> np.ndarray:
        """Low and high fold limits, [2, n] [rad]; +-pi where none are stated."""
        return limit_angles(self.limits, self.creases)

    def with_contact(self, contact: Contact) -> Self:
        """Return the same origami with another contact.

        Parameters
        ----------
        contact
            ``"full"``, or ``"fold-limits"``: facets may cross; of a scene also ``"none"``.

        Returns
        -------
        Scene or Pattern
            With this one.

        Raises
        ------
        OptionError, SceneError
            If it is none of these.
        """
        if self.CONTACTS and contact not in self.CONTACTS:
            known = " or ".join(map(repr, self.CONTACTS))
            raise OptionError(f"contact = {shown(contact)} must be {known} for a pattern")
        stated: Any = self
        return replace(stated, contact=contact)

    def check_alone(self, what: str) -> None:
        """Raise an error if the origami is a cell that repeats.

        Parameters
        ----------
        what
            Is not modelled of one, in words.

        Raises
        ------
        OptionError
            If it is.
        """
        if self.cell:
            raise OptionError(f"{self.title} is a cell that repeats: {what} is for sheets alone")

    def check_plain_hinges(self, what: str, *, stops: bool = False) -> None:
        """Raise an error where hinge laws are stated, fold limits or a lattice, which `what` does not know.

        Parameters
        ----------
        what
            Of the origami, in words.
        stops
            Whether it knows fold limits.

        Raises
        ------
        OptionError
            If the origami has them, or it is a cell that repeats.
        """
        self.check_alone(what)
        check_plain_hinges(self.laws, () if stops else self.limits, what)
