"""Yoshimura: a cylinder of six diamonds round, and the same inside out."""

import origami_nlp as o

cell = o.examples.pattern("yoshimura", 1, 1, cell=True, rolled=6)
found = o.find_minima(cell, effort="quick")
for state, tube in zip(found.minima, found.lattices, strict=True):
    print(state.energy, tube.radius, tube.advances[1])
o.draw(found, "yoshimura.png")
