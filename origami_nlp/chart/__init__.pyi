from .axes import (
    UNIT as UNIT,
    area_legend as area_legend,
    draw_area as draw_area,
    draw_curves as draw_curves,
    norm_of as norm_of,
)
from .boundary import (
    Boundary as Boundary,
    BoundaryLine as BoundaryLine,
    border_paths as border_paths,
    outline_of as outline_of,
    trace_boundary as trace_boundary,
    with_energy as with_energy,
)
from .cells import Cells as Cells, cells_of as cells_of, geometry as geometry
from .chart import (
    Chart as Chart,
    admissible as admissible,
    allowed as allowed,
    chart_limits as chart_limits,
    chart_of as chart_of,
    fold_vertex as fold_vertex,
    fold_wedge as fold_wedge,
)
from .energy_map import (
    EnergyBranch as EnergyBranch,
    Landscape as Landscape,
    Place as Place,
    landscape as landscape,
)
from .half_chain import HalfChain as HalfChain
from .mesh import MeshError as MeshError, edges_of as edges_of, several as several
from .topology import (
    Component as Component,
    Spot as Spot,
    borders as borders,
    handles as handles,
    parts as parts,
    spots as spots,
    surface_pieces as surface_pieces,
)
