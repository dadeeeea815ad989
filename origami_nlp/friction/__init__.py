"""Friction: regions of states that hinges hold, and what contacts must bear."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
