from .figure import draw_friction as draw_friction
from .hinges import find_friction as find_friction
from .result import Friction as Friction, FrictionRegion as FrictionRegion
