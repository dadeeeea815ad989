"""Completeness as a theorem: every critical point of a scene, by interval arithmetic over all of its fold angles."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
