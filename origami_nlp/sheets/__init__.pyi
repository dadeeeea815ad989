from .closure import Closure as Closure
from .crossings import Crossings as Crossings, convex_parts as convex_parts
from .curve import Curve as Curve, tangents as tangents, wells as wells
from .descent import Descended as Descended, descend as descend
from .poses import Poses as Poses
from .sheet import Sheet as Sheet
