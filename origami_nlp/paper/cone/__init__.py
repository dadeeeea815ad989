"""Waterbomb cones of any degree: branches, energies, minima of every branch, phase diagrams.

>>> from origami_nlp.paper import cone
>>> found = cone.count(8, ratio=1.0, elevation=0.5)
>>> found.stable_interior, found.branches
(16, 32)
>>> cone.ConeBranch("VVM").fold_angles(0.3).shape
(6,)

`count` counts the minima of all branches at one point, `count_map` over a plane, `phase_diagram` adds the exact
curves (`phase_boundaries`) between which the numbers are constant; `full_space` asks whether a minimum is stable when
the vertex may leave its branch; `foldings` lists what differs.  A cone is given by its degree, or,
with other rules for the rest state and the ends of branches, as a `Cone`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
