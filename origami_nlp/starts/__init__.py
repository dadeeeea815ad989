"""Where searches start: one file a family of starts, drawn, listed, or beside a singular state.

| file | where its starts lie |
| --- | --- |
| `rounds` | the families of a vertex in rounds, with how many of each |
| `touches` | on strata where creases touch facets (`touch_strata` lists them, `pinches` closes them) |
| `moments` | where creases balance random moments |
| `near_flat`, `near_folded` | beside the flat state and flat foldings, where second order puts a minimum |
| `foldings`, `hinge_sets`, `rest`, `rigid` | exact states: flat foldings, lowest on hinges, rest state, isolated ones |
| `projected`, `on_limits` | random fold angles, projected onto closure; with one or two creases shut |

`samples` are states with the contacts that they hold, `closing` brings them onto closure and these contacts, and
`crossings` tells where facets cross.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
