"""What a search of a vertex starts from besides `search.Draws`: states that are listed, and random moments.

| family | its states |
| --- | --- |
| `FlatFoldings` | every fold angle 0 or +-pi |
| `HingeSets` | lowest of all that hinge about one line |
| `NearFlat` | where second order puts a minimum beside the flat state |
| `NearFolded` | where second order puts a minimum beside a flat folding |
| `Moments` | where creases balance a random moment, drawn |
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
