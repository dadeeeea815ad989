"""What exists only for the source paper's families: uniform cones, and where the space of a family changes.

>>> from origami_nlp.paper import cone
>>> cone.count(8, ratio=1.0, elevation=0.5).stable_interior
16

`cone` counts, maps and draws the states of cones of any even degree; `find_transitions` sweeps the sector angle of
the paper's vertices of degree 6 and 8.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
