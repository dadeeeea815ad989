from .driver import VertexDriver as VertexDriver
from .figure import draw_load as draw_load
from .find import load_path as load_path
from .interactive import view_path as view_path
from .pattern_driver import PatternDriver as PatternDriver
from .records import (
    ConfirmedSnap as ConfirmedSnap,
    Leg as Leg,
    LoadPoint as LoadPoint,
    Snap as Snap,
)
from .result import LoadPath as LoadPath
