"""A folded vertex in space: where its facets are, whether they cross, how they may be layered."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
