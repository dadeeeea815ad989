"""Kresling tube: rigid facets have isolated states only.

No motion leads from one height to the other (dof 0), nor to the tubes turned inside out, of negative height.
"""

import numpy as np

import origami_nlp as o
from origami_nlp.pattern import make_cell

turn, height = np.radians(45), 1.2  # of one ring of six triangles over the last
b, c = (height**2 + (2 * np.sin(t / 2)) ** 2 for t in (turn, turn + np.pi / 3))
x = (c - b - 1) / 2
corners = [[0, 0], [1, 0], [x, y := np.sqrt(b - x * x)], [x + 1, y]]
cell = make_cell(corners, [(0, 1, 3), (0, 3, 2)], [[1, 0], [x, y]], rolled=(6, 0))
found = o.find_minima(cell)
for state, tube in zip(found.minima, found.lattices, strict=True):
    print(state.dof, tube.turns[1], tube.advances[1])
o.draw(found, "kresling_tube.png")
