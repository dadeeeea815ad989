from .branches import Branches as Branches, list_branches as list_branches
from .closure import Closure as Closure
from .counts import (
    Overview as Overview,
    jacobian_rank as jacobian_rank,
    overview as overview,
)
from .crossings import Crossings as Crossings, convex_parts as convex_parts
from .curve import (
    Curve as Curve,
    follow_curve as follow_curve,
    tangents as tangents,
    wells as wells,
)
from .descent import Descended as Descended, descend as descend
from .drawing import (
    draw_motion as draw_motion,
    draw_overview as draw_overview,
    draw_sheet as draw_sheet,
    draw_states as draw_states,
    sheet_view as sheet_view,
)
from .find import find_states as find_states
from .fold_out import (
    sheet_frame as sheet_frame,
    sheet_to_fold as sheet_to_fold,
    write_sheet_mesh as write_sheet_mesh,
)
from .judgement import judge as judge
from .layers import Layers as Layers, order_layers as order_layers, overlaps as overlaps
from .motion import Motion as Motion, find_motion as find_motion
from .pinned import Pinned as Pinned, find_pinned as find_pinned, judge_pinned as judge_pinned
from .poses import Poses as Poses
from .result import SheetResult as SheetResult, SheetSearch as SheetSearch
from .sheet import Sheet as Sheet
from .state import SheetContact as SheetContact, SheetState as SheetState
from .touches import Touch as Touch, find_touch as find_touch
from .turnable import sheet_content as sheet_content
