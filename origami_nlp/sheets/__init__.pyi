from .branches import Branches as Branches, list_branches as list_branches
from .closure import Closure as Closure
from .crossings import Crossings as Crossings, convex_parts as convex_parts
from .curve import (
    Curve as Curve,
    follow_curve as follow_curve,
    tangents as tangents,
    wells as wells,
)
from .descent import Descended as Descended, descend as descend
from .find import find_states as find_states
from .judgement import judge as judge
from .layers import Layers as Layers, order_layers as order_layers, overlaps as overlaps
from .pinned import Pinned as Pinned, find_pinned as find_pinned, judge_pinned as judge_pinned
from .poses import Poses as Poses
from .result import SheetResult as SheetResult, SheetSearch as SheetSearch
from .sheet import Sheet as Sheet
from .state import SheetContact as SheetContact, SheetState as SheetState
from .touches import Touch as Touch, find_touch as find_touch
