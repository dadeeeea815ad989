"""A panel of the source paper: energy, contact boundaries, exact minima."""

import origami_nlp as o

found = o.find_minima(o.examples.degree6("pi/3", ratio=1), full=True)
for state in found.minima:
    print(state.energy, state.kind, state.full_space.verdict)
o.draw(found, "paper_panel.png")
