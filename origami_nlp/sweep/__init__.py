"""Many scenes: a sweep over parameters, run on any executor, stored as it goes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
