from .figure import draw_modes as draw_modes
from .find import (
    breaking_stiffness as breaking_stiffness,
    find_modes as find_modes,
    loaded_stratum as loaded_stratum,
)
from .geodesic import Geodesic as Geodesic, Reach as Reach, geodesic as geodesic
from .result import Mode as Mode, Modes as Modes, StateModes as StateModes
