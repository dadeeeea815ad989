from .axes import (
    UNIT as UNIT,
    area_legend as area_legend,
    colour_bar as colour_bar,
    curve_name as curve_name,
    draw_area as draw_area,
    draw_curves as draw_curves,
    energy_image as energy_image,
    norm_of as norm_of,
)
from .boundary_lines import (
    Boundary as Boundary,
    BoundaryLine as BoundaryLine,
    trace_boundary as trace_boundary,
    with_energy as with_energy,
)
from .chart import (
    Chart as Chart,
    admissible as admissible,
    chart_of as chart_of,
    chart_points as chart_points,
    crease_number as crease_number,
    family_of as family_of,
    wedge_elevation as wedge_elevation,
    wedge_point as wedge_point,
)
from .energy_map import (
    EnergyBranch as EnergyBranch,
    Landscape as Landscape,
    Place as Place,
    landscape as landscape,
)
from .grid import allowed as allowed, chart_limits as chart_limits, distance_from as distance_from
from .outline import (
    Outline as Outline,
    admissible_region as admissible_region,
    outline_of as outline_of,
)
