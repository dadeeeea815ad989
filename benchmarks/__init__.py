"""Speed against error: every method on the same problems, interleaved in one run, against 50 digits.

`problems` states what is solved, `reference` solves it to 50 digits, `methods_*` hold one family of
methods each, `run` interleaves them, `judging` decides what each answer is, `report` and `figure` print and draw.
`scaling` measures time and memory against size; `hard` holds the cases that are hard by construction.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
