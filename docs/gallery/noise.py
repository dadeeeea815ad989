"""Noise: which states survive errors of angles and stiffnesses."""

import numpy as np

import origami_nlp as o

errors = np.random.default_rng(1).normal(scale=0.001, size=6)
rest = np.radians([-90, 90, 90, -90, 90, 90]) + errors
exact = o.examples.waterbomb(symmetry="none")
found = o.find_minima(o.Scene(exact.vertex, exact.stiffness, rest, "none"), noise=0.1, prove=False)
for state in found.minima:
    print(state.energy, state.shallow, state.survival)
o.draw(found, "noise.png")
