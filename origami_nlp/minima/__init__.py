"""All energy minima of a scene: search, result, full-space verdicts, table, page, figure, FOLD file."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
