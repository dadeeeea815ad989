"""A pattern as a problem: fold angles that close round vertices and holes, facets in space, touches, layers."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
