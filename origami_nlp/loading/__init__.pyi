from .driver import Driver as Driver
from .figure import (
    PICTURE_WIDTH as PICTURE_WIDTH,
    draw_load as draw_load,
    load_height as load_height,
    place_load as place_load,
)
from .find import load_path as load_path
from .records import Confirmed as Confirmed, Leg as Leg, LoadPoint as LoadPoint, Snap as Snap
from .result import LoadedPath as LoadedPath, LoadPath as LoadPath, read_path as read_path
from .turned import turn_loaded as turn_loaded, turn_path as turn_path
