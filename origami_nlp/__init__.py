"""origami_nlp: the stable states of origami, found, classified and proved.

State a `Scene`, then ask: `find_minima(scene)`, `find_barriers`, `find_critical_points`, `find_space`,
`find_landscape`, `find_contacts`, `follow`.  Every result prints itself (as text and in Jupyter), can be drawn
(`draw`), saved (`save`, `load`) and pickled.  `cone` and `sweep` are rooms of their own.  Everything here loads when it
is first used: CasADi, matplotlib and SymPy only when something needs them.

>>> import origami_nlp as o
>>> scene = o.examples.degree6("pi/3", ratio=1)
>>> len(o.find_minima(scene).minima)
4
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
