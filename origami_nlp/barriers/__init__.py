"""Energy barriers between minima: passes, merge tree, bounds without the symmetry."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
