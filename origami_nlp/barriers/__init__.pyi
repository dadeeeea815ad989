from .figure import draw_barriers as draw_barriers, merge_tree_axes as merge_tree_axes
from .find import check_freedoms as check_freedoms, find_barriers as find_barriers
from .passes import Pass as Pass
from .result import (
    Barriers as Barriers,
    barriers_table as barriers_table,
)
from .turned import add_passes as add_passes
