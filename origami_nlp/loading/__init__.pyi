from .driver import Driver as Driver, OwnForces as OwnForces
from .figure import draw_load as draw_load
from .find import load_path as load_path
from .interactive import view_path as view_path
from .records import (
    ConfirmedSnap as ConfirmedSnap,
    Leg as Leg,
    LoadPoint as LoadPoint,
    Snap as Snap,
)
from .result import LoadPath as LoadPath
