"""Whole crease patterns: closure round every vertex and hole, facets that do not cross, stable states."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
