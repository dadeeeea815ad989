from .branch import Branch as Branch, Follower as Follower
from .curve import LoadCurve as LoadCurve, LoadedState as LoadedState
from .events import Found as Found
from .figure import draw_sheet_load as draw_sheet_load
from .find import find_load_path as find_load_path
from .loaded import LoadedSheet as LoadedSheet
from .result import SheetLoadPath as SheetLoadPath, path_states as path_states
from .turned import turn_sheet_path as turn_sheet_path
from .work import DeadForce as DeadForce, Pull as Pull, Torque as Torque, Work as Work
