from .conic import Programme as Programme, Rows as Rows
from .springs import Found as Found, Posed as Posed, scene_of as scene_of, solve as solve, springs_of as springs_of
from .targets import EnergyGap as EnergyGap, Placed as Placed, Target as Target, Targets as Targets, place as place
