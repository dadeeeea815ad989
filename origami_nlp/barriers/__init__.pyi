from .figure import draw_merge_trees as draw_merge_trees, merge_tree_axes as merge_tree_axes
from .find import (
    Barriers as Barriers,
    Pass as Pass,
    check_freedoms as check_freedoms,
    find_barriers as find_barriers,
)
from .table import (
    barriers_to_dict as barriers_to_dict,
    markdown_rows as markdown_rows,
    print_barriers as print_barriers,
)
