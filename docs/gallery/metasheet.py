"""Metasheet: one state held by its springs, one by facets that touch."""

import origami_nlp as o

found = o.find_minima("metasheet:4x4", starts=0)
for state in found.minima:
    print(state.energy, state.kind, [(c.text, c.multiplier_range) for c in state.contacts])
o.draw(found, "metasheet.png")
