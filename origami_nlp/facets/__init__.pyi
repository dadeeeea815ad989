from .borders import Choice as Choice, choices as choices
from .closure import Closure as Closure
from .crossings import (
    Crossings as Crossings,
    convex_parts as convex_parts,
    cross_each_other as cross_each_other,
)
from .equations import (
    MOST_DENSE as MOST_DENSE,
    PatternEquations as PatternEquations,
)
from .faces import Faces as Faces, Lying as Lying
from .features import Features as Features
from .fold_out import (
    sheet_frame as sheet_frame,
    sheet_parts as sheet_parts,
    sheet_to_fold as sheet_to_fold,
    state_frame as state_frame,
    states_to_fold as states_to_fold,
)
from .labels import Labels as Labels, find_labels as find_labels, image as image
from .layers import (
    Layers as Layers,
    check_orders as check_orders,
    order_layers as order_layers,
    round_vertex as round_vertex,
)
from .meeting import touches_at as touches_at
from .posed import independent_rows as independent_rows, pose as pose
from .poses import MOVES as MOVES, Poses as Poses
from .sheet import Sheet as Sheet
from .stacks import Stack as Stack
from .touches import Parallel as Parallel, Placed as Placed, Touch as Touch
from .work import (
    DeadForce as DeadForce,
    Pull as Pull,
    Torque as Torque,
    Work as Work,
    Worked as Worked,
)
