"""Load paths: a state under a growing torque or force, through contacts and snaps."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
