from .embedding import (
    SNAP as SNAP,
    crossing_depth as crossing_depth,
    examine as examine,
    fold_vertex as fold_vertex,
)
from .flat_fold import folds_flat as folds_flat
from .layers import LayerProblem as LayerProblem, layer_problem as layer_problem, ordered as ordered
