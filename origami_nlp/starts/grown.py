"""States of a pattern grown out of the flat one, and the families that are drawn in turn with it."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.facets import Labels, Sheet
from origami_nlp.numerics import CLOSES, RESOLVED
from origami_nlp.starts.family import StartFamily
from origami_nlp.starts.samples import Samples
from origami_nlp.starts.uniform import Uniform, UniformShut


class Grown(StartFamily):
    """States that steps along what closure leaves free reach from the flat one.

    Parameters
    ----------
    sheet
        Of a pattern that is flat at zero.
    labels
        Of the pattern: directions are drawn in their order.
    """

    name = "grown"
    sentence = "grown out of the flat state"

    def __init__(self, sheet: Sheet, labels: Labels) -> None:
        self._sheet, self._labels = sheet, labels

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Grow states one after the other."""
        x = [self._grown(rng) for _ in range(many)]
        return Samples.at_limits(np.array(x).reshape(many, self._sheet.size))

    def _grown(self, rng: np.random.Generator) -> np.ndarray:
        sheet = self._sheet
        n = sheet.size
        phi, residual = sheet.project(self._labels.drawn(rng.uniform(-0.3, 0.3, n)))
        way = phi
        for _ in range(int(rng.integers(0, 8))):
            aside = self._labels.drawn(rng.normal(size=n))
            way = sheet.along(phi, way + 0.5 * aside * np.abs(way).max())
            size = float(np.abs(way).max())
            if residual > CLOSES or size < RESOLVED:
                break
            new, residual = sheet.project(phi + 0.3 * way / size)
            if residual > CLOSES or np.abs(new).max() > math.pi or not sheet.closure.on_sheet(new):
                break
            phi = new
        return phi


def families_in_turn(sheet: Sheet, labels: Labels) -> tuple[StartFamily, ...]:
    """Return the families of random starts of a pattern, from which one start each is drawn in turn."""
    anywhere = Uniform(labels)
    grown = Grown(sheet, labels) if sheet.pattern.is_flat else anywhere
    return grown, anywhere, UniformShut(labels)
