"""Miura sheet: its vertices may fold in other modes as well."""

import origami_nlp as o

found = o.find_minima("miura:2x3", starts=4)
for state in found.minima:
    print(state.energy, state.kind, state.escape.barrier)
o.draw(found, "miura_sheet.png")
