"""What the contacts of a pinned state carry: moments, margins, force cones, metastable segments."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
