"""Speed against error, `python -m benchmarks`: `search` (found against seconds), `engines`, `patterns`, `hard`.

`families` says which scenes, `rivals` are the searches of others, `reference` solves to 50 digits, `records` holds what
was measured for the documentation.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
