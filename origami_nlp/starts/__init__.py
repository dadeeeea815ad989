"""Where searches start: all with the interface of `StartFamily`, drawn in `rounds` for a vertex.

| family | of | its starts |
| --- | --- | --- |
| `Corners` | vertex | where fold limits leave no degree of freedom |
| `Interior` | vertex | with nothing closed |
| `NearCorners` | vertex | corners with some of their creases let go |
| `Strata` | vertex | with random creases at their fold limits |
| `Touches` | vertex | where creases touch facets |
| `Moments` | vertex | where creases balance a random moment |
| `Projected` | vertex | random fold angles, projected onto closure |
| `NearFlat` | vertex | where second order puts a minimum beside the flat state |
| `NearFolded` | vertex | where second order puts a minimum beside a flat folding |
| `FlatFoldings` | vertex | every fold angle 0 or +-pi |
| `HingeSets` | vertex | lowest of all that hinge about one line |
| `RigidStates` | vertex | isolated states of models without degrees of freedom |

`samples` are states with the contacts that they hold, `closing` brings them onto closure and these contacts, and
`crossings` finds where facets cross; `contact_strata` lists the strata with touches, which `pinches` closes.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
