"""That a list of minima is complete, by interval arithmetic over all fold angles."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
