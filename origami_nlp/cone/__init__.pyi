from .branches import (
    ConeBranch as ConeBranch,
    branch_end as branch_end,
    class_label as class_label,
    steep_end as steep_end,
)
from .drawing import draw_branch as draw_branch, draw_foldings as draw_foldings
from .energy import crease_angles as crease_angles, rest_state as rest_state
from .flaps import (
    LARGEST_LISTED as LARGEST_LISTED,
    Folding as Folding,
    bracelets as bracelets,
    check_degree as check_degree,
    class_of as class_of,
    cone_classes as cone_classes,
    parse_flaps as parse_flaps,
    write_flaps as write_flaps,
)
from .full_space import cone_full_space as cone_full_space
from .map import count_map as count_map
from .minima import (
    BranchMinima as BranchMinima,
    branch_minima as branch_minima,
    check_ratio as check_ratio,
)
from .phase import (
    PhaseDiagram as PhaseDiagram,
    check_size as check_size,
    phase_diagram as phase_diagram,
)
from .phase_curves import phase_boundaries as phase_boundaries
from .phase_energy import (
    SIGNS as SIGNS,
    branch_classes as branch_classes,
    rest_angles as rest_angles,
    rest_range as rest_range,
)
from .phase_figure import (
    draw_boundaries as draw_boundaries,
    draw_map as draw_map,
    draw_phase as draw_phase,
    legend as legend,
)
from .phase_plain import (
    diagram_to_dict as diagram_to_dict,
    full_space_to_dict as full_space_to_dict,
    map_as_csv as map_as_csv,
)
from .phase_table import print_diagram as print_diagram, print_full_space as print_full_space
from .plain import (
    branch_to_dict as branch_to_dict,
    count_to_dict as count_to_dict,
    foldings_to_dict as foldings_to_dict,
    write_lines as write_lines,
)
from .table import (
    number_words as number_words,
    print_branch as print_branch,
    print_count as print_count,
    print_foldings as print_foldings,
)
