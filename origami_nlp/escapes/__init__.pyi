from .escape import (
    ALONE as ALONE,
    BOUND as BOUND,
    OPEN as OPEN,
    TRACED as TRACED,
    Escape as Escape,
    EscapePath as EscapePath,
    Method as Method,
    barriers as barriers,
    level_of as level_of,
    rounded_up as rounded_up,
)
from .find import (
    MOST_CREASES as MOST_CREASES,
    Move as Move,
    find_escapes as find_escapes,
    images_of as images_of,
    is_first as is_first,
)
from .paths import (
    down_to as down_to,
    escape_paths as escape_paths,
    escape_paths_of_each as escape_paths_of_each,
    highest as highest,
    rays as rays,
)
from .terrain import (
    Terrain as Terrain,
    energy_scale as energy_scale,
    number_of as number_of,
)
