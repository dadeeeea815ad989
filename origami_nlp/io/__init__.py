"""Files and screens: the one reader, the one writer, and the console of every command."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
