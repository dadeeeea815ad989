from .animation import check_animation as check_animation, write_animation as write_animation
from .bodies import (
    Body as Body,
    Content as Content,
    Crease as Crease,
    Folded as Folded,
    Line as Line,
    Mark as Mark,
    Panel as Panel,
    Station as Station,
    Track as Track,
)
from .drawing import (
    MOUNTAIN as MOUNTAIN,
    VALLEY as VALLEY,
    Pose as Pose,
    draw_state as draw_state,
    pose_state as pose_state,
)
from .folded_vertex import (
    rotation_onto as rotation_onto,
    vertex_body as vertex_body,
    vertex_folded as vertex_folded,
    vertex_track as vertex_track,
    vertex_view as vertex_view,
)
from .html import inline_image as inline_image
from .plain import (
    check_schema as check_schema,
    from_plain as from_plain,
    pick as pick,
    to_plain as to_plain,
)
from .style import (
    angle_ticks as angle_ticks,
    label_text as label_text,
    pi_label as pi_label,
    short_label as short_label,
)
from .table import (
    Cell as Cell,
    Piece as Piece,
    Table as Table,
    Told as Told,
    Words as Words,
    folding_table as folding_table,
    pieces_html as pieces_html,
    plain_text as plain_text,
    rows_markdown as rows_markdown,
    rows_table as rows_table,
)
from .turned import (
    Turnable as Turnable,
    TurnedPage as TurnedPage,
    check_view as check_view,
    page_data as page_data,
    turned_page as turned_page,
)
