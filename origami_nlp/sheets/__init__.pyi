from .closure import Closure as Closure
from .counts import (
    Overview as Overview,
    jacobian_rank as jacobian_rank,
    overview as overview,
)
from .crossings import Crossings as Crossings, convex_parts as convex_parts
from .curve import Curve as Curve, tangents as tangents, wells as wells
from .descent import Descended as Descended, descend as descend
from .drawing import (
    draw_overview as draw_overview,
    draw_sheet as draw_sheet,
    sheet_view as sheet_view,
)
from .judgement import judge as judge
from .layers import Layers as Layers, order_layers as order_layers, overlaps as overlaps
from .poses import Poses as Poses
from .sheet import Sheet as Sheet
from .state import SheetContact as SheetContact, SheetState as SheetState
