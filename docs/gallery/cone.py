"""Cone: the share of folding branches that hold a minimum, as a phase diagram."""

from origami_nlp.paper import cone

count = cone.count(8, ratio=2, elevation=0.3)
print(count)
diagram = cone.phase_diagram(8, size=24)
cone.draw_phase(diagram).savefig("cone.png", dpi=100)
