from .driver import VertexDriver as VertexDriver
from .figure import draw_load as draw_load
from .find import load_path as load_path
from .records import Confirmed as Confirmed, Leg as Leg, LoadPoint as LoadPoint, Snap as Snap
from .result import LoadPath as LoadPath
from .sheet import PatternDriver as PatternDriver
from .turned import turn_path as turn_path
