"""Tables, plain data, styles and drawings that every room uses; nothing here knows a result."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
