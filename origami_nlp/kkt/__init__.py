"""A state of a problem: polished, its multipliers, what kind of point it is, and what lies beside it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
