from .counting import (
    LayerComponent as LayerComponent,
    LayerOrders as LayerOrders,
    layer_orders as layer_orders,
)
from .faults import Fault as Fault, Test as Test
from .figure import draw_validity as draw_validity
from .finding import check as check
from .flat_fold import folds_flat as folds_flat
from .result import Validity as Validity
from .vertex_list import VertexList as VertexList, list_vertices as list_vertices
