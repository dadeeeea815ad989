from .find import compare_minima as compare_minima, find_critical_points as find_critical_points
from .result import CriticalPoints as CriticalPoints
