"""The same vertex under other labels: numbered from elsewhere, the other way round, seen from the other side."""

import itertools
from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Relabelling:
    """start: crease that comes first.  backward: clockwise.  over: mountains are valleys.  factor: of stiffnesses."""

    start: int = 0
    backward: bool = False
    over: bool = False
    factor: float = 1.0

    def creases(self, n):
        return (self.start + (-1 if self.backward else 1) * np.arange(n)) % n

    def facets(self, n):
        return (self.creases(n) - 1) % n if self.backward else self.creases(n)

    def seen(self, phi):
        return (-1 if self.over else 1) * phi[..., self.creases(np.shape(phi)[-1])] + 0.0

    def back(self, x):
        out = np.empty_like(x)
        out[..., self.creases(x.shape[-1])] = -x if self.over else x
        return out

    def of(self, scene):
        made = scene.relabelled(self.creases(scene.degree), -1.0 if self.over else 1.0)
        stiffness = tuple((self.factor * np.array(made.stiffness)).tolist())
        return replace(made, stiffness=stiffness, relations=None)


def every_label(n):
    return [Relabelling(*way) for way in itertools.product(range(n), (False, True), (False, True))]
