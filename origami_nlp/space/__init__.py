"""The admissible space of a scene: pieces, holes, and how they change with the sector angle."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
