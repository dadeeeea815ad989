from .drawing import (
    MOUNTAIN as MOUNTAIN,
    VALLEY as VALLEY,
    Pose as Pose,
    draw_state as draw_state,
    pose_state as pose_state,
)
from .style import plain as plain
from .table import (
    folding_table as folding_table,
    plain_text as plain_text,
    rows_markdown as rows_markdown,
    rows_table as rows_table,
)
