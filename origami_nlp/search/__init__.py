"""One search for stable states: families of starts, descents with an active set, orders of layers as gaps.

| family | its starts |
| --- | --- |
| `Uniform` | any fold angles |
| `FoldedCreases` | some creases fully folded, held until the others are at rest |
| `Touch` | facets that touch, held until the others are at rest |
| `Changed` | a minimum crossed with another, or with one crease folded otherwise |

Listed once: what the file states, branches of flat-folded states, minima with a hinge in another well of its law.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
