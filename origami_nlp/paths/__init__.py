"""States over a parameter, over two, or under a load: branches, events, snaps, and counts, checked by searches."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
