from .driver import Driver as Driver
from .figure import draw_load as draw_load
from .find import load_path as load_path
from .fold_out import path_to_fold as path_to_fold, write_path as write_path
from .records import Confirmed as Confirmed, Leg as Leg, LoadPoint as LoadPoint, Snap as Snap
from .result import LoadPath as LoadPath
