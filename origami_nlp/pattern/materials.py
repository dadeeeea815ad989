"""Hinge materials by name: the stiffness of a crease per length, with where the number comes from.

The package states none itself: plug-ins do (`origami_nlp.materials`), each with its source.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_number, did_you_mean, shown
from origami_nlp.errors import OptionError
from origami_nlp.plugins import plugins

METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "in": 0.0254, "pt": 0.0254 / 72}
"""Length of FOLD's ``frame_unit`` [m]; ``unit`` is none."""


@dataclass(frozen=True)
class Material:
    """Linear torsional stiffness of a hinge per unit length.

    Attributes
    ----------
    stiffness_per_length
        Positive [N m/rad per m of crease, which is N/rad].
    source
        Where the number comes from: a paper, a measurement, or that it is an example.

    Raises
    ------
    OptionError
        If the stiffness is not positive and finite, or no source is stated.

    Examples
    --------
    >>> from origami_nlp.pattern import Material
    >>> Material(0.01, "an example, not measured").stiffness_per_length
    0.01
    """

    stiffness_per_length: float
    source: str

    def __post_init__(self) -> None:
        check_number("stiffness_per_length", self.stiffness_per_length)
        if not 0 < self.stiffness_per_length < math.inf:
            raise OptionError(
                f"stiffness_per_length = {self.stiffness_per_length:g} must be positive and finite [N/rad]"
            )
        if not (isinstance(self.source, str) and self.source.strip()):
            raise OptionError(f"source = {shown(self.source)} must say where the number comes from")


def find_material(name: str) -> Material:
    """Return a material of a plug-in.

    Parameters
    ----------
    name
        Of an entry point in the group ``origami_nlp.materials``, which names a `Material` or a function that makes one.

    Returns
    -------
    Material
        With its source.

    Raises
    ------
    OptionError
        If there is none of this name, or its plug-in is broken.

    Examples
    --------
    >>> from origami_nlp.pattern import find_material
    >>> try:
    ...     find_material("nobody made this")
    ... except ValueError as error:
    ...     print(str(error).partition(":")[0])
    stiffness = 'nobody made this' is no number, and no material
    """
    known = plugins("material")
    if name not in known:
        listed = (
            f"installed are {', '.join(known)}" if known else "no plug-in with one is installed"
        )
        raise OptionError(
            f"stiffness = {shown(name)} is no number, and no material: {listed}{did_you_mean(name, known)}"
        )
    plugin = known[name]
    made = plugin.load()
    material = made if isinstance(made, Material) else plugin.call() if callable(made) else made
    if not isinstance(material, Material):
        raise plugin.broken("is wrong", f"{type(material).__name__} instead of a Material")
    return material


def material_springs(material: Material, lengths: np.ndarray, unit: str) -> np.ndarray:
    """Return the stiffness [N m/rad] of creases of some lengths, [n], in FOLD's ``frame_unit``, else in metres."""
    return material.stiffness_per_length * METRES.get(unit, 1.0) * lengths


def material_words(material: Material, unit: str) -> str:
    """Say in a line which stiffness creases have of a material, and in which unit their lengths were read."""
    number = f"{material.stiffness_per_length:g} N/rad times their length"
    lengths = (
        "" if unit in METRES else "; lengths are taken as metres: the file states no frame_unit"
    )
    return f"creases without a stiffness: {number} ({material.source}){lengths}"
