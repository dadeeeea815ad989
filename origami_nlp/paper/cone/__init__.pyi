from .branches import (
    ConeBranch as ConeBranch,
    FoldedCone as FoldedCone,
    branch as branch,
)
from .classes import (
    AssignmentClasses as AssignmentClasses,
    EnergyClass as EnergyClass,
    assignment_classes as assignment_classes,
    energy_classes as energy_classes,
)
from .energy import SideEnergy as SideEnergy
from .flaps import class_of as class_of, parse_flaps as parse_flaps, write_flaps as write_flaps
from .map import CountMap as CountMap, count_map as count_map
from .minima import ConeCount as ConeCount, ConeMinima as ConeMinima, count as count
from .necklaces import (
    Folding as Folding,
    Foldings as Foldings,
    foldings as foldings,
    number_of_foldings as number_of_foldings,
)
from .phase import PhaseDiagram as PhaseDiagram, phase_diagram as phase_diagram
from .phase_curves import PhaseBoundary as PhaseBoundary, phase_boundaries as phase_boundaries
from .phase_figure import draw_phase as draw_phase
from .rules import Cone as Cone, check_degree as check_degree
from .stability import (
    ConeFullSpace as ConeFullSpace,
    JudgedMinimum as JudgedMinimum,
    full_space as full_space,
)
