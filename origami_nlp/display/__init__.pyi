from .bodies import (
    Body as Body,
    Content as Content,
    Crease as Crease,
    FoldedBody as FoldedBody,
    Keyframe as Keyframe,
    Mark as Mark,
    Trajectory as Trajectory,
)
from .crease_figure import draw_creases as draw_creases, draw_pattern as draw_pattern
from .flags import Flags as Flags, FlagText as FlagText
from .interactive import (
    InteractivePage as InteractivePage,
    Viewable as Viewable,
    interactive_page as interactive_page,
    page_data as page_data,
)
from .labels import label_marks as label_marks
from .painter import (
    crease_legend as crease_legend,
    draw_state as draw_state,
    line_scale as line_scale,
)
from .papers import pattern_view as pattern_view
from .posing import Poser as Poser, join_states as join_states, rotation_onto as rotation_onto
from .records import (
    Shown as Shown,
    record_row as record_row,
    shown as shown,
)
from .result import Result as Result, angle_columns as angle_columns, read_data as read_data
from .springs import Spring as Spring, springs_of as springs_of
from .states_figure import (
    MOST_DRAWN as MOST_DRAWN,
    WIDTH as WIDTH,
    add_heading as add_heading,
    cell_size as cell_size,
    draw_states as draw_states,
    lay_out_states as lay_out_states,
)
from .style import (
    BORDER as BORDER,
    FLAT as FLAT,
    HANDLE as HANDLE,
    INK as INK,
    INKS as INKS,
    KINDS as KINDS,
    LOWER as LOWER,
    METASTABLE as METASTABLE,
    MOUNTAIN as MOUNTAIN,
    PASSES as PASSES,
    UPPER as UPPER,
    VALLEY as VALLEY,
    VERDICTS as VERDICTS,
    WARNING as WARNING,
    energy_colours as energy_colours,
    mark_minimum as mark_minimum,
    minima_legend as minima_legend,
    pass_look as pass_look,
    passes_legend as passes_legend,
    patch as patch,
)
from .table import (
    Cell as Cell,
    Details as Details,
    Report as Report,
    Section as Section,
    Table as Table,
    Words as Words,
    field_table as field_table,
    pieces_html as pieces_html,
    record_table as record_table,
)
from .text import (
    angle_ticks as angle_ticks,
    label_text as label_text,
    subscript as subscript,
)
from .touches import contact_places as contact_places
