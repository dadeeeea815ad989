"""Is a folded state real: all that is wrong with a file, where and by how much; and how many layer orders there are."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
