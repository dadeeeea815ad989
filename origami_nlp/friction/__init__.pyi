from .coulomb import CoulombHold as CoulombHold, least_coulomb as least_coulomb
from .figure import draw_coulomb as draw_coulomb, draw_friction as draw_friction
from .hinges import find_friction as find_friction
from .result import Friction as Friction, FrictionRegion as FrictionRegion
