from .branches import ConeBranch as ConeBranch, branch as branch
from .classes import (
    AssignmentClasses as AssignmentClasses,
    EnergyClass as EnergyClass,
    assignment_classes as assignment_classes,
    energy_classes as energy_classes,
)
from .drawing import draw_branch as draw_branch, draw_foldings as draw_foldings
from .energy import SideEnergy as SideEnergy, class_energy as class_energy
from .flaps import class_of as class_of, parse_flaps as parse_flaps, write_flaps as write_flaps
from .map import CountMap as CountMap, count_map as count_map
from .minima import ConeCount as ConeCount, ConeMinima as ConeMinima, count as count
from .necklaces import (
    LARGEST_LISTED as LARGEST_LISTED,
    Folding as Folding,
    foldings as foldings,
    number_of_foldings as number_of_foldings,
)
from .phase import (
    PhaseDiagram as PhaseDiagram,
    check_size as check_size,
    phase_diagram as phase_diagram,
)
from .phase_curves import PhaseBoundary as PhaseBoundary, phase_boundaries as phase_boundaries
from .phase_figure import draw_phase as draw_phase
from .plain import (
    branch_to_dict as branch_to_dict,
    count_to_dict as count_to_dict,
    diagram_to_dict as diagram_to_dict,
    foldings_to_dict as foldings_to_dict,
    full_space_to_dict as full_space_to_dict,
    map_as_csv as map_as_csv,
    write_lines as write_lines,
)
from .rules import Cone as Cone, check_degree as check_degree, check_ratio as check_ratio
from .stability import (
    ConeFullSpace as ConeFullSpace,
    JudgedMinimum as JudgedMinimum,
    full_space as full_space,
)
from .table import (
    number_words as number_words,
    print_branch as print_branch,
    print_count as print_count,
    print_diagram as print_diagram,
    print_foldings as print_foldings,
    print_full_space as print_full_space,
)
