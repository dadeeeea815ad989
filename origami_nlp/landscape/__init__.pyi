from .exact import (
    ExactLandscape as ExactLandscape,
    find_landscape as find_landscape,
    to_arrays as to_arrays,
)
from .figure import draw_landscape as draw_landscape
from .plain import landscape_to_dict as landscape_to_dict
