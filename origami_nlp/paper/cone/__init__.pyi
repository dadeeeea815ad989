from .branches import (
    ConeBranch as ConeBranch,
    class_of as class_of,
    parse_flaps as parse_flaps,
    write_flaps as write_flaps,
)
from .classes import Branches as Branches
from .energy import BranchEnergy as BranchEnergy
from .minima import (
    ConeCount as ConeCount,
    ConeMinima as ConeMinima,
    CountMap as CountMap,
    count as count,
    count_map as count_map,
)
from .necklaces import (
    Folding as Folding,
    Foldings as Foldings,
    foldings as foldings,
    number_of_foldings as number_of_foldings,
)
from .phase import (
    PhaseBoundary as PhaseBoundary,
    PhaseDiagram as PhaseDiagram,
    phase_boundaries as phase_boundaries,
    phase_diagram as phase_diagram,
)
from .phase_figure import draw_phase as draw_phase
from .rules import Cone as Cone, check_degree as check_degree
from .stability import (
    ConeFullSpace as ConeFullSpace,
    JudgedMinimum as JudgedMinimum,
    full_space as full_space,
)
