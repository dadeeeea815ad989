from .crossings import pair_depths as pair_depths
from .embedding import (
    LARGEST_TOLERANCE as LARGEST_TOLERANCE,
    check_admissible as check_admissible,
    fold_vertex as fold_vertex,
)
from .flat_fold import folds_flat as folds_flat
from .layers import LayerProblem as LayerProblem, layer_problem as layer_problem, ordered as ordered
from .orders import (
    MOST_NODES as MOST_NODES,
    TRANSITIVE as TRANSITIVE,
    Orders as Orders,
    Rule as Rule,
    Rules as Rules,
    not_interleaved as not_interleaved,
    tied as tied,
)
from .vertex_list import (
    VertexList as VertexList,
    list_vertices as list_vertices,
    print_vertices as print_vertices,
    vertices_to_dict as vertices_to_dict,
)
