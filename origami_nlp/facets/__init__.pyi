from .borders import Choice as Choice, choices as choices
from .closure import Closure as Closure, Matrix as Matrix
from .crossings import (
    DEEP as DEEP,
    Crossings as Crossings,
    convex_parts as convex_parts,
    cross_each_other as cross_each_other,
)
from .equations import (
    MOST_DENSE as MOST_DENSE,
    OutOfTime as OutOfTime,
    PatternEquations as PatternEquations,
)
from .faces import Faces as Faces, Lying as Lying
from .features import INSIDE as INSIDE, Features as Features
from .layers import (
    Layers as Layers,
    check_orders as check_orders,
    order_layers as order_layers,
    round_vertex as round_vertex,
)
from .linear import Factor as Factor, Normal as Normal, dense as dense
from .meeting import touches_at as touches_at
from .posed import independent_rows as independent_rows, pose as pose
from .poses import Poses as Poses
from .sheet import Sheet as Sheet
from .stacks import Stack as Stack
from .touches import Parallel as Parallel, Placed as Placed, Touch as Touch
