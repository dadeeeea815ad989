"""Barriers: the lowest passes between states, as a disconnectivity graph."""

import origami_nlp as o

found = o.find_minima("metasheet:2x3", escape=False)
barriers = o.find_barriers(found.pattern, found)
for a in barriers.passes:
    print(a.from_state, a.to_state, a.energy, a.pass_kind)
o.draw(barriers, "barrier_graph.png")
